//! What the transmission rig was set to, as data with a status: `rigs/transmission.toml`.

use cvtcycle_model::bench::transmission::{
    Conditions, PressureFactors, RigCooler, Speeds, TransientTest,
};

use crate::{Bound, Document, KeyInfo, Problem, Reader, Section};

/// Prefix of the rig's keys on the command line, as in `--set rig.ratio.high=0.45`.
pub const PREFIX: &str = "rig.";

/// The embedded file: name and text.
pub const FILE: (&str, &str) = (
    "rig_transmission",
    include_str!("../../../rigs/transmission.toml"),
);

/// The embedded conditions with overrides; of `sets` only those count that begin with [`PREFIX`].
///
/// # Errors
/// All problems of the overrides, and of the file.
pub fn load(sets: &[String]) -> Result<(Conditions, Vec<KeyInfo>), Vec<Problem>> {
    let mut document = Document::parse(&format!("embedded:{}.toml", FILE.0), FILE.1)?;
    let own = sets.iter().filter(|set| set.starts_with(PREFIX));
    let mut problems: Vec<Problem> = own.filter_map(|set| document.set(set).err()).collect();
    let reader = Reader::new(&document);
    let conditions = read(&reader.root());
    match reader.finish() {
        Ok(keys) if problems.is_empty() => Ok((conditions, keys)),
        read => {
            problems.extend(read.err().unwrap_or_default());
            Err(problems)
        }
    }
}

/// Reads the keys of a rig file.
pub fn read(root: &Section) -> Conditions {
    let root = &root.table("rig");
    root.text("title", "name for people");
    let ratio = root.table("ratio");
    let speed = root.table("speed");
    let rpm = Bound::closed(100.0, 8000.0);
    let step = |from: &str, to: &str, what: &str| {
        let speeds = Speeds {
            from_rad_s: speed.number(from, rpm, &format!("lowest input speed in {what} ratio")),
            to_rad_s: speed.number(to, rpm, &format!("highest input speed in {what} ratio")),
            step_rad_s: speed.number(
                "step_rpm",
                Bound::closed(25.0, 4000.0),
                "step of the input speed",
            ),
        };
        if speeds.from_rad_s > speeds.to_rad_s {
            speed.complain(
                to,
                "at least the lowest speed",
                "the highest speed is below the lowest",
                &format!("swap `{from}` and `{to}`"),
            );
        }
        speeds
    };
    let of_ratio = Bound::closed(0.3, 3.0);
    let load = root.table("load");
    Conditions {
        low_ratio: ratio.number("low", of_ratio, "belt ratio of the tests in low"),
        high_ratio: ratio.number("high", of_ratio, "belt ratio of the tests in high"),
        low_speeds: step("low_from_rpm", "low_to_rpm", "low"),
        high_speeds: step("high_from_rpm", "high_to_rpm", "high"),
        oil_k: root.table("oil").numbers(
            "temps_degc",
            OIL,
            1..=20,
            "temperatures of the bulk oil in the steady tests",
        ),
        torques_nm: load.numbers(
            "torques_nm",
            TORQUE,
            1..=40,
            "torques at the output shaft in the loaded tests",
        ),
        throttle: load.number(
            "throttle_percent",
            Bound::closed(0.0, 100.0),
            "throttle that the clamp law sees",
        ),
        pressure: pressure(&root.table("pressure")),
        transient: transient(&root.table("transient")),
        room_k: root.table("room").number(
            "temp_degc",
            Bound::closed(-40.0, 60.0),
            "air around the box",
        ),
        cooler: cooler(&root.table("cooler")),
        transducer_nm: root.table("transducer").number(
            "error_nm",
            Bound::closed(0.0, 10.0),
            "error of the torque transducer",
        ),
    }
}

/// Oil temperatures that the rig can be set to.
pub const OIL: Bound = Bound::closed(-30.0, 120.0);
/// Torques that the rig can be set to: the transducer's range both ways.
pub const TORQUE: Bound = Bound::closed(-100.0, 1000.0);

fn pressure(s: &Section) -> PressureFactors {
    let factor = |key: &str, what: &str| {
        s.number(
            key,
            Bound::closed(0.5, 1.5),
            &format!("secondary pressure {what}, over that of the complete box"),
        )
    };
    PressureFactors {
        final_drive_removed: factor("final_drive_removed", "with the final drive removed"),
        belt_removed: factor("belt_removed", "with the belt removed as well"),
        clutch_removed: factor("clutch_removed", "with the clutch plates removed as well"),
        second_box: factor("second_box", "of the second box (RT-6)"),
    }
}

fn transient(s: &Section) -> TransientTest {
    let test = TransientTest {
        speed_rad_s: s.number(
            "speed_rpm",
            Bound::closed(500.0, 8000.0),
            "input speed of the transients",
        ),
        start_k: s.number(
            "start_degc",
            OIL,
            "everything at the start, and the sump when cooling ends",
        ),
        end_k: s.number("end_degc", OIL, "sump when the warm-up ends"),
    };
    if test.end_k - test.start_k < 5.0 {
        s.complain(
            "end_degc",
            "at least 5 K above the start",
            "the warm-up has no way to go",
            "raise the end or lower `rig.transient.start_degc`",
        );
    }
    test
}

fn cooler(s: &Section) -> RigCooler {
    RigCooler {
        flow_m3_s: s.number(
            "flow_l_min",
            Bound::open_low(0.0, 100.0),
            "oil flow through the rig's cooler (RT-2)",
        ),
        conductance_w_k: s.number(
            "conductance_w_k",
            Bound::open_low(0.0, 20_000.0),
            "conductance of the rig's cooler (RT-2)",
        ),
        coolant_k: s.number(
            "coolant_degc",
            Bound::closed(-60.0, 60.0),
            "coolant of the rig's cooler (RT-2)",
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speeds_hold_both_ends() {
        let (c, keys) = load(&[]).unwrap();
        let rpm = |s: Speeds| {
            s.list()
                .iter()
                .map(|w| (w * 30.0 / std::f64::consts::PI).round())
                .collect::<Vec<_>>()
        };
        let low = rpm(c.low_speeds);
        assert_eq!((low.len(), low[0], low[12]), (13, 1000.0, 4000.0));
        assert_eq!(rpm(c.high_speeds).len(), 10);
        assert!(
            keys.iter()
                .all(|k| k.key.starts_with(PREFIX) && !k.status.is_empty() && !k.doc.is_empty()),
            "{keys:?}"
        );
    }

    #[test]
    fn every_problem_of_an_override_is_told() {
        let sets = [
            "rig.transient.end_degc=10",
            "rig.ratio.low=9",
            "rig.speed.stepp_rpm=3",
            "road_load.mass_kg=3",
        ]
        .map(str::to_owned);
        let problems = load(&sets).unwrap_err();
        assert_eq!(problems.len(), 3, "{problems:#?}");
        assert!(
            problems
                .iter()
                .all(|p| p.key.starts_with("rig.") && p.place.file.starts_with("--set rig.")),
            "{problems:#?}"
        );
        assert!(
            problems
                .iter()
                .any(|p| p.hint.contains("rig.speed.step_rpm")),
            "{problems:#?}"
        );
    }
}
