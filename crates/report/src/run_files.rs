//! The files of a run: traces, plots, and the inputs that it was made from. A report is made of them.

use cvtcycle_config::cycle::Cycle;
use cvtcycle_config::setup::Setup;
use cvtcycle_config::{Problem, Problems};
use cvtcycle_model::drive::{Conditions, fuel_map};
use cvtcycle_output::History;
use cvtcycle_output::files::{OutputDir, Sums};
use cvtcycle_output::provenance::{car_record, cycle_record};
use cvtcycle_output::record::{Manifest, Record, SCHEMA};
use cvtcycle_output::summary::{Driven, Summary};
use cvtcycle_output::trace::{columns_for, write_trace};
use cvtcycle_study::sensitivity::{Named, sensitivity};
use cvtcycle_study::store::write_trace_parquet;

use crate::charts::{self, PlotRun};

/// Formats of the traces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TraceFormat {
    /// Text.
    Csv,
    /// Parquet.
    Parquet,
    /// Both of them.
    Both,
}

impl TraceFormat {
    /// Names of the formats.
    pub const NAMES: [(&'static str, TraceFormat); 3] = [
        ("csv", TraceFormat::Csv),
        ("parquet", TraceFormat::Parquet),
        ("both", TraceFormat::Both),
    ];
}

/// Writes the traces and the plots.
///
/// # Errors
/// Those of the folder.
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
            published: charts::published_drive(name, summary),
        };
        let pressure = history
            .is_cvt()
            .then(|| ("pressure", charts::pressure(&plot)));
        let one = std::slice::from_ref(&plot);
        let plots = [
            Some(("driveline", charts::driveline(&plot))),
            pressure,
            Some(("temperatures", charts::temperatures(one))),
            Some(("losses", charts::losses(one))),
            Some(("operating_points", charts::operating_points(one))),
        ];
        for (kind, picture) in plots.into_iter().flatten() {
            dir.put(&format!("{kind}_{name}.svg"), picture.svg)?;
        }
        runs.push(plot);
    }
    dir.put("fuel_comparison.svg", charts::fuel_bars(&runs).svg)
}

/// Inputs of a run: the words that made it, its cars, and with `sensitive` the effect of each value of each car.
///
/// # Errors
/// Problems of files that changed since they were read.
pub fn record(
    command: String,
    cars: &[(Named, &Setup)],
    cycle: &Cycle,
    conditions: &Conditions,
    sensitive: bool,
) -> Result<Record, Problems> {
    let records = cars
        .iter()
        .map(|(car, setup)| car_record(&car.name, &car.word, &car.options, setup));
    let named: Vec<Named> = cars.iter().map(|(car, _)| car.clone()).collect();
    Ok(Record {
        manifest: Manifest::new(SCHEMA),
        command,
        cycle: cycle_record(cycle),
        cars: records.collect::<Result<_, _>>()?,
        sensitivity: sensitive
            .then(|| sensitivity(&named, cycle, conditions))
            .transpose()?,
        files: Sums::new(),
    })
}
