//! When a run computes what drives its cycle again, and its inputs.

use std::ffi::OsString;

use cvtcycle::analysis::sensitivity::Named;
use cvtcycle::config::Problems;
use cvtcycle::config::cycle::Cycle;
use cvtcycle::model::drive::Conditions;
use cvtcycle::output::record::Record;
use cvtcycle::report::run_files;

use crate::commands::program::words;
use crate::commands::vehicles::RunVehicle;

/// Steps of a cycle up to which `auto` drives it again and again: fourteen times for prices, some seven hundred times for sensitivities.
const MAX_STEPS: usize = 20_000;

/// When something is computed that drives the cycle again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// Unless the cycle is long.
    Auto,
    /// Always.
    Always,
    /// Never.
    Never,
}

impl When {
    /// Names on the command line.
    pub const NAMES: [(&'static str, When); 3] = [
        ("auto", When::Auto),
        ("always", When::Always),
        ("never", When::Never),
    ];

    /// Whether it is computed on a cycle with steps of a length, s.
    pub fn wanted(self, cycle: &Cycle, dt_s: f64) -> bool {
        match self {
            When::Auto => cycle.trace_for(true).step_count(dt_s) <= MAX_STEPS,
            When::Always => true,
            When::Never => false,
        }
    }
}

/// Inputs of a run.
///
/// # Errors
/// Problems of files that changed since they were read.
pub fn record(
    vehicles: &[RunVehicle],
    cycle: &Cycle,
    conditions: &Conditions,
    mode: When,
) -> Result<Record, Problems> {
    let named = |car: &RunVehicle| Named {
        name: car.name.clone(),
        word: car.word.clone(),
        options: car.options.clone(),
    };
    let cars: Vec<_> = vehicles
        .iter()
        .map(|car| (named(car), &car.setup))
        .collect();
    let plain = |word: &OsString| word.to_string_lossy().into_owned();
    let command = command_line(words().iter().map(plain));
    let wanted = mode.wanted(cycle, conditions.max_dt_s);
    run_files::record(command, &cars, cycle, conditions, wanted)
}

/// The command line, quoted for a shell.
fn command_line(words: impl Iterator<Item = String>) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:+@%".contains(c);
    let quoted = |word: String| match !word.is_empty() && word.chars().all(plain) {
        true => format!(" {word}"),
        false => format!(" '{}'", word.replace('\'', "'\\''")),
    };
    "cvtcycle".to_owned() + &words.map(quoted).collect::<String>()
}
