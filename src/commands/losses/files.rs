//! Rows as CSV and JSON, to standard output or into files; one row at a time.

use std::io::{self, Write};

use cvtcycle::config::Problem;
use cvtcycle::output::PROGRAM;
use cvtcycle::output::files::OutputDir;
use cvtcycle::output::losses::LossRow;
use cvtcycle::output::table;
use serde_json::{Map, Value, json};

use super::plan::LossesPlan;
use super::plots;
use crate::print::WrittenFiles;

/// Version of the JSON object.
const SCHEMA: u32 = 1;
/// Largest number of points that are drawn.
const MAX_DRAWN: usize = 100_000;

/// Everything of the JSON object but its points.
fn head(plan: &LossesPlan) -> Map<String, Value> {
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
    plan: &LossesPlan,
    rows: impl Iterator<Item = LossRow>,
) -> io::Result<()> {
    table::write_csv(out, &plan.columns, rows, &[])
}

/// Writes the JSON object, its points one a line.
pub fn write_json(
    out: &mut dyn Write,
    plan: &LossesPlan,
    rows: impl Iterator<Item = LossRow>,
) -> io::Result<()> {
    table::write_json(out, &head(plan), &plan.columns, rows)
}

/// Writes all files of a grid under their names, or none.
pub fn write(mut dir: OutputDir, plan: &LossesPlan) -> Result<WrittenFiles, Problem> {
    let rows = || plan.grid.rows(&plan.bench);
    dir.write("losses.csv", |out| write_csv(out, plan, rows()))?;
    dir.write("summary.json", |out| write_json(out, plan, rows()))?;
    if plan.grid.len() > MAX_DRAWN {
        let note = format!("  no plots: more than {MAX_DRAWN} points\n");
        return Ok(WrittenFiles::commit(dir)?.with_note(note));
    }
    for (name, svg) in plots::plots(plan) {
        dir.write(&name, |out| out.write_all(svg.as_bytes()))?;
    }
    WrittenFiles::commit(dir)
}

/// Writes the map of a component, and the head of the JSON object, which marks the directory as a result.
pub fn write_map(
    mut dir: OutputDir,
    plan: &LossesPlan,
    name: &str,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<WrittenFiles, Problem> {
    dir.write(&format!("map_{name}.csv"), |out| write(out))?;
    dir.write("summary.json", |out| {
        serde_json::to_writer_pretty(&mut *out, &head(plan))?;
        out.write_all(b"\n")
    })?;
    WrittenFiles::commit(dir)
}
