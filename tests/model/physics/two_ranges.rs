//! A box with two ranges. Truth: definitions of RG-1 and RG-2 from the rows, first and second law by `check --physics`, whose code is apart from the
//! model's, the same drive in short steps, and the box with one range as a limit.

use crate::common::{ZERO, at, car, cycle, fuel_kg, larger, try_car};
use cvtcycle_model::drive::{
    Conditions, FullThrottle, Row, Start, accelerate, check_physics, drive,
};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::thermal::Heat;
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::component::Component;

const TWO: &str = "transmission.cvt.ranges.two";
/// The set of the class `box_cvt_two_range`.
const SET: [(&str, &str); 8] = [
    ("low_ratio", "1.82"),
    ("up_belt_ratio", "0.6"),
    ("down_belt_ratio", "1.8"),
    ("change_s", "0.6"),
    ("mesh_loss_percent", "0.9"),
    ("drag_nm", "0.6"),
    ("viscous_exponent", "0.543"),
    ("cap_nm", "1.5"),
];

/// The set with other numbers, as assignments.
pub fn with(more: &[(&str, &str)]) -> Vec<String> {
    let own = SET
        .iter()
        .filter(|(key, _)| !more.iter().any(|(other, _)| other == key));
    let each = own.chain(more).map(|(key, value)| match key.contains('.') {
        true => format!("{key}={value}"),
        false => format!("{TWO}.{key}={value}"),
    });
    each.collect()
}

fn two(vehicle: &str, more: &[(&str, &str)]) -> cvtcycle_config::setup::Setup {
    try_car(vehicle, &with(more)).unwrap_or_else(|problems| panic!("{problems}"))
}

fn rows(setup: &cvtcycle_config::setup::Setup, name: &str) -> Vec<Row> {
    let conditions = Conditions {
        keep_rows: true,
        ..at(25.0, Start::Soak)
    };
    drive(setup, &cycle(name), &conditions).rows
}

#[test]
fn a_car_with_two_ranges_obeys_the_laws() {
    let behind = ("transmission.cvt.launch_at", "output");
    for (vehicle, more) in [
        ("rover_216_cvt", vec![]),
        ("rover_216_cvt", vec![behind]),
        ("civic_20_cvt", vec![("low_ratio", "1.5")]),
    ] {
        let setup = two(vehicle, &more);
        for (name, ambient) in [("ece15_eudc", 25.0), ("ece15_eudc", -10.0), ("us06", 25.0)] {
            for finding in check_physics(&setup, &cycle(name), ambient + ZERO, 1.0) {
                assert!(finding.holds(), "{vehicle} {name} {ambient}: {finding:?}");
            }
        }
    }
}

/// RG-1 and RG-2 from the rows: a locked engine turns with belt, set and final drive; in low at rest; a change runs to its end, and neither range is
/// left within its bounds.
#[test]
fn ranges_and_speeds_of_a_drive() {
    let setup = two("rover_216_cvt", &[]);
    let Transmission::Cvt(cvt) = setup.transmission() else {
        panic!("a CVT")
    };
    let (mut changes, mut before) = (0, 1.82);
    for row in rows(&setup, "ftp75") {
        if row.rests() {
            assert!((row.range_ratio - 1.82).abs() < 1e-12, "{}", row.time_s);
            before = 1.82;
            continue;
        }
        assert!((1.0..=1.82).contains(&row.range_ratio));
        let apart = [Flags::CLUTCH_SLIPPING, Flags::CLUTCH_OPEN];
        // Slower, an engine at idle lets the clutch slip within the step.
        let locked = !apart.iter().any(|flag| row.flags.contains(*flag)) && row.speed_m_s > 6.0;
        if locked {
            let overall = row.belt_ratio * row.range_ratio * cvt.final_drive.ratio;
            let slipping = overall / (1.0 - row.slip);
            assert!(
                (row.overall_ratio / slipping - 1.0).abs() < 1e-9,
                "{}",
                row.time_s
            );
        }
        let settled = row.range_ratio <= 1.0 || row.range_ratio >= 1.82;
        if settled && (row.range_ratio - before).abs() > 0.5 {
            changes += 1;
            before = row.range_ratio;
        }
    }
    // Up after most of the starts and down again, and a few more in between.
    assert!((20..=70).contains(&changes), "{changes}");
}

