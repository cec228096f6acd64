//! Optional computations of a run that repeat its cycle, and the record of its inputs.

use std::ffi::OsString;

use cvtcycle::analysis::sensitivity::Named;
use cvtcycle::config::Problems;
use cvtcycle::config::cycle::Cycle;
use cvtcycle::model::drive::Conditions;
use cvtcycle::output::record::Record;
use cvtcycle::report::run_files;

use crate::commands::program::words;
use crate::commands::vehicles::RunVehicle;

/// Maximum number of steps for `auto`. Prices drive the cycle fourteen times, sensitivities some seven hundred times.
const MAX_STEPS: usize = 20_000;

/// Choice for a computation that repeats the cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// Computed unless the cycle is long.
    Auto,
    /// Always computed.
    Always,
    /// Never computed.
    Never,
}

impl When {
    /// Names on the command line.
    pub const NAMES: [(&'static str, When); 3] = [
        ("auto", When::Auto),
        ("always", When::Always),
        ("never", When::Never),
    ];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        let found = When::NAMES.iter().find(|(_, when)| *when == self);
        found.map_or("", |(name, _)| name)
    }

    /// Decides for a cycle and a time step, s.
    pub fn wanted(self, cycle: &Cycle, dt_s: f64) -> bool {
        match self {
            When::Auto => cycle.trace_for(true).step_count(dt_s) <= MAX_STEPS,
            When::Always => true,
            When::Never => false,
        }
    }
}

/// Record of the inputs of a run.
/// # Errors
/// Files that changed since they were read.
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

/// Command line, quoted for a shell.
fn command_line(words: impl Iterator<Item = String>) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:+@%".contains(c);
    let quoted = |word: String| match !word.is_empty() && word.chars().all(plain) {
        true => format!(" {word}"),
        false => format!(" '{}'", word.replace('\'', "'\\''")),
    };
    "cvtcycle".to_owned() + &words.map(quoted).collect::<String>()
}
