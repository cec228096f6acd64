//! Logs in the forms of instruments and programs that others have.
//!
//! Truth: the speeds of the drive of which each file is written, at whole seconds.

use std::fmt::Write as _;

use crate::Problems;
use crate::csv::Columns;
use crate::cycle::{Cycle, embedded, is_standstill, read_columns};

/// A drive of 700 s that is no shipped cycle, km/h each second: the rural Artemis cycle with other speeds, to rest.
fn drive() -> Vec<f64> {
    let road = embedded("artemis_road").unwrap();
    let speeds = road
        .manual
        .intervals
        .iter()
        .map(|own| 3.6 * own.start_speed_m_s);
    let other = |(k, own): (usize, f64)| match own > 1.0 {
        true => (100.0 * own * (1.0 + 0.04 * (k as f64 / 23.0).sin())).round() / 100.0,
        false => 0.0,
    };
    let mut drive: Vec<f64> = speeds.take(700).enumerate().map(other).collect();
    while drive.last().is_some_and(|own| *own > 0.0) {
        let last = drive.last().copied().unwrap_or_default();
        drive.push((last - 3.5).max(0.0));
    }
    drive.extend([0.0; 5]);
    drive
}

fn table(head: &str, row: impl Fn(usize, f64) -> String) -> String {
    let mut text = format!("{head}\n");
    for (k, own) in drive().into_iter().enumerate() {
        let _ = writeln!(text, "{}", row(k, own));
    }
    text
}

fn read_with(text: &[u8], columns: &str) -> Result<Cycle, Problems> {
    let columns = match columns {
        "" => Columns::default(),
        list => Columns::parse(list).map_err(Problems::from)?,
    };
    read_columns("log.csv", text, &columns)
}

/// Largest difference of the speeds at whole seconds from the truth, km/h, and of the durations.
fn difference(cycle: &Cycle) -> f64 {
    let truth = drive();
    let mut most: f64 = (cycle.manual.duration_s() - (truth.len() - 1) as f64).abs();
    for own in cycle.manual.intervals.iter() {
        let (at, share) = (own.start_s.floor() as usize, own.start_s.fract());
        let next = truth.get(at + 1).unwrap_or(&truth[at]);
        let right = truth[at] + share * (next - truth[at]);
        most = most.max((3.6 * own.start_speed_m_s - right).abs());
    }
    most
}

/// The time of day of a second of the drive, which begins at 23:57:30.
fn clock(k: usize) -> (usize, [usize; 3]) {
    let second = 86_250 + k;
    let rest = second % 86_400;
    (second / 86_400, [rest / 3600, rest / 60 % 60, rest % 60])
}

