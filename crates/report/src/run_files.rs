//! Files of a run: traces, plots, and its inputs, from which a report is made.

use std::io::Write;
use std::slice::from_ref;

use rayon::prelude::*;

use cvtcycle_analysis::sensitivity::{Named, sensitivity};
use cvtcycle_config::cycle::Cycle;
use cvtcycle_config::setup::Setup;
use cvtcycle_config::{Problem, Problems};
use cvtcycle_model::drive::{Conditions, fuel_map};
use cvtcycle_output::History;
use cvtcycle_output::files::{FileWriter, OutputDir, Sums};
use cvtcycle_output::provenance::{car_record, cycle_record};
use cvtcycle_output::record::{Manifest, Record, SCHEMA};
use cvtcycle_output::summary::{Driven, Summary};
use cvtcycle_output::trace::{columns_for, write_trace};
use cvtcycle_study::store::write_trace_parquet;

use crate::charts::{self, Picture, PlotRun};

/// Formats of the traces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TraceFormat {
    /// Text.
    Csv,
    /// Parquet.
    Parquet,
    /// Both.
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
    let histories = driven.par_iter().map(|car| {
        let transmission = car.setup.transmission();
        let columns = columns_for(transmission.is_cvt(), &transmission.components());
        let history = History::from_rows(&car.outcome.rows, &columns, phases);
        (columns, history, fuel_map(car.setup))
    });
    let histories: Vec<_> = histories.collect();
    let plots = driven.iter().zip(&summary.runs).zip(&histories);
    let plots = plots.map(|((car, run), (_, history, fuel_map))| PlotRun {
        name: car.name,
        history,
        fuel_map: Some(fuel_map.clone()),
        group_fuel: charts::group_fuel(run),
        fuel_unit: run.over().unit(),
        fuel_energy_kj: run.fuel_energy_kj,
        published: charts::published_drive(car.name, summary),
    });
    let plots: Vec<PlotRun> = plots.collect();
    let mut files: Vec<(String, FileWriter)> = Vec::new();
    for ((car, plot), (columns, ..)) in driven.iter().zip(&plots).zip(&histories) {
        let (name, rows) = (car.name, &car.outcome.rows);
        if format != TraceFormat::Parquet {
            let write = |out: &mut (dyn Write + Send)| write_trace(out, columns, rows, phases);
            files.push((format!("trace_{name}.csv"), Box::new(write)));
        }
        if format != TraceFormat::Csv {
            let run = &summary.manifest.run;
            let write = move |out: &mut (dyn Write + Send)| {
                write_trace_parquet(out, columns, rows, phases, run)
            };
            files.push((format!("trace_{name}.parquet"), Box::new(write)));
        }
        for (kind, picture) in PLOTS {
            if kind == "pressure" && !plot.history.is_cvt() {
                continue;
            }
            let file = format!("{kind}_{name}.svg");
            files.push((file, svg(move || picture(plot))));
        }
    }
    let recorded = summary.recording.as_ref().zip(driven.first());
    let log = recorded
        .and_then(|(own, car)| Some((charts::logged(own, car.name, &cycle.title)?, car.name)));
    if let Some((picture, name)) = log {
        files.push((format!("log_{name}.svg"), svg(|| picture)));
    }
    files.push((
        "fuel_comparison.svg".to_owned(),
        svg(|| charts::fuel_bars(&plots)),
    ));
    dir.write_all(files)
}

/// Makes the picture of a run.
type Plot = fn(&PlotRun) -> Picture;

/// Pictures of a run; that of the pressure applies to a CVT only.
const PLOTS: [(&str, Plot); 5] = [
    ("driveline", charts::driveline),
    ("pressure", charts::pressure),
    ("temperatures", |run| charts::temperatures(from_ref(run))),
    ("losses", |run| charts::losses(from_ref(run))),
    ("operating_points", |run| {
        charts::operating_points(from_ref(run))
    }),
];

/// Writes a picture that is drawn only when its file is written.
fn svg<'a>(picture: impl FnOnce() -> Picture + Send + 'a) -> FileWriter<'a> {
    Box::new(move |out| out.write_all(picture().svg.as_bytes()))
}

/// Records the inputs of a run: command, cars, and with `sensitive` the effect of each value of each car.
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
        .par_iter()
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
