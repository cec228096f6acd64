//! Tables as other programs write them: separators, decimals, units, names; and what can be read in two ways.
#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "a test ends at the first surprise; some equalities hold to the last bit"
)]

use cvtcycle_config::csv::Columns;
use cvtcycle_config::cycle::{Cycle, GearCommand, read_columns, read_csv};
use cvtcycle_config::{Argument, Problem, Problems};

/// Seconds, km/h and percent of a short trip: every number is exact in each unit that it is written in below.
const TRIP: [(f64, f64, f64); 5] = [
    (0.0, 0.0, 0.0),
    (1.5, 0.0, 0.0),
    (2.0, 4.5, 2.5),
    (5.25, 36.0, -1.25),
    (7.0, 27.0, 0.0),
];

fn good(text: &str) -> Cycle {
    read_csv("trip.csv", text.as_bytes()).unwrap_or_else(|problems| panic!("{text}\n{problems:#?}"))
}

fn named(text: &str, columns: &str) -> Result<Cycle, Problems> {
    read_columns(
        "log.csv",
        text.as_bytes(),
        &Columns::parse(columns).unwrap(),
    )
}

/// The only problem of a text.
fn one(found: Result<Cycle, Problems>) -> Problem {
    let mut problems = found.unwrap_err();
    assert_eq!(problems.len(), 1, "{problems:#?}");
    problems.remove(0)
}

/// The trip with a line of names and lines above its rows, separated by a sign, with a decimal mark.
fn trip(names: [&str; 3], units: Option<[&str; 3]>, sign: &str, decimal: &str) -> String {
    let mut text = names.join(sign) + "\n";
    text.extend(units.map(|units| units.join(sign) + "\n"));
    for (time, speed, grade) in TRIP {
        let cells = [time, speed, grade].map(|x| x.to_string().replace('.', decimal));
        text += &(cells.join(sign) + "\n");
    }
    text
}

#[test]
fn one_trip_in_every_dialect() {
    let own = good(&trip(
        ["time_s", "speed_kmh", "grade_percent"],
        None,
        ",",
        ".",
    ));
    assert_eq!(own.read_as, None);
    let headings = [
        (["time_s", "speed_kmh", "grade_percent"], None),
        (["Time [s]", "Speed (km/h)", "Grade [%]"], None),
        (["t_s", "v_kmh", "slope_percent"], None),
        (
            ["Elapsed Time (sec)", "Vehicle Speed [kph]", "Gradient (%)"],
            None,
        ),
        (["<t>", "<v>", "<grad>"], None),
        (["time", "speed", "grade"], Some(["s", "km/h", "%"])),
        (
            ["Time", "Velocity", "Road grade"],
            Some(["[s]", "[km/h]", "[%]"]),
        ),
    ];
    for (names, units) in headings {
        for (sign, decimal) in [(",", "."), (";", "."), (";", ","), ("\t", "."), ("\t", ",")] {
            let text = trip(names, units, sign, decimal);
            for form in [
                text.clone(),
                text.replace('\n', "\r\n"),
                format!("\u{feff}{text}"),
                format!(
                    "# a comment, with; signs\n\n{}",
                    text.replace("\n7", "\n  # rest\n7")
                ),
            ] {
                let cycle = good(&form);
                assert_eq!(cycle.manual, own.manual, "{form}");
                let plain = (sign, units, names[0]) == (",", None, "time_s");
                assert_eq!(cycle.read_as.is_none(), plain, "{form}");
            }
        }
    }
}

#[test]
fn what_was_read_is_said() {
    let text = trip(
        ["Time", "Speed (km/h)", "grade_percent"],
        Some(["s", "", "%"]),
        ";",
        ",",
    );
    assert_eq!(
        good(&text).read_as.unwrap(),
        "semicolons, decimal commas, a row of units, \"Time\" as time_s, \"Speed (km/h)\" as speed_kmh"
    );
}