/// The limit: a set of nearly one ratio and without loss is the box with one range.
#[test]
fn a_set_of_ratio_one_is_no_set() {
    let c = cycle("ece15_eudc");
    let own = fuel_kg(&car("rover_216_cvt", &[]), &c, &at(25.0, Start::Soak));
    let near_one = [
        ("low_ratio", "1.05"),
        ("mesh_loss_percent", "0"),
        ("drag_nm", "0"),
        ("up_belt_ratio", "0.9"),
    ];
    let set = fuel_kg(&two("rover_216_cvt", &near_one), &c, &at(25.0, Start::Soak));
    assert!((set / own - 1.0).abs() < 2e-3, "{set} {own}");
}

/// Every number of the set moves the fuel, a factor of 0 is a set without loss, and the loss goes to a column of its own.
#[test]
fn no_number_of_the_set_is_dead() {
    let c = cycle("ece15_eudc");
    let fuel =
        |more: &[(&str, &str)]| fuel_kg(&two("rover_216_cvt", more), &c, &at(25.0, Start::Soak));
    let own = fuel(&[]);
    for more in [
        ("low_ratio", "1.6"),
        ("up_belt_ratio", "0.8"),
        ("down_belt_ratio", "1.4"),
        ("change_s", "1.2"),
        ("mesh_loss_percent", "1.5"),
        ("drag_nm", "0.3"),
        ("viscous_exponent", "0.9"),
        ("cap_nm", "0.5"),
        ("peak_rpm", "1500"),
    ] {
        let moved = fuel(&[more]);
        assert!((moved / own - 1.0).abs() > 1e-6, "{more:?}: {own} {moved}");
    }
    let off = ("transmission.cvt.loss_factor.range_gear", "0");
    let without = fuel(&[off]);
    assert!(without < own, "{without} {own}");
    let losses = |setup: &cvtcycle_config::setup::Setup| {
        let totals = drive(setup, &c, &at(25.0, Start::Soak)).totals;
        totals.total().loss_j[Component::RangeGear]
    };
    assert!(losses(&two("rover_216_cvt", &[])) > 1e4);
    assert!(losses(&two("rover_216_cvt", &[off])).abs() <= 0.0);
    let belt = car("rover_216_cvt", &[]);
    assert!(
        !belt
            .transmission()
            .components()
            .contains(&Component::RangeGear)
    );
}

/// Largest error of the fuel at 1 s against steps of 0.05 s, per cent, over three cycles.
fn step_error_percent(setup: &cvtcycle_config::setup::Setup) -> f64 {
    let of_cycle = |name: &str| {
        let [coarse, fine] = [1.0, 0.05].map(|max_dt_s| {
            let conditions = Conditions {
                max_dt_s,
                ..at(25.0, Start::Soak)
            };
            fuel_kg(setup, &cycle(name), &conditions)
        });
        100.0 * (coarse / fine - 1.0).abs()
    };
    let errors = ["ece15_eudc", "ftp75", "us06"].map(of_cycle);
    errors.into_iter().fold(0.0, larger)
}

/// Truth: the same drives in steps of 0.05 s; other boxes keep 0.3 % (test of the steps).
#[test]
fn fuel_does_not_depend_on_the_step() {
    let two = step_error_percent(&two("rover_216_cvt", &[]));
    let geared = step_error_percent(&geared(&[]).unwrap());
    assert!(two < 0.3 && geared < 0.3, "{two} {geared} %");
}

/// Truth: one change, up, on the way to a speed that the box with one range has in about the same time: the power is the engine's.
#[test]
fn full_throttle_through_both_ranges() {
    let asked = FullThrottle {
        from_m_s: 0.0,
        to_m_s: 130.0 / 3.6,
        distance_m: 0.0,
        grade: 0.0,
        grip: None,
        shift_s: 0.5,
        gear: None,
        heat: (Heat::uniform(353.15), 293.15),
        dt_s: 0.1,
    };
    let found = [car("rover_216_cvt", &[]), two("rover_216_cvt", &[])]
        .map(|setup| accelerate(&setup.car(298.15), &asked));
    let time_s = |k: usize, kmh: f64| found[k].time_to_speed_s(kmh / 3.6).unwrap();
    let ranges: Vec<f64> = found[1]
        .steps
        .iter()
        .map(|step| step.row.range_ratio)
        .collect();
    assert!(ranges[0] > 1.8 && ranges[ranges.len() - 1] <= 1.0);
    // One change, up.
    assert!(ranges.windows(2).all(|pair| pair[1] <= pair[0]));
    let apart = time_s(1, 130.0) / time_s(0, 130.0);
    assert!((0.9..1.3).contains(&apart), "{apart}");
}

