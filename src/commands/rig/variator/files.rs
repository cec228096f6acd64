//! Curves and points as CSV and JSON, and the files of a run.

use std::io::{self, Write};

use cvtcycle::config::Problem;
use cvtcycle::model::bench::variator::VariatorRow;
use cvtcycle::output::columns::Value;
use cvtcycle::output::files::OutputDir;
use cvtcycle::output::trace::push_value;
use cvtcycle::output::variator::{COLUMNS, VariatorValue, curve_numbers};

use super::plan::{Curve, Plan};
use super::plots;
use crate::commands::run::files::Written;

/// Version of the JSON object.
const SCHEMA: u32 = 1;

fn push(line: &mut String, x: f64) {
    push_value(line, Value::Number(x), &[]);
}

/// Writes every point of every curve as CSV.
pub fn write_points(out: &mut dyn Write, curves: &[Curve]) -> io::Result<()> {
    let names: Vec<&str> = COLUMNS.iter().map(|column| column.name).collect();
    writeln!(out, "{}", names.join(","))?;
    let mut line = String::new();
    for row in curves.iter().flat_map(|curve| &curve.rows) {
        line.clear();
        for (k, column) in COLUMNS.iter().enumerate() {
            if k > 0 {
                line.push(',');
            }
            match (column.get)(row) {
                VariatorValue::Number(x) => push(&mut line, x),
                VariatorValue::Text(text) => line.push_str(&text),
            }
        }
        line.push('\n');
        out.write_all(line.as_bytes())?;
    }
    Ok(())
}

/// Numbers of a curve under their names.
fn numbers(curve: &Curve) -> Vec<(&'static str, f64)> {
    curve_numbers(&curve.summary, &curve.resolution)
}

/// Writes a line a curve as CSV.
pub fn write_curves(out: &mut dyn Write, curves: &[Curve]) -> io::Result<()> {
    for (k, curve) in curves.iter().enumerate() {
        let numbers = numbers(curve);
        if k == 0 {
            let names: Vec<&str> = numbers.iter().map(|(name, _)| *name).collect();
            writeln!(out, "{}", names.join(","))?;
        }
        let mut line = String::new();
        for (k, (_, x)) in numbers.iter().enumerate() {
            if k > 0 {
                line.push(',');
            }
            push(&mut line, *x);
        }
        writeln!(out, "{line}")?;
    }
    Ok(())
}

fn number(x: f64) -> serde_json::Value {
    if x.is_finite() {
        serde_json::json!(x + 0.0)
    } else {
        serde_json::Value::Null
    }
}

/// Writes one JSON object, its points one a line.
pub fn write_json(out: &mut dyn Write, plan: &Plan, curves: &[Curve]) -> io::Result<()> {
    let columns: Vec<serde_json::Value> =
        COLUMNS.iter().map(|column| serde_json::json!({ "name": column.name, "unit": column.unit, "meaning": column.doc })).collect();
    let lines: Vec<serde_json::Map<String, serde_json::Value>> = curves
        .iter()
        .map(|curve| {
            numbers(curve)
                .into_iter()
                .map(|(name, x)| (name.to_owned(), number(x)))
                .collect()
        })
        .collect();
    let head = serde_json::json!({
        "schema": SCHEMA,
        "program": concat!("cvtcycle ", env!("CARGO_PKG_VERSION")),
        "settings": {
            "vehicle": plan.setup.name,
            "lubricant": plan.setup.oils().0.name,
            "formulation": plan.formulation,
            "set": plan.set,
            "pulses": plan.pulses,
        },
        "curves": lines,
        "columns": columns,
        "count": curves.iter().map(|curve| curve.rows.len()).sum::<usize>(),
    });
    let head = serde_json::to_string_pretty(&head)?;
    // The closing brace of the head comes after the points.
    write!(
        out,
        "{},\n  \"points\": [",
        head.trim_end().trim_end_matches('}').trim_end()
    )?;
    for (k, row) in curves.iter().flat_map(|curve| &curve.rows).enumerate() {
        write!(out, "{}\n    {}", if k > 0 { "," } else { "" }, point(row))?;
    }
    out.write_all(b"\n  ]\n}\n")
}

fn point(row: &VariatorRow) -> serde_json::Value {
    let cells = COLUMNS.iter().map(|column| {
        let value = match (column.get)(row) {
            VariatorValue::Number(x) => number(x),
            VariatorValue::Text(text) => text
                .split('|')
                .filter(|name| !name.is_empty())
                .collect::<Vec<_>>()
                .into(),
        };
        (column.name.to_owned(), value)
    });
    serde_json::Value::Object(cells.collect())
}

/// Writes all files of a run under their names, or none.
pub fn write(mut dir: OutputDir, plan: &Plan, curves: &[Curve]) -> Result<Written, Problem> {
    dir.write("curves.csv", |out| write_curves(out, curves))?;
    dir.write("points.csv", |out| write_points(out, curves))?;
    dir.write("summary.json", |out| write_json(out, plan, curves))?;
    for (name, svg) in plots::plots(plan, curves) {
        dir.write(name, |out| out.write_all(svg.as_bytes()))?;
    }
    Written::commit(dir)
}
