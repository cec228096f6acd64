//! What the transmission rig was set to, as data with a status: `rigs/rig_transmission.toml`.

use cvtcycle_model::bench::transmission::Conditions;
pub use cvtcycle_model::bench::transmission::{OIL, TORQUE};

use crate::embedded;
use crate::{Document, KeyInfo, Problems, Reader, Section};

/// Prefix of the rig's keys on the command line, as in `--set rig.ratio.high=0.45`.
pub const PREFIX: &str = "rig.";

/// The embedded conditions with overrides; of `sets` only those count that begin with [`PREFIX`].
///
/// # Errors
/// All problems of the overrides, and of the file.
pub fn load(sets: &[String]) -> Result<(Conditions, Vec<KeyInfo>), Problems> {
    let (name, text) = embedded::rigs()[0];
    let mut document = Document::parse(&format!("embedded:{name}.toml"), text)?;
    let own = sets.iter().filter(|set| set.starts_with(PREFIX));
    let mut problems: Problems = own.filter_map(|set| document.set(set).err()).collect();
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
#[must_use]
pub fn read(root: &Section) -> Conditions {
    Conditions::from_values(root)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cvtcycle_model::bench::transmission::Speeds;

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
    fn every_problem_of_an_override_is_reported() {
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