/// Over midnight and from the 12th to the 13th of a month, of which one cannot be the month.
#[test]
fn stamps_of_many_forms_are_the_times_of_the_drive() {
    type Stamp = fn(usize) -> String;
    let forms: [(&str, Stamp); 17] = [
        ("day first", |k| {
            let (day, [h, m, s]) = clock(k);
            format!("{}/06/2026 {h:02}:{m:02}:{s:02}", 12 + day)
        }),
        ("day first, both may be months", |k| {
            let (day, [h, m, s]) = clock(k);
            format!("{:02}/06/2026 {h:02}:{m:02}:{s:02}", 5 + day)
        }),
        ("month first", |k| {
            let (day, [h, m, s]) = clock(k);
            format!("06/{}/26 {h:02}:{m:02}:{s:02}", 12 + day)
        }),
        ("slashes and T", |k| {
            let (day, [h, m, s]) = clock(k);
            format!("2026/06/{}T{h:02}:{m:02}:{s:02}", 12 + day)
        }),
        ("figures of date and clock", |k| {
            let (day, [h, m, s]) = clock(k);
            format!("202606{}{h:02}{m:02}{s:02}", 12 + day)
        }),
        ("figures of a clock", |k| {
            let (_, [h, m, s]) = clock(k);
            format!("{h:02}{m:02}{s:02}.00")
        }),
        ("zone by name", |k| {
            let (day, [h, m, s]) = clock(k);
            format!("2026-06-{} {h:02}:{m:02}:{s:02} CEST", 12 + day)
        }),
        ("day of the year", |k| {
            let (day, [h, m, s]) = clock(k);
            format!("2026-{:03}T{h:02}:{m:02}:{s:02}", 99 + day)
        }),
        ("name of the month", |k| {
            let (day, [h, m, s]) = clock(k);
            format!("\"Jun {}, 2026 {h:02}:{m:02}:{s:02}\"", 12 + day)
        }),
        ("halves of the day with points", |k| {
            let (day, [h, m, s]) = clock(k);
            let half = if h < 12 { "a.m." } else { "p.m." };
            let hour = if h % 12 == 0 { 12 } else { h % 12 };
            format!("{}.06.2026 {hour:02}:{m:02}:{s:02} {half}", 12 + day)
        }),
        ("twelve hours without their half", |k| {
            let second = 45_900 + k;
            let hour = if second / 3600 == 12 {
                12
            } else {
                second / 3600 - 12
            };
            format!("{hour:02}:{:02}:{:02}", second / 60 % 60, second % 60)
        }),
        ("stopwatch over the hour", |k| {
            let second = (3300 + k) % 3600;
            format!("{:02}:{:02}", second / 60, second % 60)
        }),
        ("difference of times", |k| {
            format!("0 days 00:{:02}:{:02}", k / 60, k % 60)
        }),
        ("nanoseconds", |k| {
            format!("2026-06-12T08:{:02}:{:02}.000000000Z", k / 60, k % 60)
        }),
        ("offset", |k| {
            format!("2026-06-12T08:{:02}:{:02}.000+0200", k / 60, k % 60)
        }),
        ("JavaScript", |k| {
            let (day, [h, m, s]) = clock(k);
            format!(
                "\"6/{}/2026, {:02}:{m:02}:{s:02} {}\"",
                12 + day,
                if h % 12 == 0 { 12 } else { h % 12 },
                if h < 12 { "AM" } else { "PM" }
            )
        }),
        ("underscore", |k| {
            let (day, [h, m, s]) = clock(k);
            format!("2026-06-{}_{h:02}-{m:02}-{s:02}", 12 + day)
        }),
    ];
    for (form, stamp) in forms {
        let text = table("Time,Speed [km/h]", |k, v| format!("{},{v:.2}", stamp(k)));
        let cycle = read_with(text.as_bytes(), "").unwrap_or_else(|p| panic!("{form}: {p:?}"));
        let most = difference(&cycle);
        assert!(most < 1e-6, "{form}: {most}");
    }
    // Days since 1900 of a workbook, in the unit that is proposed.
    let text = table("Time,Speed [km/h]", |k, v| {
        format!("{:.8},{v:.2}", 46_093.0 + k as f64 / 86_400.0)
    });
    let problems = read_with(text.as_bytes(), "").unwrap_err();
    let columns = problems.iter().map(|own| own.proposed()).max().unwrap();
    assert_eq!(columns, "time=Time:d,speed=Speed [km/h]:km/h");
    let most = difference(&read_with(text.as_bytes(), columns).unwrap());
    assert!(most < 0.05, "a millisecond of rounding: {most}");
}

