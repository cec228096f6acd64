//! An independent reader, pyarrow, reads the values of the CSV from the Parquet files.
//!
//! Runs if `target/parquet-venv` exists, as made by `.ci/run`, or if CVTCYCLE_PYTHON names a Python with pyarrow. Otherwise it prints
//! a note and checks nothing, unless CVTCYCLE_REQUIRE_PARQUET_READER is set.
#![allow(clippy::unwrap_used, clippy::print_stderr, reason = "helpers of tests")]

use std::env;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::Arc;

use cvtcycle::output::file::OutputFile;
use cvtcycle::output::trace::columns_for;
use cvtcycle::output::trace::write_trace;
use cvtcycle::study::store::{Format, export};
use cvtcycle::study::store::{Head, Kind, Rows, Values};
use cvtcycle::study::store::{Study, StudyDir, write_csv, write_parquet, write_trace_parquet};
use serde_json::json;
use tempfile::TempDir;

#[allow(dead_code, reason = "shared with other tests")]
use crate::fixtures;
use crate::parts::write_runs;

/// Compares `TABLE.parquet` with `TABLE.csv` cell by cell, and its metadata with `TABLE.json`.
const COMPARE: &str = r#"
import csv, json, struct, sys
import pyarrow as pa
import pyarrow.parquet as pq

base = sys.argv[1]
file = pq.ParquetFile(base + ".parquet")
table = file.read()
with open(base + ".json", encoding="utf-8") as f:
    wanted = json.load(f)
assert table.schema.names == [c["name"] for c in wanted["columns"]], table.schema.names
assert json.loads(file.schema_arrow.metadata[b"cvtcycle.columns"]) == wanted["columns"]
for key, value in wanted["metadata"].items():
    assert file.schema_arrow.metadata[key.encode()].decode() == value, key
assert file.metadata.created_by == wanted["created_by"], file.metadata.created_by
assert file.num_row_groups == wanted["groups"], file.num_row_groups
types = {"number": pa.float64(), "count": pa.int64(), "text": pa.string()}
for column in wanted["columns"]:
    assert table.schema.field(column["name"]).type == types[column["kind"]], column

with open(base + ".csv", newline="", encoding="utf-8-sig") as f:
    lines = list(csv.reader(f, strict=True))
header, lines = lines[0], lines[1:]
unit = lambda c: c["name"] + (" [" + c["unit"] + "]" if c["unit"] and wanted["units"] else "")
assert header == [unit(c) for c in wanted["columns"]], header
assert len(lines) == table.num_rows == wanted["rows"], (len(lines), table.num_rows)
bits = lambda x: struct.pack("<d", x)
cells = nulls = 0
for k, column in enumerate(wanted["columns"]):
    values = table.column(k).to_pylist()
    for line, value in zip(lines, values):
        text = line[k]
        cells += 1
        if column["kind"] == "count":
            same = str(value) == text
        elif value is None or text == "":
            nulls += 1
            same = value is None and text == ""
        elif column["kind"] == "number":
            same = bits(value) == bits(float(text))
        else:
            same = value == text
        assert same, (column["name"], value, text)
print(json.dumps({"cells": cells, "nulls": nulls}))
"#;

/// Python with pyarrow, if there is one. Panics if it is required.
fn python() -> Option<PathBuf> {
    let installed = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/parquet-venv/bin/python");
    let named = env::var_os("CVTCYCLE_PYTHON").map(PathBuf::from);
    let found = named.or_else(|| installed.is_file().then_some(installed));
    let required = env::var_os("CVTCYCLE_REQUIRE_PARQUET_READER").is_some_and(|word| word != "0");
    assert!(
        found.is_some() || !required,
        "no Python with pyarrow: .ci/run installs one"
    );
    if found.is_none() {
        eprintln!(
            "skipped: no Python with pyarrow (set CVTCYCLE_PYTHON, or let .ci/run install one)"
        );
    }
    found
}

/// Compares the files of a name with the reader; returns its counts, or its message.
fn compare(python: &Path, base: &Path) -> Result<serde_json::Value, String> {
    let output: Output = Command::new(python)
        .args(["-c", COMPARE])
        .arg(base)
        .output()
        .unwrap();
    if output.status.success() {
        Ok(serde_json::from_slice(&output.stdout).unwrap())
    } else {
        Err(String::from_utf8_lossy(&output.stderr).into_owned())
    }
}

/// Expectations in addition to the cells.
struct Wanted<'a> {
    columns: &'a [Head],
    rows: u64,
    groups: u64,
    units: bool,
    metadata: serde_json::Value,
}

impl Wanted<'_> {
    fn write(&self, base: &Path) {
        let kind = |kind| match kind {
            Kind::Number => "number",
            Kind::Count => "count",
            Kind::Text => "text",
        };
        let head = |c: &Head| json!({ "name": c.name, "unit": c.unit, "doc": c.doc, "kind": kind(c.kind) });
        let wanted = json!({
            "columns": self.columns.iter().map(head).collect::<Vec<_>>(),
            "rows": self.rows,
            "groups": self.groups,
            "units": self.units,
            "metadata": self.metadata,
            "created_by": concat!("cvtcycle ", env!("CARGO_PKG_VERSION")),
        });
        fs::write(base.with_extension("json"), wanted.to_string()).unwrap();
    }
}

fn columns() -> Vec<Head> {
    let head = |name: &str, unit: &str, kind| Head {
        name: name.into(),
        unit: unit.into(),
        doc: format!("Größe „{name}“, \"quoted\""),
        kind,
    };
    vec![
        head("run", "", Kind::Count),
        head("transmission.cvt.belt.band_offset_mm", "mm", Kind::Number),
        head("few", "°C", Kind::Number),
        head("word, with comma", "", Kind::Text),
        head("text", "", Kind::Text),
    ]
}

