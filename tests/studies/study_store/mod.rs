//! Tables of a study on disk: round trips, detection of damage, resuming.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod create;
mod damage;
mod export;
mod build_identity;
mod resume;
mod run;
mod tables;

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, ErrorKind, Write};
use std::path::Path;
use std::sync::Arc;

use cvtcycle::output::BUILD;
use cvtcycle::study::store::{Head, Kind, Rows, Values};
use cvtcycle::study::store::{PartTable, StudyDir};
use serde_json::json;

const PLAN: &[u8] = b"title = \"test\"\n";

fn head(name: &str, unit: &str, kind: Kind) -> Head {
    Head {
        name: name.to_owned(),
        unit: unit.to_owned(),
        doc: format!("what {name} is"),
        kind,
    }
}

/// Heads of a small table, including a name with dots and one with non-ASCII letters.
fn heads() -> Vec<Head> {
    vec![
        head("run", "", Kind::Count),
        head("vehicle", "", Kind::Text),
        head("fuel_l_per_100km", "L/100 km", Kind::Number),
        head("transmission.cvt.belt.band_offset_mm", "mm", Kind::Number),
        head("reason", "", Kind::Text),
    ]
}

/// Rows of a part.
fn rows(part: usize) -> Rows {
    let n = 3 + part;
    let run = |k: usize| i64::try_from(10 * part + k).unwrap();
    let text = |word: &str| -> Arc<str> { Arc::from(word) };
    Rows {
        values: vec![
            Values::Count((0..n).map(run).collect()),
            Values::Text((0..n).map(|k| text(["cvt", "5mt"][k % 2])).collect()),
            Values::Number(
                (0..n)
                    .map(|k| 7.0 + 0.1 * k as f64 + part as f64 / 3.0)
                    .collect(),
            ),
            Values::Number(
                (0..n)
                    .map(|k| if k % 3 == 1 { f64::NAN } else { 2.4 })
                    .collect(),
            ),
            Values::Text(
                (0..n)
                    .map(|k| {
                        text(if k == 2 {
                            "gross slip, \"at once\"\n=1+1"
                        } else {
                            ""
                        })
                    })
                    .collect(),
            ),
        ],
    }
}

fn manifest_of(parts: usize, tables: &[&str], csv: bool) -> Vec<u8> {
    let layout = json!({ "parts": parts, "tables": tables, "csv": csv });
    json!({ "program": "cvtcycle 0.1.0", "build": BUILD, "run": RUN, "seed": 7, "layout": layout, "plan": "title = 1\n" })
        .to_string()
        .into_bytes()
}

/// Identifying word of that study.
const RUN: &str = "0123456789abcdef";

/// Manifest of a study with two tables per part, as Parquet and CSV.
fn manifest(parts: usize) -> Vec<u8> {
    manifest_of(parts, &["trace", "runs"], true)
}

fn write_part(dir: &StudyDir, part: usize) {
    let (columns, rows) = (heads(), rows(part));
    let table = |name| PartTable {
        name,
        columns: &columns,
        rows: &rows,
        metadata: &[("cvtcycle.part", "x")],
    };
    dir.write_part(part, &[table("trace"), table("runs")])
        .unwrap();
}

fn results() -> Vec<(String, Vec<u8>)> {
    [
        ("summary.json", "{}\n"),
        ("statistics.json", "{\"a\": 1}\n"),
        ("tornado.svg", "<svg/>\n"),
    ]
    .map(|(name, text)| (name.to_owned(), text.as_bytes().to_vec()))
    .to_vec()
}

/// Writes a complete study into a directory.
fn whole(path: &Path, parts: usize) {
    let dir = StudyDir::create(path, &manifest(parts), PLAN, false).unwrap();
    (0..parts).for_each(|part| write_part(&dir, part));
    dir.finish(&results()).unwrap();
}

/// All files of a directory and its folders by name.
fn files(path: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(path).unwrap() {
        let entry = entry.unwrap();
        let name = entry.file_name().into_string().unwrap();
        if entry.path().is_dir() {
            found.extend(
                files(&entry.path())
                    .into_iter()
                    .map(|(inner, bytes)| (format!("{name}/{inner}"), bytes)),
            );
        } else {
            found.insert(name, fs::read(entry.path()).unwrap());
        }
    }
    found
}

/// Disk with room for a number of bytes.
struct SmallDisk {
    room: usize,
}

impl Write for SmallDisk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.room == 0 && !bytes.is_empty() {
            return Err(ErrorKind::StorageFull.into());
        }
        let written = bytes.len().min(self.room);
        self.room -= written;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
