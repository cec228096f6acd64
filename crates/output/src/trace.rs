//! Rows to CSV.
use std::fmt::Write as _;
use std::io::{self, Write};

use super::columns::{Column, Value};
use super::{Flags, Row};

/// Writes a header and one line per row.
///
/// Numbers read back to the same `f64`; what is not finite becomes an empty field. A phase index
/// without a name becomes an empty field too.
///
/// # Errors
/// Whatever `out` reports.
pub fn write_trace<W: Write>(
    out: W,
    columns: &[&Column],
    rows: &[Row],
    phases: &[String],
) -> io::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    writer
        .write_record(columns.iter().map(|column| column.name))
        .map_err(csv_error)?;
    let mut text = String::new();
    for row in rows {
        for column in columns {
            text.clear();
            push_value(&mut text, (column.get)(row), phases);
            writer.write_field(&text).map_err(csv_error)?;
        }
        writer.write_record(None::<&[u8]>).map_err(csv_error)?;
    }
    writer.flush()
}

/// The error of the operating system within one of CSV: it says whether the disk is full.
pub fn csv_error(error: csv::Error) -> io::Error {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => error,
        other => io::Error::other(format!("{other:?}")),
    }
}

/// Appends a cell as it stands in the CSV file.
pub fn push_value(text: &mut String, value: Value, phases: &[String]) {
    match value {
        Value::Number(x) => push_number(text, x),
        Value::Count(n) => push_number(text, f64::from(n)),
        Value::Text(word) => text.push_str(word),
        Value::Phase(index) => {
            text.push_str(phases.get(usize::from(index)).map_or("", String::as_str));
        }
        Value::Flags(flags) => push_flags(text, flags),
    }
}

/// The shortest decimal that reads back to the same number, with an exponent where plain decimals
/// would be a row of zeros; nothing for NaN and infinities.
fn push_number(text: &mut String, x: f64) {
    let size = x.abs();
    if !size.is_finite() {
        return;
    }
    // A minus sign on zero only puzzles the reader.
    // Writing into a String cannot fail.
    let done = if size <= 0.0 {
        write!(text, "0")
    } else if (1e-5..1e16).contains(&size) {
        write!(text, "{x}")
    } else {
        write!(text, "{x:e}")
    };
    debug_assert!(done.is_ok());
}

fn push_flags(text: &mut String, flags: Flags) {
    let start = text.len();
    for (flag, name) in Flags::NAMES {
        if flags.contains(flag) {
            if text.len() > start {
                text.push('|');
            }
            text.push_str(name);
        }
    }
}