/// Rows with all special values.
fn rows() -> Rows {
    let odd = [
        0.0,
        -0.0,
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        5e-324,
        -f64::MIN_POSITIVE,
        f64::MAX,
        0.1 + 0.2,
        1e-5,
        9e15,
        1e16,
        1e300,
    ];
    let counts = [0, -1, 9_007_199_254_740_993, i64::MAX, i64::MIN];
    let texts = [
        "",
        "Öl, \"heiß\"",
        "a\nb\r\nc",
        " ",
        "=1+1",
        "\u{1F697} 車",
        "NULL",
        "nan",
        "x,y;z",
    ];
    let n = 5000_usize;
    let unlike = |k: usize| {
        if k < odd.len() {
            odd[k]
        } else {
            (k as f64).sqrt() * 1e-7
        }
    };
    let word = |text: &str| -> Arc<str> { Arc::from(text) };
    Rows {
        values: vec![
            Values::Count(
                (0..n)
                    .map(|k| counts.get(k).copied().unwrap_or(i64::try_from(k).unwrap()))
                    .collect(),
            ),
            Values::Number((0..n).map(unlike).collect()),
            Values::Number((0..n).map(|k| odd[k % odd.len()]).collect()),
            Values::Text((0..n).map(|k| word(&format!("run {k}"))).collect()),
            Values::Text((0..n).map(|k| word(texts[k % texts.len()])).collect()),
        ],
    }
}

#[test]
fn val_pyarrow_finds_the_cells_of_the_csv() {
    let Some(python) = python() else { return };
    let dir = TempDir::new().unwrap();
    let (columns, rows, base) = (columns(), rows(), dir.path().join("table"));
    write_parquet(
        File::create(base.with_extension("parquet")).unwrap(),
        &columns,
        &rows,
        &[("cvtcycle.seed", "7")],
    )
    .unwrap();
    write_csv(
        File::create(base.with_extension("csv")).unwrap(),
        &columns,
        &rows,
    )
    .unwrap();
    Wanted {
        columns: &columns,
        rows: 5000,
        groups: 1,
        units: false,
        metadata: json!({ "cvtcycle.seed": "7" }),
    }
    .write(&base);
    let counted = compare(&python, &base).unwrap();
    // NaN, infinities, and the empty text.
    let nulls = 3
        + (0..5000).filter(|k| matches!(k % 13, 2..=4)).count()
        + (0..5000).filter(|k| k % 9 == 0).count();
    assert_eq!(counted, json!({ "cells": 25_000, "nulls": nulls }));
    // Checks that the comparison can fail: one digit, one letter, one null.
    let text = fs::read_to_string(base.with_extension("csv")).unwrap();
    for (from, to) in [
        ("0.30000000000000004", "0.3"),
        ("heiß", "heiss"),
        ("run 77", ""),
        ("9007199254740993", "9007199254740992"),
    ] {
        assert!(text.contains(from), "{from}");
        fs::write(base.with_extension("csv"), text.replacen(from, to, 1)).unwrap();
        assert!(
            compare(&python, &base)
                .unwrap_err()
                .contains("AssertionError"),
            "{from}"
        );
    }
}

#[test]
fn val_pyarrow_finds_the_cells_of_a_trace_and_of_an_export() {
    let Some(python) = python() else { return };
    let dir = TempDir::new().unwrap();
    for (name, cvt, components) in [
        ("cvt", true, &fixtures::CVT[..]),
        ("manual", false, &fixtures::MANUAL[..]),
    ] {
        let base = dir.path().join(name);
        let (rows, columns) = (fixtures::rows(1180, 1.0, cvt), columns_for(cvt, components));
        let phases = fixtures::phases();
        write_trace_parquet(
            File::create(base.with_extension("parquet")).unwrap(),
            &columns,
            &rows,
            &phases,
            "0123456789abcdef",
        )
        .unwrap();
        write_trace(
            File::create(base.with_extension("csv")).unwrap(),
            &columns,
            &rows,
            &phases,
        )
        .unwrap();
        let heads: Vec<Head> = columns.iter().map(|column| column.head()).collect();
        Wanted {
            columns: &heads,
            rows: 1180,
            groups: 1,
            units: false,
            metadata: json!({ "cvtcycle.run": "0123456789abcdef" }),
        }
        .write(&base);
        let counted = compare(&python, &base).unwrap();
        assert_eq!(counted["cells"], 1180 * heads.len());
    }
    let (columns, rows) = (columns(), rows());
    let study = dir.path().join("study");
    let manifest =
        json!({ "layout": { "parts": 3, "tables": ["runs"], "csv": false }, "title": "Öl" })
            .to_string();
    let parts = StudyDir::create(&study, manifest.as_bytes(), b"", false).unwrap();
    (0..3).for_each(|k| write_runs(&parts, k, &columns, &rows));
    let base = dir.path().join("export");
    for (ending, format) in [("csv", Format::Csv), ("parquet", Format::Parquet)] {
        let mut out = OutputFile::create(base.with_extension(ending), false).unwrap();
        export(&Study::open(&study).unwrap(), "runs", format, &mut out).unwrap();
        out.commit().unwrap();
    }
    Wanted {
        columns: &columns,
        rows: 15_000,
        groups: 3,
        units: true,
        metadata: json!({ "cvtcycle.manifest": manifest }),
    }
    .write(&base);
    assert_eq!(compare(&python, &base).unwrap()["cells"], 75_000);
}