#[test]
fn tables_of_many_programs_are_the_drive() {
    let plain = table("Time [s],Speed [km/h]", |k, v| format!("{k},{v:.2}"));
    let forms: Vec<(&str, Vec<u8>)> = vec![
        (
            "decimal commas in quotes between commas",
            table("\"Time [s]\",\"Speed [km/h]\"", |k, v| {
                format!("\"{k},0\",\"{}\"", format!("{v:.2}").replace('.', ","))
            })
            .into_bytes(),
        ),
        ("zeros at the end", [plain.as_bytes(), &[0; 64]].concat()),
        (
            "preamble of as many columns",
            format!("Logger,ACME\nSerial,1234\nStart,12:00\nFirmware,2.1\n{plain}").into_bytes(),
        ),
        (
            "ADVISOR",
            format!(
                "% SPEED\ncyc_description='Mine';\ncyc_mph=[\n{}];\nvc_key_on=[cyc_mph(:,1) ones(size(cyc_mph,1),1)];\n",
                table("", |k, v| format!("{k} {:.6}", v / 1.609_344)).trim_start()
            )
            .into_bytes(),
        ),
        (
            "LabVIEW",
            format!(
                "LabVIEW Measurement\t\nSeparator\tTab\n***End_of_Header***\t\n\t\nChannels\t1\t\n***End_of_Header***\t\t\n{}",
                table("Time [s]\tSpeed [km/h]\tComment", |k, v| format!("{k}.000000\t{v:.2}\t"))
            )
            .into_bytes(),
        ),
        (
            "openpilot",
            table("logMonoTime,carState.vEgo", |k, v| {
                format!("{},{:.6}", 123_456_789_000_u64 + 1_000_000_000 * k as u64, v / 3.6)
            })
            .into_bytes(),
        ),
        (
            "signals of a bus",
            table("Timestamp [s],CAN ID,Signal,Physical Value,Unit", |k, v| {
                format!("{k},0x1A0,VehicleSpeed,{v:.2},km/h\n{k}.01,0x280,EngineSpeed,900,rpm")
            })
            .into_bytes(),
        ),
        (
            "mean of the trip next to the speed",
            table("Time [s],Average trip speed(km/h),Speed (OBD)(km/h)", |k, v| format!("{k},33,{v:.2}")).into_bytes(),
        ),
        (
            "value out of range",
            table("Time [s],Speed [km/h]", |k, v| match k {
                300 | 301 => format!("{k},-999"),
                310 => format!("{k},655.35"),
                _ => format!("{k},{v:.2}"),
            })
            .into_bytes(),
        ),
        (
            "words of errors",
            table("Time [s],Speed [km/h]", |k, v| match k % 97 {
                5 => format!("{k},#VALUE!"),
                50 => format!("{k},ERR"),
                _ => format!("{k},{v:.2}"),
            })
            .into_bytes(),
        ),
    ];
    for (form, bytes) in forms {
        let cycle = read_with(&bytes, "").unwrap_or_else(|p| panic!("{form}: {p:?}"));
        let most = difference(&cycle);
        let limit = if form.contains("value") || form.contains("words") {
            8.0
        } else {
            1e-4
        };
        assert!(most < limit, "{form}: {most}");
    }
}

/// Proposals are read as the drive, and nothing is proposed that is no speed or no time.
#[test]
fn what_is_proposed_is_the_drive() {
    let names = |head: &str, unit: f64| table(head, |k, v| format!("{k},{:.4},52.1,7.3", v / unit));
    for (head, unit, columns) in [
        ("elapsed [s],speed,lat,lon", 3.6, "speed=speed:m/s"),
        ("sch.time,sch.veh_spd,a,b", 3.6, "speed=sch.veh_spd:m/s"),
        ("t,v,a,b", 1.0, "speed=v:km/h"),
    ] {
        let text = names(head, unit);
        let problems = read_with(text.as_bytes(), "").unwrap_err();
        let proposed = problems.iter().map(|own| own.proposed()).max().unwrap();
        assert!(proposed.contains(columns), "{head}: {proposed}");
        let most = difference(&read_with(text.as_bytes(), proposed).unwrap());
        assert!(most < 0.01, "{head}: {most}");
    }
    for head in [
        "frame,speed_kmh",
        "Time [s],Distance [km]",
        "Time [s],Longitudinal acceleration [m/s2]",
        "Time [s],Wheel speed [rad/s]",
    ] {
        let text = table(head, |k, v| format!("{k},{v:.2}"));
        let problems = read_with(text.as_bytes(), "").unwrap_err();
        assert!(
            problems.iter().all(|own| own.proposed().is_empty()),
            "{head}: {problems:?}"
        );
    }
}

