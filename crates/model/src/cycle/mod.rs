//! Drive cycles: what speed is asked of the car at what time, in which gear, on which slope.
//!
//! SI units throughout: kilometres per hour and percent end where a table is read.

pub mod gears;
mod trace;

pub use gears::{GearColumns, GearCommand};
pub use trace::{Interval, Motion, Step, Trace};

/// How the fuel of the phases is put together to the cycle's one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weighting {
    /// Fuel of the whole cycle over its distance.
    None,
    /// 40 CFR 86.144: phases `cold_transient` (ct), `stabilised` (s), `hot_soak`, `hot_transient` (ht);
    /// Y = 0.43 (Y_ct + Y_s)/(D_ct + D_s) + 0.57 (Y_ht + Y_s)/(D_ht + D_s). The soak counts in no bag.
    Ftp75,
}

impl Weighting {
    /// Share of the cold test in [`Weighting::Ftp75`] (40 CFR 86.144: 43 % of trips start cold).
    pub const FTP75_COLD: f64 = 0.43;
    /// Share of the hot test in [`Weighting::Ftp75`].
    pub const FTP75_HOT: f64 = 0.57;
}

/// A drive cycle: one name, and one trace each for manual and for automatic cars.
#[derive(Clone, Debug, PartialEq)]
pub struct Cycle {
    /// Name under which it was asked for; a user's file gives its name without the extension.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// Names of the phases as written in the table, in the order in which they first occur;
    /// [`Interval::phase`] is the index into this list. Empty for a cycle without phases (all intervals then bear phase 0).
    pub phases: Vec<String>,
    /// How the phases are weighted.
    pub weighting: Weighting,
    /// What a car with a manual box drives.
    pub manual: Trace,
    /// What an automatic or a CVT drives; the manual trace if none.
    pub automatic: Option<Trace>,
}

impl Cycle {
    /// The trace that a car drives: with `automatic` the one of an automatic or CVT, without it that of a manual gearbox.
    /// Most cycles have one trace for both; the ECE cycles hold the speed during gear changes, for manual cars only.
    pub fn trace_for(&self, automatic: bool) -> &Trace {
        match &self.automatic {
            Some(trace) if automatic => trace,
            _ => &self.manual,
        }
    }

    /// Whether the manual trace prescribes gears, for any number of gears.
    pub fn has_gears(&self) -> bool {
        self.manual.has_gears()
    }

    /// Groups of phases for the report: name in lower case and the phase indices in it, in the order of the cycle.
    /// `ECE15_1` to `ECE15_4` are one group `ece15`; a cycle without phases is one group with the cycle's name.
    pub fn phase_groups(&self) -> Vec<(String, Vec<u16>)> {
        if self.phases.is_empty() {
            return vec![(self.name.clone(), vec![0])];
        }
        let mut groups: Vec<(String, Vec<u16>)> = Vec::new();
        for (phase, name) in (0_u16..).zip(&self.phases) {
            let name = phase_group(name);
            match groups.iter_mut().find(|group| group.0 == name) {
                Some(group) => group.1.push(phase),
                None => groups.push((name, vec![phase])),
            }
        }
        groups
    }
}

/// The group to which a phase of that name belongs.
pub fn phase_group(phase: &str) -> String {
    let lower = phase.to_lowercase();
    match lower.strip_prefix("ece15_") {
        Some("1" | "2" | "3" | "4") => "ece15".to_owned(),
        _ => lower,
    }
}
