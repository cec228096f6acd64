//! Curves and points as CSV and JSON, and the files of a run.

use std::io::{self, Write};

use cvtcycle::config::Problem;
use cvtcycle::model::bench::variator::{CurveSummary, Resolution, VariatorRow};
use cvtcycle::output::PROGRAM;
use cvtcycle::output::files::OutputDir;
use cvtcycle::output::table;
use cvtcycle::output::variator::{curve_columns, point_columns};
use serde_json::json;

use super::plan::{Curve, VariatorPlan};
use super::plots;
use crate::print::WrittenFiles;

/// Version of the JSON object.
const SCHEMA: u32 = 1;

/// Writes every point of every curve as CSV.
pub fn write_points(out: &mut dyn Write, curves: &[Curve]) -> io::Result<()> {
    table::write_csv(out, &point_columns(), points(curves), &[])
}

/// Writes a line a curve as CSV.
pub fn write_curves(out: &mut dyn Write, curves: &[Curve]) -> io::Result<()> {
    table::write_csv(out, &curve_columns(), numbers(curves), &[])
}

fn points(curves: &[Curve]) -> impl Iterator<Item = &VariatorRow> {
    curves.iter().flat_map(|curve| &curve.rows)
}

fn numbers(curves: &[Curve]) -> Vec<(CurveSummary, Resolution)> {
    curves
        .iter()
        .map(|curve| (curve.summary, curve.resolution))
        .collect()
}

/// Writes one JSON object, its points one a line.
pub fn write_json(out: &mut dyn Write, plan: &VariatorPlan, curves: &[Curve]) -> io::Result<()> {
    let columns = point_columns();
    let settings = json!({
        "vehicle": plan.setup.name,
        "lubricant": plan.setup.oils().0.name,
        "formulation": plan.formulation,
        "set": plan.set,
        "pulses": plan.pulses,
    });
    let entries = [
        ("schema", json!(SCHEMA)),
        ("program", json!(PROGRAM)),
        ("settings", settings),
        (
            "curves",
            table::json_rows(&curve_columns(), &numbers(curves)),
        ),
        ("columns", table::json_columns(&columns)),
        ("count", json!(points(curves).count())),
    ];
    let head = entries
        .map(|(key, value)| (key.to_owned(), value))
        .into_iter()
        .collect();
    table::write_json(out, &head, &columns, points(curves))
}

/// Writes all files of a run under their names, or none.
pub fn write(
    mut dir: OutputDir,
    plan: &VariatorPlan,
    curves: &[Curve],
) -> Result<WrittenFiles, Problem> {
    dir.write("curves.csv", |out| write_curves(out, curves))?;
    dir.write("points.csv", |out| write_points(out, curves))?;
    dir.write("summary.json", |out| write_json(out, plan, curves))?;
    for (name, svg) in plots::plots(plan, curves) {
        dir.write(name, |out| out.write_all(svg.as_bytes()))?;
    }
    WrittenFiles::commit(dir)
}