#[test]
fn files_of_other_programs_are_known() {
    // The structure of EPA's files: a title, names with their units behind a comma, tabs; in some copies the names are not separated.
    let epa = "FTPCOL.TXT\tFederal Test Procedure\nTest Time, secs\tTarget Speed, mph\n0\t0\n1\t10\n2\t25.5\n";
    let spaces = epa.replace("secs\t", "secs ");
    for text in [epa, &spaces] {
        let trace = good(text).manual;
        let last = trace.intervals.last().unwrap();
        // 1 mph is 0.44704 m/s, by definition.
        assert!(
            (last.end_speed_m_s - 25.5 * 0.447_04).abs() < 1e-12,
            "{text}"
        );
    }
    let fastsim2 = "cycSecs,cycMps,cycGrade,cycRoadType\n0,0,0.01,0\n1,2.5,0,0\n";
    let fastsim3 = "time_seconds,speed_meters_per_second,grade\n0,0,0.01\n1,2.5,0\n";
    let own = good("time_s,speed_m_s,grade\n0,0,0.01\n1,2.5,0\n").manual;
    assert_eq!(good(fastsim2).manual, own);
    assert_eq!(good(fastsim3).manual, own);
    assert_eq!(
        good(
            &fastsim3
                .replace("meters_per_second", "mps")
                .replace("seconds", "s")
        )
        .manual,
        own
    );
    // VECTO: time goes before distance; without both a row is a second; other columns are passed over.
    let timed = "<t>,<v>,<grad>,<s>,<Aux_FAN>,<gear>\n0,0,1,0,3,0\n1,9,0,1,3,2\n3,9,0,7,3,2\n";
    let trace = good(timed).manual;
    assert_eq!(trace.intervals[1].end_s, 3.0);
    assert_eq!(trace.gears(5).unwrap()[1], GearCommand::InGear(2));
    let seconds = good("<v>,<grad>\n0,1\n9,0\n9,0\n");
    assert_eq!(seconds.manual.duration_s(), 2.0);
    assert!(seconds.read_as.unwrap().ends_with("a row a second"));
}

#[test]
fn a_cycle_over_distance_covers_its_distance() {
    // From VECTO's own tests (SimpleDrivingCycles).
    let text = "<s>,<v>,<grad>,<stop>\n0,20,0,0\n100,60,0,0\n1000,60,0,0\n1500,40,1,0\n2000,0,0,5\n2001,50,-1,0\n2500,0,0,2\n";
    let cycle = good(text);
    let trace = &cycle.manual;
    assert!(
        (trace.distance_m() - 2500.0).abs() < 1e-6,
        "{}",
        trace.distance_m()
    );
    let mut at_m = 0.0;
    for i in trace.intervals.iter() {
        let accel = (i.end_speed_m_s - i.start_speed_m_s) / (i.end_s - i.start_s);
        assert!(
            (-1.5 - 1e-6..=1.0 + 1e-6).contains(&accel),
            "{accel} at {at_m} m"
        );
        let target = match at_m {
            m if m < 100.0 - 1e-6 => 20.0,
            m if m < 1500.0 - 1e-6 => 60.0,
            m if m < 2000.0 - 1e-6 => 40.0,
            _ => 50.0,
        };
        assert!(i.end_speed_m_s * 3.6 <= target + 1e-9, "{i:?}");
        at_m += i.distance_m();
    }
    let rests: Vec<f64> = trace
        .intervals
        .iter()
        .filter(|i| i.end_speed_m_s + i.start_speed_m_s == 0.0)
        .map(|i| i.end_s - i.start_s)
        .collect();
    assert_eq!(rests.len(), 2);
    assert!((rests[0] - 5.0).abs() < 1e-9 && (rests[1] - 2.0).abs() < 1e-9);
    // By hand: from rest to 50 km/h at 1 m/s2 takes 13.89 s and 96.45 m, back to rest at 1.5 m/s2 9.26 s and 64.30 m, the 339.25 m
    // between them 24.43 s.
    let leg_s = trace.duration_s()
        - 2.0
        - trace
            .intervals
            .iter()
            .find(|i| (i.end_s - i.start_s - 5.0).abs() < 1e-9)
            .unwrap()
            .end_s;
    assert!((leg_s - (13.889 + 24.426 + 9.259)).abs() < 0.01, "{leg_s}");
}

