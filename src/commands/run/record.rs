//! Inputs of a run, for `inputs.json`.

use cvtcycle::config::Problems;
use cvtcycle::config::cycle::Cycle;
use cvtcycle::model::drive::Conditions;
use cvtcycle::output::provenance::{car_record, cycle_record};
use cvtcycle::output::record::{Manifest, Record, SCHEMA};
use cvtcycle::study::sensitivity::{Named, sensitivity};

use super::vehicles::RunVehicle;

/// Steps of a cycle up to which `auto` computes sensitivities, which take some seven hundred runs.
const MAX_STEPS: usize = 20_000;

/// When sensitivities are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SensitivityMode {
    /// Unless the cycle is long.
    Auto,
    /// Always.
    Always,
    /// Never.
    Never,
}

impl SensitivityMode {
    /// Names on the command line.
    pub const NAMES: [(&'static str, SensitivityMode); 3] = [
        ("auto", SensitivityMode::Auto),
        ("always", SensitivityMode::Always),
        ("never", SensitivityMode::Never),
    ];
}

/// Inputs of a run.
///
/// # Errors
/// Problems of files that changed since they were read.
pub fn record(
    vehicles: &[RunVehicle],
    cycle: &Cycle,
    conditions: &Conditions,
    mode: SensitivityMode,
) -> Result<Record, Problems> {
    let records = vehicles
        .iter()
        .map(|car| car_record(&car.name, &car.word, &car.options, &car.setup));
    let steps = cycle.trace_for(true).step_count(conditions.max_dt_s);
    let wanted = match mode {
        SensitivityMode::Auto => steps <= MAX_STEPS,
        SensitivityMode::Always => true,
        SensitivityMode::Never => false,
    };
    let named = |car: &RunVehicle| Named {
        name: car.name.clone(),
        word: car.word.clone(),
        options: car.options.clone(),
    };
    let named: Vec<Named> = vehicles.iter().map(named).collect();
    let words = std::env::args_os().skip(1);
    Ok(Record {
        manifest: Manifest::new(SCHEMA),
        command: command_line(words.map(|word| word.to_string_lossy().into_owned())),
        cycle: cycle_record(cycle),
        cars: records.collect::<Result<_, _>>()?,
        sensitivity: wanted
            .then(|| sensitivity(&named, cycle, conditions))
            .transpose()?,
    })
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
