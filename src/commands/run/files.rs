//! The files of a run.

use cvtcycle::config::Problem;
use cvtcycle::config::cycle::Cycle;
use cvtcycle::model::drive::fuel_map;
use cvtcycle::output::History;
use cvtcycle::output::files::OutputDir;
use cvtcycle::output::summary::{Driven, RunSummary, Summary};
use cvtcycle::output::trace::{columns_for, write_trace};
use cvtcycle::report::charts::{self, PlotRun};
use cvtcycle::study::store::write_trace_parquet;

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
                write_trace_parquet(out, columns, rows, phases)
            })?;
        }
        let plot = PlotRun {
            name,
            history,
            fuel_map: Some(fuel_map(car.setup)),
            group_fuel: group_fuel(run),
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

/// Fuel of each phase, of the cycle, and weighted where the cycle is, L/100 km.
fn group_fuel(run: &RunSummary) -> Vec<(String, f64)> {
    let total = [("total", run.fuel_l_per_100km)].into_iter();
    let weighted = run
        .weighted_fuel_l_per_100km
        .map(|fuel| ("weighted", Some(fuel)));
    // The only group of a cycle is its total.
    let phases = run.phases.iter().filter(|_| run.phases.len() > 1);
    let phases = phases.map(|phase| (phase.name.as_str(), phase.fuel_l_per_100km));
    let all = phases.chain(total).chain(weighted);
    all.map(|(name, fuel)| (name.to_owned(), fuel.unwrap_or(f64::NAN)))
        .collect()
}
