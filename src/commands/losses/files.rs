//! Rows as CSV and JSON, to standard output or into files; one row at a time.

use std::io::{self, Write};
use std::path::PathBuf;

use cvtcycle::config::Problem;
use cvtcycle::output::Flags;
use cvtcycle::output::columns::Value;
use cvtcycle::output::files::OutputDir;
use cvtcycle::output::losses::{LossColumn, LossRow};
use cvtcycle::output::trace::push_value;

use super::plan::Plan;
use super::plots;

/// Version of the JSON object.
const SCHEMA: u32 = 1;
/// Most points that are drawn.
const MOST_DRAWN: usize = 100_000;

/// What was written, and what an earlier run left beside it.
#[derive(Debug, Default)]
pub struct Written {
    paths: Vec<PathBuf>,
    left_over: Vec<String>,
    note: String,
}

impl Written {
    /// The files, one a line.
    pub fn text(&self) -> String {
        let lines: Vec<String> = self
            .paths
            .iter()
            .map(|path| format!("  {}\n", path.display()))
            .collect();
        format!("\nFiles written\n{}{}", lines.concat(), self.note)
    }

    /// A word about files of an earlier run that this one has not replaced.
    pub fn left_over_text(&self) -> String {
        if self.left_over.is_empty() {
            return String::new();
        }
        format!(
            "cvtcycle: left from an earlier run and not replaced: {}\n",
            self.left_over.join(", ")
        )
    }
}

/// Writes all rows as CSV.
pub fn write_csv(
    out: &mut dyn Write,
    columns: &[LossColumn],
    rows: impl Iterator<Item = LossRow>,
) -> io::Result<()> {
    let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
    writeln!(out, "{}", names.join(","))?;
    let mut line = String::new();
    for row in rows {
        line.clear();
        for (k, column) in columns.iter().enumerate() {
            if k > 0 {
                line.push(',');
            }
            push_value(&mut line, column.value(&row), &[]);
        }
        line.push('\n');
        out.write_all(line.as_bytes())?;
    }
    Ok(())
}

/// Everything of the JSON object but its points.
fn head(plan: &Plan) -> serde_json::Value {
    let columns: Vec<serde_json::Value> =
        plan.columns.iter().map(|column| serde_json::json!({ "name": column.name, "unit": column.unit, "meaning": column.doc })).collect();
    serde_json::json!({
        "schema": SCHEMA,
        "program": concat!("cvtcycle ", env!("CARGO_PKG_VERSION")),
        "settings": {
            "vehicle": plan.setup.name,
            "transmission": if plan.is_cvt() { "cvt" } else { "manual" },
            "lubricant": plan.setup.oils().0.name,
            "formulation": plan.formulation,
            "set": plan.set,
        },
        "columns": columns,
        "count": plan.grid.len(),
    })
}

/// Writes the JSON object, its points one a line.
pub fn write_json(
    out: &mut dyn Write,
    plan: &Plan,
    rows: impl Iterator<Item = LossRow>,
) -> io::Result<()> {
    let head = serde_json::to_string_pretty(&head(plan))?;
    // The closing brace of the head comes after the points.
    write!(
        out,
        "{},\n  \"points\": [",
        head.trim_end().trim_end_matches('}').trim_end()
    )?;
    for (k, row) in rows.enumerate() {
        let point: serde_json::Map<String, serde_json::Value> = plan
            .columns
            .iter()
            .map(|column| (column.name.clone(), json_value(column.value(&row))))
            .collect();
        write!(
            out,
            "{}\n    {}",
            if k > 0 { "," } else { "" },
            serde_json::Value::Object(point)
        )?;
    }
    out.write_all(b"\n  ]\n}\n")
}

fn json_value(value: Value) -> serde_json::Value {
    match value {
        Value::Number(x) if x.is_finite() => serde_json::json!(x + 0.0),
        Value::Number(_) | Value::Phase(_) => serde_json::Value::Null,
        Value::Count(n) => n.into(),
        Value::Text(word) => word.into(),
        Value::Flags(flags) => {
            let names: Vec<&str> = Flags::NAMES
                .iter()
                .filter(|(flag, _)| flags.contains(*flag))
                .map(|(_, name)| *name)
                .collect();
            names.into()
        }
    }
}

/// Writes all files of a grid under their names, or none.
pub fn write(mut dir: OutputDir, plan: &Plan) -> Result<Written, Problem> {
    let rows = || plan.grid.rows(&plan.bench);
    dir.write("losses.csv", |out| write_csv(out, &plan.columns, rows()))?;
    dir.write("summary.json", |out| write_json(out, plan, rows()))?;
    let drawn = plan.grid.len() <= MOST_DRAWN;
    if drawn {
        for (name, svg) in plots::plots(plan) {
            dir.write(&name, |out| out.write_all(svg.as_bytes()))?;
        }
    }
    let mut written = commit(dir)?;
    if !drawn {
        written.note = format!("  no plots: more than {MOST_DRAWN} points\n");
    }
    Ok(written)
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

/// Gives the files their names.
pub fn commit(dir: OutputDir) -> Result<Written, Problem> {
    let left_over = dir.left_over();
    Ok(Written {
        paths: dir.commit()?,
        left_over,
        note: String::new(),
    })
}
