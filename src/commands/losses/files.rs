//! Rows as CSV and JSON, to standard output or into files; one row at a time.

use std::io::{self, Write};

use cvtcycle::config::Problem;
use cvtcycle::output::PROGRAM;
use cvtcycle::output::files::OutputDir;
use cvtcycle::output::losses::LossRow;
use cvtcycle::output::table;
use serde_json::{Map, Value, json};

use super::plan::Plan;
use super::plots;
use crate::commands::run::files::Written;

/// Version of the JSON object.
const SCHEMA: u32 = 1;
/// Most points that are drawn.
const MOST_DRAWN: usize = 100_000;

/// Everything of the JSON object but its points.
fn head(plan: &Plan) -> Map<String, Value> {
    let settings = json!({
        "vehicle": plan.setup.name,
        "transmission": if plan.is_cvt() { "cvt" } else { "manual" },
        "lubricant": plan.setup.oils().0.name,
        "formulation": plan.formulation,
        "set": plan.set,
    });
    let entries = [
        ("schema", json!(SCHEMA)),
        ("program", json!(PROGRAM)),
        ("settings", settings),
        ("columns", table::json_columns(&plan.columns)),
        ("count", json!(plan.grid.len())),
    ];
    entries
        .map(|(key, value)| (key.to_owned(), value))
        .into_iter()
        .collect()
}

/// Writes all points as CSV.
pub fn write_csv(
    out: &mut dyn Write,
    plan: &Plan,
    rows: impl Iterator<Item = LossRow>,
) -> io::Result<()> {
    table::write_csv(out, &plan.columns, rows, &[])
}

/// Writes the JSON object, its points one a line.
pub fn write_json(
    out: &mut dyn Write,
    plan: &Plan,
    rows: impl Iterator<Item = LossRow>,
) -> io::Result<()> {
    table::write_json(out, &head(plan), &plan.columns, rows)
}

/// Writes all files of a grid under their names, or none.
pub fn write(mut dir: OutputDir, plan: &Plan) -> Result<Written, Problem> {
    let rows = || plan.grid.rows(&plan.bench);
    dir.write("losses.csv", |out| write_csv(out, plan, rows()))?;
    dir.write("summary.json", |out| write_json(out, plan, rows()))?;
    let drawn = plan.grid.len() <= MOST_DRAWN;
    if drawn {
        for (name, svg) in plots::plots(plan) {
            dir.write(&name, |out| out.write_all(svg.as_bytes()))?;
        }
    }
    let written = Written::commit(dir)?;
    Ok(if drawn {
        written
    } else {
        written.with_note(format!("  no plots: more than {MOST_DRAWN} points\n"))
    })
}

/// Writes a component's map, and the head of the JSON object to mark the directory.
pub fn write_map(
    dir: &mut OutputDir,
    plan: &Plan,
    name: &str,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), Problem> {
    dir.write(&format!("map_{name}.csv"), |out| write(out))?;
    dir.write("summary.json", |out| {
        serde_json::to_writer_pretty(&mut *out, &head(plan))?;
        out.write_all(b"\n")
    })
}