const GEAR: &str = "transmission.cvt.ranges.launch_gear";
/// The gear of the class `box_cvt_launch_gear`, for the belt of the Rover: a step of 1.5 below its lowest ratio.
const LAUNCH: [(&str, &str); 8] = [
    ("gear_ratio", "3.6"),
    ("up_ratio", "2.9"),
    ("down_ratio", "4.0"),
    ("change_s", "0.5"),
    ("mesh_loss_percent", "1.5"),
    ("drag_nm", "0.6"),
    ("viscous_exponent", "0.543"),
    ("cap_nm", "1.5"),
];

fn geared(more: &[(&str, &str)]) -> Result<cvtcycle_config::setup::Setup, String> {
    let own = LAUNCH
        .iter()
        .filter(|(key, _)| !more.iter().any(|(other, _)| other == key));
    let each = own.chain(more).map(|(key, value)| match key.contains('.') {
        true => format!("{key}={value}"),
        false => format!("{GEAR}.{key}={value}"),
    });
    try_car("rover_216_cvt", &each.collect::<Vec<_>>())
}

#[test]
fn a_car_with_a_launch_gear_obeys_the_laws() {
    let setup = geared(&[]).unwrap();
    for (name, ambient) in [("ece15_eudc", 25.0), ("ece15_eudc", -10.0), ("us06", 25.0)] {
        for finding in check_physics(&setup, &cycle(name), ambient + ZERO, 1.0) {
            assert!(finding.holds(), "{name} {ambient}: {finding:?}");
        }
    }
}

/// RG-6 and RG-7 from the rows: the belt in low and without load while the gear has the torque, then the belt alone.
#[test]
fn gear_and_belt_of_a_drive() {
    let setup = geared(&[]).unwrap();
    let Transmission::Cvt(cvt) = setup.transmission() else {
        panic!("a CVT")
    };
    let low = cvt.ranges.as_ref().unwrap().low;
    assert!((low * cvt.ratio.low / 3.6 - 1.0).abs() < 1e-12);
    let (mut in_gear, mut by_belt) = (0, 0);
    for row in rows(&setup, "ftp75") {
        assert!((1.0 - 1e-12..=low * (1.0 + 1e-12)).contains(&row.range_ratio));
        if row.rests() {
            continue;
        }
        if row.range_ratio >= low {
            in_gear += 1;
            assert!(
                row.secondary_nm.abs() < 3.0,
                "{} s: {} Nm",
                row.time_s,
                row.secondary_nm
            );
            assert!(row.speed_m_s < 20.0, "{} s", row.time_s);
            assert!(row.loss_w[Component::BeltSlip] < 5.0, "{} s", row.time_s);
        } else if row.range_ratio <= 1.0 {
            by_belt += 1;
        }
    }
    assert!(
        in_gear > 60 && by_belt > 10 * in_gear,
        "{in_gear} {by_belt}"
    );
}

#[test]
fn bad_launch_gears_are_refused() {
    for (more, words) in [
        (
            ("gear_ratio", "2.0"),
            "the belt has a lower ratio than the launch gear",
        ),
        (("up_ratio", "3.7"), "with the engine below its target"),
        (("down_ratio", "3.0"), "the gear would be wanted again"),
        (
            ("transmission.cvt.launch_at", "output"),
            "past a clutch behind it",
        ),
    ] {
        let problems = geared(&[more]).unwrap_err();
        assert!(problems.contains(words), "{more:?}: {problems}");
    }
}

#[test]
fn bad_sets_are_refused() {
    let refused = |more: &[(&str, &str)]| try_car("rover_216_cvt", &with(more)).unwrap_err();
    for (more, words) in [
        (("up_belt_ratio", "0.3"), "the low range is never left"),
        (
            ("up_belt_ratio", "1.2"),
            "the low one would be wanted again",
        ),
        (
            ("down_belt_ratio", "3"),
            "the high range is left at rest alone",
        ),
        (("low_ratio", "0.9"), "low_ratio"),
    ] {
        let problems = refused(&[more]);
        assert!(problems.contains(words), "{more:?}: {problems}");
    }
    let half = try_car("rover_216_cvt", &[format!("{TWO}.low_ratio=1.8")]).unwrap_err();
    assert!(
        half.contains("down_belt_ratio") && half.contains("missing"),
        "{half}"
    );
}