/// A value that is written again until the next one is measured, a signal that is lost for six seconds, a clock that is set, and two cars one among the other.
#[test]
fn faults_of_recordings_have_a_remedy_each() {
    let speeds = drive();
    let at = |seconds: f64| {
        let k = seconds as usize;
        let next = speeds.get(k + 1).unwrap_or(&speeds[k]);
        speeds[k] + seconds.fract() * (next - speeds[k])
    };
    let repair = |cycle: &Cycle, name: &str| {
        let own = cycle.recording.as_deref().unwrap();
        assert!(
            own.repairs.iter().any(|repair| repair.name == name),
            "{name}: {own:?}"
        );
    };
    let mut text = "Time [s],Speed [km/h]\n".to_owned();
    for k in 0..=10 * (speeds.len() - 1) {
        let _ = writeln!(text, "{:.1},{:.2}", k as f64 / 10.0, speeds[k / 10]);
    }
    let cycle = read_with(text.as_bytes(), "").unwrap();
    repair(&cycle, "held");
    assert!(difference(&cycle) < 1e-6, "{}", difference(&cycle));
    // The same of a shipped cycle, whose values at whole seconds are its own.
    let udds = embedded("udds").unwrap();
    let mut text = "Time [s],Speed [km/h]\n".to_owned();
    for (k, own) in udds.manual.intervals.iter().enumerate() {
        for part in 0..10 {
            let _ = writeln!(text, "{k}.{part},{:.2}", 3.6 * own.start_speed_m_s);
        }
    }
    repair(&read_with(text.as_bytes(), "").unwrap(), "held");
    let fast = (30..speeds.len() - 30)
        .max_by(|a, b| speeds[*a].total_cmp(&speeds[*b]))
        .unwrap();
    let lost = table("Time [s],Speed [km/h]", |k, v| {
        let is_lost = (fast - 3..fast + 3).contains(&k);
        format!("{k},{:.2}", if is_lost { 0.0 } else { v })
    });
    let cycle = read_with(lost.as_bytes(), "").unwrap();
    repair(&cycle, "spikes");
    assert!(difference(&cycle) < 8.0, "{}", difference(&cycle));
    let set = table("Time [s],Speed [km/h]", |k, v| {
        format!("{},{v:.2}", if k > fast { k - 20 } else { k })
    });
    let problems = read_with(set.as_bytes(), "").unwrap_err();
    assert!(
        problems
            .iter()
            .any(|own| own.proposal.as_ref().is_some_and(|own| own.repair == "cut")),
        "{problems:?}"
    );
    let with_cut = Columns::default().with_repairs(crate::channel::Repairs::parse("cut").unwrap());
    let cycle = read_columns("log.csv", set.as_bytes(), &with_cut).unwrap();
    assert!(difference(&cycle) < 1e-6);
    let turned = table("Time [s],Speed [km/h]", |k, v| match k {
        _ if k == fast => format!("{},{:.2}\n{k},{v:.2}", k + 1, speeds[k + 1]),
        _ if k == fast + 1 => "#".to_owned(),
        _ => format!("{k},{v:.2}"),
    });
    let problems = read_with(turned.as_bytes(), "").unwrap_err();
    let is_sort = |own: &crate::Problem| {
        own.proposal
            .as_ref()
            .is_some_and(|own| own.repair == "sort")
    };
    assert!(problems.iter().any(is_sort), "{problems:?}");
    let cars = table("Time [s],plate,Speed [km/h]", |k, v| {
        format!("{k},AB,{v:.2}\n{k},CD,{:.2}", v * 0.97)
    });
    let problems = read_with(cars.as_bytes(), "").unwrap_err();
    let proposed = problems.iter().map(|own| own.proposed()).max().unwrap();
    let cycle = read_with(cars.as_bytes(), proposed).unwrap();
    assert!(difference(&cycle) < 1e-6, "{proposed}");
    // Several rows a stamp: the mean is driven, and the first speeds of the stamps are the other end.
    let mut text = "Time [s],Speed [km/h]\n".to_owned();
    for k in 0..4 * (speeds.len() - 1) {
        let _ = writeln!(text, "{},{:.2}", k / 4, at(k as f64 / 4.0));
    }
    let cycle = read_with(text.as_bytes(), "").unwrap();
    let own = cycle.recording.as_deref().unwrap();
    assert_eq!((own.bounds.len(), own.left.is_some()), (3, true));
    let right = |own: &crate::cycle::Interval| {
        (3.6 * own.start_speed_m_s - speeds[own.start_s as usize]).abs()
    };
    assert!(own.bounds[0].intervals.iter().all(|own| right(own) < 1e-6));
}

