//! Cycles that are written and read again: the truth is the cycle itself.

use cvtcycle_config::cycle::{Cycle, Format, embedded, names, read_csv, write};

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * (1.0 + a.abs())
}

fn again(name: &str, text: &str) -> Cycle {
    read_csv("again.csv", text.as_bytes()).unwrap_or_else(|problems| panic!("{name}\n{problems}"))
}

#[test]
fn every_cycle_survives_every_form() {
    for name in names() {
        let cycle = embedded(name).unwrap();
        for (form, format) in Format::NAMES {
            for automatic in [false, true] {
                let trace = cycle.trace_for(automatic);
                let written = write(&cycle, trace, format);
                let other = again(name, &written.text);
                let pairs = trace.intervals.iter().zip(other.manual.intervals.iter());
                assert_eq!(
                    trace.intervals.len(),
                    other.manual.intervals.len(),
                    "{name} {form}"
                );
                for (a, b) in pairs {
                    assert!(
                        near(a.end_s, b.end_s) && near(a.end_speed_m_s, b.end_speed_m_s),
                        "{name} {form}: {a:?} {b:?}"
                    );
                    assert!(
                        format == Format::Epa || near(a.grade, b.grade),
                        "{name} {form}"
                    );
                }
            }
        }
    }
}

#[test]
fn the_own_table_has_all_of_a_cycle() {
    for name in names() {
        let cycle = embedded(name).unwrap();
        let written = write(&cycle, &cycle.manual, Format::Csv);
        assert!(written.left_out.is_empty());
        let other = again(name, &written.text);
        assert_eq!(other.read_as, None, "{name}");
        let own: Vec<_> = cycle.manual.gear_columns().collect();
        assert_eq!(
            other.manual.gear_columns().collect::<Vec<_>>(),
            own,
            "{name}"
        );
        let of_phase = |cycle: &Cycle, k: usize| -> Option<String> {
            cycle
                .phases
                .get(usize::from(cycle.manual.intervals[k].phase))
                .cloned()
        };
        for (k, i) in cycle.manual.intervals.iter().enumerate() {
            assert_eq!(of_phase(&cycle, k), of_phase(&other, k), "{name} {k}");
            assert_eq!(
                i.engine_off, other.manual.intervals[k].engine_off,
                "{name} {k}"
            );
        }
    }
}

#[test]
fn what_a_form_cannot_hold_is_said() {
    let nedc = embedded("ece15_eudc").unwrap();
    let left_out = |format| write(&nedc, &nedc.manual, format).left_out.join(", ");
    assert_eq!(left_out(Format::Epa), "phases, gears");
    assert_eq!(left_out(Format::Fastsim), "phases, gears");
    assert_eq!(
        left_out(Format::Vdri),
        "phases, all gears but the first column"
    );
    let ftp = embedded("ftp75").unwrap();
    assert!(
        write(&ftp, &ftp.manual, Format::Epa)
            .left_out
            .contains(&"the engine's rest")
    );
}
