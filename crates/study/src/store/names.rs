//! Names of the files of a study.

use std::path::{Path, PathBuf};

use cvtcycle_config::bounded::STEPS;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Name of the table of runs.
pub const RUNS: &str = "runs";
/// Name of the table of traces.
pub const TRACES: &str = "trace";
/// Rows of traces up to which a part takes further points.
pub const TRACE_ROWS: u64 = 50_000;
/// Most rows of a table of a part: those of traces before its last point, and of that point as many as may be kept.
pub const MAX_PART_ROWS: u64 = TRACE_ROWS + STEPS as u64;

/// Manifest; marks the directory.
pub const MANIFEST: &str = "study.json";
/// The plan's text.
pub const PLAN: &str = "plan.toml";
/// Folder of the parts.
pub const PARTS: &str = "parts";
/// Checksums of the results; marks a finished study.
pub const RESULTS: &str = "results.sha256";
/// Written last of the results.
pub const SUMMARY: &str = "summary.json";
/// Word before the number of a part's mark.
const MARK: &str = "part";
/// Ending of a part's mark.
const MARK_ENDING: &str = "sha256";
/// Endings of the files of a part.
const ENDINGS: [&str; 3] = ["parquet", "csv", MARK_ENDING];

/// True if a directory holds a study, complete or not.
pub fn is_study(path: impl AsRef<Path>) -> bool {
    path.as_ref().join(MANIFEST).is_file()
}

/// Folder of the parts.
pub fn parts_folder(study: &Path) -> PathBuf {
    study.join(PARTS)
}

/// `runs_00007.parquet`.
pub fn part_file(table: &str, index: usize, ending: &str) -> String {
    format!("{table}_{index:05}.{ending}")
}

/// `part_00007.sha256`.
pub fn part_mark(index: usize) -> String {
    part_file(MARK, index, MARK_ENDING)
}

/// The part of which a file is the mark.
pub fn marked_part(name: &str) -> Option<usize> {
    let (stem, _) = name.rsplit_once('.')?;
    let index = stem.rsplit_once('_')?.1.parse().ok()?;
    // No second spelling of a number.
    (part_mark(index) == name).then_some(index)
}

/// True for the file name of any part.
pub fn is_part_file(name: &str) -> bool {
    let (stem, ending) = name.rsplit_once('.').unwrap_or_default();
    let (table, digits) = stem.rsplit_once('_').unwrap_or_default();
    let is_number = digits.len() >= 5 && digits.bytes().all(|b| b.is_ascii_digit());
    ENDINGS.contains(&ending) && is_word(table) && is_number
}

/// Checks the name of a table: small letters, digits and `_`, and not that of the marks.
pub fn is_table(name: &str) -> bool {
    is_word(name) && name != MARK
}

fn is_word(name: &str) -> bool {
    let is_letter = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_';
    (1..=40).contains(&name.len()) && name.bytes().all(is_letter)
}

/// Checks the name of a result: plain, and none of the study's own files.
pub fn is_result(name: &str) -> bool {
    let plain = Path::new(name).file_name().is_some_and(|last| last == name);
    let own = [MANIFEST, PLAN, PARTS, RESULTS];
    let own = own.iter().any(|own| own.eq_ignore_ascii_case(name));
    let is_odd = |c: char| "/\\:".contains(c) || c.is_control();
    plain && !own && !name.starts_with('.') && !name.contains(is_odd)
}

/// Most parts of a study.
const MAX_PARTS: usize = 1_000_000;

/// The parts and tables of a study: the object `layout` of its manifest.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Layout {
    /// Number of parts, 0 to 1 000 000.
    pub parts: usize,
    /// Names of the tables of which each part has a piece: small letters, digits and `_`.
    pub tables: Vec<String>,
    /// True if each table of a part is written as CSV too.
    pub csv: bool,
}

impl Layout {
    /// The layout that a manifest states; none if it states none, or one that cannot be.
    pub fn from_manifest(manifest: &Value) -> Option<Self> {
        let layout: Layout = serde_json::from_value(manifest.get("layout")?.clone()).ok()?;
        let tables = &layout.tables;
        let unlike = tables
            .iter()
            .enumerate()
            .all(|(k, name)| is_table(name) && !tables[..k].contains(name));
        (layout.parts <= MAX_PARTS && !tables.is_empty() && unlike).then_some(layout)
    }

    /// Endings of the files of each table.
    pub(super) fn endings(&self) -> &'static [&'static str] {
        if self.csv {
            &["parquet", "csv"]
        } else {
            &["parquet"]
        }
    }

    /// Names of the files of a part, without its mark.
    pub(super) fn files(&self, index: usize) -> Vec<String> {
        let endings = self.endings();
        self.tables
            .iter()
            .flat_map(|table| {
                endings
                    .iter()
                    .map(move |ending| part_file(table, index, ending))
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_parts_read_back() {
        for index in [0, 7, 99_999, 100_000, 1_234_567] {
            assert_eq!(marked_part(&part_mark(index)), Some(index));
            assert!(
                is_part_file(&part_mark(index)) && is_part_file(&part_file("runs", index, "csv"))
            );
        }
        for wrong in [
            "part_7.sha256",
            "part_000007.sha256",
            "part_+0007.sha256",
            "part_.sha256",
            "runs_00007.sha256",
            "part_00007.sha256x",
        ] {
            assert_eq!(marked_part(wrong), None, "{wrong}");
        }
        for other in [
            "notes.csv",
            "my_2024.csv",
            "Runs_00000.csv",
            "runs_00000.txt",
            "00000.csv",
        ] {
            assert!(!is_part_file(other), "{other}");
        }
    }

    #[test]
    fn names_stay_inside_the_directory() {
        for bad in [
            "",
            ".",
            "..",
            "../a.svg",
            "a/b.svg",
            "a\\b",
            "C:x",
            "/etc/x",
            "study.json",
            "Study.json",
            "parts",
            ".lock",
            "a\nb",
        ] {
            assert!(!is_result(bad), "{bad}");
        }
        assert!(is_result("statistics.json") && is_result("überblick 1.svg"));
        for bad in ["", "..", "a/b", "part", "Runs", "a.b"] {
            assert!(!is_table(bad), "{bad}");
        }
    }
}