#[test]
fn a_logger_s_columns_are_those_that_are_named() {
    let log = "Time_ADC,VehSpd,Temp,VehSpd2\n0,0,warm,9\n1,10,,9\n2,10,x,9\n";
    let own = good("time_s,speed_mph\n0,0\n1,10\n2,10\n");
    let cycle = named(log, "speed=VehSpd:mph,time=Time_ADC:s").unwrap();
    assert_eq!(cycle.manual, own.manual);
    assert!(cycle.read_as.unwrap().ends_with("2 of 4 columns"));
    assert_eq!(
        named(log, "speed_mph=VehSpd,time_s=Time_ADC")
            .unwrap()
            .manual,
        own.manual
    );
    assert_eq!(
        named("0 ;0\n1;10\n2;10\n", "time:s,speed:mph")
            .unwrap()
            .manual,
        own.manual
    );
    let units = "Time_ADC,VehSpd\ns,mph\n0,0\n1,10\n2,10\n";
    assert_eq!(
        named(units, "time=Time_ADC,speed=VehSpd").unwrap().manual,
        own.manual
    );
    // Without names an unknown column is a problem, as ever.
    assert!(read_csv("log.csv", log.as_bytes()).is_err());
    for (columns, message, hint) in [
        (
            "time=Time_ADC:s,speed=VehSpeed:mph",
            "the file has no column `VehSpeed`",
            "`VehSpd`",
        ),
        (
            "time=Time_ADC:s,sped=VehSpd:mph",
            "there is no quantity `sped`",
            "did you mean `speed`",
        ),
        (
            "time=Time_ADC:s,speed=VehSpd",
            "speed needs its unit",
            "speed=VehSpd:km/h",
        ),
        (
            "time=Time_ADC:s,speed=VehSpd:bar",
            "speed is not read in that unit",
            "speed=VehSpd:km/h",
        ),
        (
            "time=Time_ADC:s,speed_kmh=VehSpd:mph",
            "speed_kmh is not read in that unit",
            "",
        ),
    ] {
        let problems = named(log, columns).unwrap_err();
        assert_eq!(problems[0].message, message);
        assert!(problems[0].hint.contains(hint), "{problems:?}");
        assert!(problems[0].place.is_argument(Argument::Columns));
    }
    for (columns, message) in [
        ("speed", "`speed` names no column"),
        ("speed=", "`speed=` names no column"),
        (
            "time:s,speed=V:mph",
            "some columns are named and some are not",
        ),
        ("time:s,time:s", "time is given twice"),
        ("\"time:s", "a quote is not closed"),
    ] {
        assert_eq!(Columns::parse(columns).unwrap_err().message, message);
    }
}

#[test]
fn what_can_be_read_in_two_ways_is_refused_with_both_at_its_place() {
    for (text, line, column, part) in [
        (
            "time_s;speed_kmh\n0;13,889\n1;13,889\n",
            2,
            3,
            "in two ways: 13.889, or 13889",
        ),
        (
            "time_s;speed_kmh\n0;0,5\n1;1.5\n",
            3,
            3,
            "and 0,5 in line 2",
        ),
        (
            "time_s\tspeed_kmh\n0\t0.5\n1\t1,5\n",
            3,
            3,
            "and 0.5 in line 2",
        ),
        (
            "time_s,speed_kmh\n0,5,1,5\n1,0\n",
            2,
            1,
            "4 values, or 2 with decimal commas",
        ),
        (
            "time_s,x;speed_kmh\n0,1;2\n",
            1,
            1,
            "in two ways: 2 with a comma between them, or 2 with a semicolon",
        ),
        (
            "Time [ms],speed_kmh\n0,0\n1,0\n",
            1,
            1,
            "time is not read in the unit of this column",
        ),
        (
            "time,speed_kmh\ns,mph\n0,0\n1,0\n",
            2,
            3,
            "the row of units contradicts the name speed_kmh",
        ),
        (
            "Speed (km/h),speed_kmh,time_s\n0,0,0\n1,0,1\n",
            1,
            14,
            "duplicate column",
        ),
        ("0,0\n1,0\n", 1, 1, "numbers and no column names"),
        ("<s>,<v>\n0,9\n5,0\n9,9\n", 4, 1, "without a time at rest"),
        (
            "<s>,<v>\n0,9\n9,9\n5,9\n",
            4,
            1,
            "the distance does not rise",
        ),
        (
            "<s>,<v>,<stop>\n0,9,1\n9,9,0\n",
            2,
            5,
            "a time at rest and a speed",
        ),
        ("<s>,<v>,<stop>\n0,0,1\n9,0,2\n", 3, 1, "from rest to rest"),
        (
            "<s>,<v>\n0,0.2\n99999,0.2\n",
            0,
            0,
            "the cycle over distance takes",
        ),
    ] {
        let found = one(read_csv("trip.csv", text.as_bytes()));
        assert!(found.message.contains(part), "{text}: {found:?}");
        assert_eq!(
            (found.place.line, found.place.column),
            (line, column),
            "{text}: {found:?}"
        );
    }
    // Decimals behind a leading zero, or of another number, are no thousands.
    assert!(
        good("time_s;speed_kmh\n0;0,500\n1;13,889\n")
            .read_as
            .is_some()
    );
}
