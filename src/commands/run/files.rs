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

use crate::args::names_of;
use crate::print::WrittenFiles;

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

    /// Names for completions.
    pub fn names() -> Vec<&'static str> {
        names_of(&TraceFormat::NAMES)
    }
}

/// Writes all files of the run under their names, or none.
pub fn write(
    mut dir: OutputDir,
    format: TraceFormat,
    json: &str,
    summary: &Summary,
    cycle: &Cycle,
    driven: &[Driven],
) -> Result<WrittenFiles, Problem> {
    dir.write("summary.json", |out| out.write_all(json.as_bytes()))?;
    let phases = if cycle.phases.is_empty() {
        std::slice::from_ref(&cycle.name)
    } else {
        &cycle.phases
    };
    let columns = |car: &Driven| {
        columns_for(
            car.setup.transmission().is_cvt(),
            &car.setup.transmission().components(),
        )
    };
    let histories: Vec<History> = driven
        .iter()
        .map(|car| History::of(&car.outcome.rows, &columns(car), phases))
        .collect();
    let mut runs = Vec::new();
    for ((car, run), history) in driven.iter().zip(&summary.runs).zip(&histories) {
        let (rows, columns) = (&car.outcome.rows, columns(car));
        if format != TraceFormat::Parquet {
            dir.write(&format!("trace_{}.csv", car.name), |out| {
                write_trace(out, &columns, rows, phases)
            })?;
        }
        if format != TraceFormat::Csv {
            dir.write(&format!("trace_{}.parquet", car.name), |out| {
                write_trace_parquet(out, &columns, rows, phases)
            })?;
        }
        let plot = PlotRun {
            name: car.name,
            history,
            fuel_map: Some(fuel_map(car.setup)),
            group_fuel: group_fuel(run),
        };
        write_plots(&mut dir, &plot)?;
        runs.push(plot);
    }
    put(
        &mut dir,
        "fuel_comparison.svg",
        &charts::fuel_bars(&runs).svg,
    )?;
    WrittenFiles::commit(dir)
}

fn write_plots(dir: &mut OutputDir, run: &PlotRun) -> Result<(), Problem> {
    let mut plots = vec![("driveline", charts::driveline(run))];
    if run.history.is_cvt() {
        plots.push(("pressure", charts::pressure(run)));
    }
    plots.push(("temperatures", charts::temperatures(run)));
    plots.push(("losses", charts::losses(run)));
    plots.push(("operating_points", charts::operating_points(run)));
    plots
        .into_iter()
        .try_for_each(|(kind, picture)| put(dir, &format!("{kind}_{}.svg", run.name), &picture.svg))
}

fn put(dir: &mut OutputDir, name: &str, text: &str) -> Result<(), Problem> {
    dir.write(name, |out| out.write_all(text.as_bytes()))
}

fn group_fuel(run: &RunSummary) -> Vec<(String, f64)> {
    let number = |x: Option<f64>| x.unwrap_or(f64::NAN);
    let mut groups: Vec<(String, f64)> = Vec::new();
    // The only group of a cycle is its total.
    if run.phases.len() > 1 {
        groups.extend(
            run.phases
                .iter()
                .map(|p| (p.name.clone(), number(p.fuel_l_per_100km))),
        );
    }
    groups.push(("total".to_owned(), number(run.fuel_l_per_100km)));
    if let Some(weighted) = run.weighted_fuel_l_per_100km {
        groups.push(("weighted".to_owned(), weighted));
    }
    groups
}