/// Recordings that no driver makes, or that leave open what they are.
#[test]
fn doubts_come_with_the_drive() {
    let doubt = |text: &str, words: &str| {
        let cycle = read_with(text.as_bytes(), "").unwrap();
        let own = cycle
            .recording
            .as_deref()
            .map_or(&[][..], |own| &own.doubts);
        assert!(
            own.iter().any(|own| own.contains(words)),
            "{words}: {own:?}"
        );
    };
    // Speeds of the city in m/s under a name in km/h.
    let city = embedded("artemis_urban").unwrap();
    let mut text = "time_s,speed_kmh\n".to_owned();
    for (k, own) in city.manual.intervals.iter().take(700).enumerate() {
        let _ = writeln!(
            text,
            "{k},{:.3}",
            own.start_speed_m_s * (1.0 + 0.05 * (k as f64 / 19.0).sin())
        );
    }
    doubt(&text, "is the speed in the unit that is stated?");
    doubt(
        &table("time_s,speed_kmh,grade", |k, v| format!("{k},{v:.2},0.2")),
        "is the slope in the unit that is stated?",
    );
    doubt(
        &(table("time_s,speed_kmh", |k, v| format!("{k},{v:.2}"))
            + table("", |k, v| format!("{},{v:.2}", 5000 + k)).trim_start()),
        "are these drives of their own?",
    );
    let slow = table("time_s,speed_kmh", |k, v| match k % 5 {
        0 => format!("{k},{v:.2}"),
        _ => "#".to_owned(),
    });
    doubt(&slow, "the rows are 5.0 s apart");
    let udds = embedded("udds").unwrap();
    let mut text = "time_s,speed_kmh\n".to_owned();
    for (k, own) in udds.manual.intervals.iter().enumerate() {
        let _ = writeln!(text, "{},{:.3}", 0.5 * k as f64, 3.6 * own.start_speed_m_s);
    }
    let _ = writeln!(text, "{},0", 0.5 * udds.manual.intervals.len() as f64);
    doubt(&text, "this is udds with its rows 0.500 s apart");
    // No shipped cycle is doubted.
    for name in crate::cycle::names() {
        let cycle = embedded(name).unwrap();
        let mut text = "time_s,speed_kmh\n".to_owned();
        for own in cycle.manual.intervals.iter() {
            let _ = writeln!(text, "{},{:.6}", own.start_s, 3.6 * own.start_speed_m_s);
        }
        let last = cycle.manual.intervals.last().unwrap();
        let _ = writeln!(text, "{},{:.6}", last.end_s, 3.6 * last.end_speed_m_s);
        let own = read_with(text.as_bytes(), "").unwrap();
        let doubts = own.recording.map_or_else(Vec::new, |own| own.doubts);
        assert!(doubts.is_empty(), "{name}: {doubts:?}");
        assert!(
            own.manual
                .intervals
                .iter()
                .any(|own| !is_standstill(own.start_speed_m_s))
        );
    }
}

/// Truth: the mean of a speed that is linear within a step is that of its middle. A step at a change of gear is short.
#[test]
fn the_rows_of_a_trace_are_means_over_steps() {
    let speeds = drive();
    let at = |time: f64| {
        let second = time.floor() as usize;
        let next = speeds[(second + 1).min(speeds.len() - 1)];
        speeds[second] + (time - time.floor()) * (next - speeds[second])
    };
    let mut text = "time_s,dt_s,phase,speed_kmh,accel_m_s2,engine_speed_rpm\n".to_owned();
    for second in 0..speeds.len() - 1 {
        let ends = match second % 60 {
            30 => vec![0.04, 1.0],
            _ => vec![1.0],
        };
        let mut begin = 0.0;
        for end in ends {
            let middle = second as f64 + 0.5 * (begin + end);
            let _ = writeln!(
                text,
                "{},{},all,{},0,{}",
                second as f64 + end,
                end - begin,
                at(middle),
                30.0 * at(middle)
            );
            begin = end;
        }
    }
    let cycle = read_with(text.as_bytes(), "").unwrap();
    assert!(
        cycle
            .read_as
            .as_deref()
            .unwrap()
            .contains("means over steps")
    );
    // The first row is the middle of the first second.
    for own in cycle.manual.intervals.iter() {
        assert!((3.6 * own.start_speed_m_s - at(own.start_s + 0.5)).abs() < 1e-6);
    }
    let recording = cycle.recording.as_deref().unwrap();
    assert!(
        recording.doubts.is_empty() && recording.repairs.is_empty(),
        "{recording:?}"
    );
    let engine = &recording.measured[0];
    for (time, rad_s) in engine.time_s.iter().zip(&engine.values) {
        let rpm = rad_s * 30.0 / std::f64::consts::PI;
        assert!((rpm - 30.0 * at(time + 0.5)).abs() < 1e-6);
    }
}
