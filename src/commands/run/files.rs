//! The files of a run: traces, plots, and the inputs that it was made from.

use cvtcycle::config::cycle::Cycle;
use cvtcycle::config::{Problem, Problems};
use cvtcycle::model::drive::{Conditions, fuel_map};
use cvtcycle::output::History;
use cvtcycle::output::files::{OutputDir, Sums};
use cvtcycle::output::provenance::{car_record, cycle_record};
use cvtcycle::output::record::{Manifest, Record, SCHEMA};
use cvtcycle::output::summary::{Driven, Summary};
use cvtcycle::output::trace::{columns_for, write_trace};
use cvtcycle::report::charts::{self, PlotRun};
use cvtcycle::study::sensitivity::{Named, sensitivity};
use cvtcycle::study::store::write_trace_parquet;

use crate::commands::vehicles::RunVehicle;

/// Formats of the traces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TraceFormat {
    Csv,
    Parquet,
    Both,
}

impl TraceFormat {
    /// Names on the command line.
    pub const NAMES: [(&'static str, TraceFormat); 3] = [
        ("csv", TraceFormat::Csv),
        ("parquet", TraceFormat::Parquet),
        ("both", TraceFormat::Both),
    ];
}

/// Writes the traces and the plots.
pub fn write(
    dir: &mut OutputDir,
    format: TraceFormat,
    summary: &Summary,
    cycle: &Cycle,
    driven: &[Driven],
) -> Result<(), Problem> {
    let phases = match cycle.phases.is_empty() {
        true => std::slice::from_ref(&cycle.name),
        false => &cycle.phases,
    };
    let histories = driven.iter().map(|car| {
        let transmission = car.setup.transmission();
        let columns = columns_for(transmission.is_cvt(), &transmission.components());
        let history = History::of(&car.outcome.rows, &columns, phases);
        (columns, history)
    });
    let histories: Vec<_> = histories.collect();
    let mut runs = Vec::new();
    for ((car, run), (columns, history)) in driven.iter().zip(&summary.runs).zip(&histories) {
        let (name, rows) = (car.name, &car.outcome.rows);
        if format != TraceFormat::Parquet {
            dir.write(&format!("trace_{name}.csv"), |out| {
                write_trace(out, columns, rows, phases)
            })?;
        }
        if format != TraceFormat::Csv {
            dir.write(&format!("trace_{name}.parquet"), |out| {
                write_trace_parquet(out, columns, rows, phases, &summary.manifest.run)
            })?;
        }
        let plot = PlotRun {
            name,
            history,
            fuel_map: Some(fuel_map(car.setup)),
            group_fuel: charts::group_fuel(run),
        };
        let pressure = history
            .is_cvt()
            .then(|| ("pressure", charts::pressure(&plot)));
        let plots = [
            Some(("driveline", charts::driveline(&plot))),
            pressure,
            Some(("temperatures", charts::temperatures(&plot))),
            Some(("losses", charts::losses(&plot))),
            Some(("operating_points", charts::operating_points(&plot))),
        ];
        for (kind, picture) in plots.into_iter().flatten() {
            dir.put(&format!("{kind}_{name}.svg"), picture.svg)?;
        }
        runs.push(plot);
    }
    dir.put("fuel_comparison.svg", charts::fuel_bars(&runs).svg)
}

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
    let records = vehicles
        .iter()
        .map(|car| car_record(&car.name, &car.word, &car.options, &car.setup));
    let wanted = mode.wanted(cycle, conditions.max_dt_s);
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
        files: Sums::new(),
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
