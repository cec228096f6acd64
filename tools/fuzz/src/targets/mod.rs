//! One function per target: takes any bytes, and panics on forbidden behaviour of the program.
//!
//! | target | meaning of the bytes |
//! |---|---|
//! | `vehicle`, `lubricant`, `study_plan`, `calibration_plan` | a TOML file: the bytes themselves, or edits of a shipped file ([`edits`]) |
//! | `rows`, `cover`, `levers` | a file of rows, of the cover of a report, or of levers (TOML), likewise |
//! | `answers` | a file of answers (TOML), likewise, and the resulting car |
//! | `expression` | an expression of rows, over two small tables |
//! | `overrides` | assignments of `--set`, one a line |
//! | `logger` | the columns of `--columns` in the first line, and their CSV file |
//! | `cycle`, `map`, `points`, `measured`, `history` | a CSV file, after a byte that selects one of several forms |
//! | `summary`, `inputs`, `study_manifest`, `checksums` | a file of results (JSON; a list of checksums), the manifest after a byte that selects its plan |
//! | `parquet` | a Parquet table without its pages: edits of a small one, or the bytes themselves |
//! | `journal` | the journal of a pending commit, in a folder with some files |
//! | `belt` | a belt and its operating point: any finite numbers, or a table row with numbers in their ranges |
//! | `drive` | a valid car and a short cycle: numbers of a shipped car changed within the ranges of their keys |
//!
//! All targets: no panic, and at most [`max_bytes`] of memory for the size of the input.

mod belt;
mod csv;
mod drive;
mod edits;
mod expression;
mod files;
#[path = "../../../../tests/common/range.rs"]
mod range;
mod results;
#[path = "../../../../tests/common/small_tables.rs"]
mod small_tables;
mod toml;

/// Target function.
pub type Target = fn(&[u8]);

/// Targets by name.
pub const TARGETS: [(&str, Target); 24] = [
    ("vehicle", toml::vehicle),
    ("lubricant", toml::lubricant),
    ("study_plan", toml::study_plan),
    ("calibration_plan", toml::calibration_plan),
    ("rows", toml::rows),
    ("cover", toml::cover),
    ("levers", toml::levers),
    ("answers", toml::answers),
    ("expression", expression::expression),
    ("overrides", toml::overrides),
    ("cycle", csv::cycle),
    ("logger", csv::logger),
    ("map", csv::map),
    ("points", csv::points),
    ("measured", csv::measured),
    ("history", csv::history),
    ("summary", results::summary),
    ("inputs", results::inputs),
    ("study_manifest", results::study_manifest),
    ("checksums", results::checksums),
    ("parquet", files::parquet),
    ("journal", files::journal),
    ("belt", belt::belt),
    ("drive", drive::drive_car),
];

/// Memory limit for reading an input, bytes: a constant for the program's own files, which may be read
/// too, and a multiple of the input for its values with their places.
#[must_use]
pub fn max_bytes(input_len: usize) -> u64 {
    (16 << 20) + 1200 * input_len as u64
}

/// Runs a target.
/// # Panics
/// On forbidden behaviour of the program; for an unknown target.
pub fn run(name: &str, data: &[u8]) {
    let Some((_, target)) = TARGETS.iter().find(|(known, _)| *known == name) else {
        panic!("no target {name}");
    };
    target(data);
}

/// Reads an input of a length and checks the memory used.
fn within_memory<T>(input_len: usize, mut read: impl FnMut() -> T) -> T {
    let mut answer = None;
    let counted = allocation_counter::measure(|| answer = Some(read()));
    assert!(
        counted.bytes_max <= max_bytes(input_len),
        "{} bytes held for an input of {input_len}",
        counted.bytes_max
    );
    answer.unwrap_or_else(|| unreachable!("the closure has run"))
}

/// Bytes consumed from the front; zeros after the end.
struct Bytes<'d>(&'d [u8]);

impl<'d> Bytes<'d> {
    fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    fn take<const N: usize>(&mut self) -> [u8; N] {
        let mut taken = [0; N];
        let count = N.min(self.0.len());
        taken[..count].copy_from_slice(&self.0[..count]);
        self.0 = &self.0[count..];
        taken
    }

    fn byte(&mut self) -> u8 {
        self.take::<1>()[0]
    }

    /// True if the next byte is a multiple of `n`.
    fn one_in(&mut self, n: u8) -> bool {
        self.byte().is_multiple_of(n)
    }

    fn short(&mut self) -> u16 {
        u16::from_le_bytes(self.take())
    }

    /// Number from 0 to 1.
    fn share(&mut self) -> f64 {
        f64::from(self.short()) / f64::from(u16::MAX)
    }

    /// Any finite or non-finite number.
    fn number(&mut self) -> f64 {
        f64::from_le_bytes(self.take())
    }

    /// Element of a list.
    fn pick<T: Copy>(&mut self, list: &[T]) -> T {
        list[usize::from(self.short()) % list.len()]
    }

    fn rest(self) -> &'d [u8] {
        self.0
    }
}
