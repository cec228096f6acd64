//! A table of text: names of columns, rows of cells, rows that are refused.

use std::collections::HashMap;

use cvtcycle_config::log::table_text;
use cvtcycle_config::{Problem, Problems};

/// Most rows of a table.
pub const MAX_ROWS: usize = 100_000;

/// Help where there are no rows.
const HINT: &str = "a row is a car, below a line of column names";

/// A table whose cells are text.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// Name or path of the file.
    pub file: String,
    /// Names of the columns.
    pub names: Vec<String>,
    /// Rows with as many cells as there are names.
    pub rows: Vec<Row>,
    /// Rows with more or fewer cells.
    pub refused: Vec<Refused>,
}

/// A row of cells.
#[derive(Clone, Debug)]
pub struct Row {
    /// Line of the file, from 1.
    pub line: u64,
    /// Cells, without surrounding blanks.
    pub cells: Vec<String>,
}

/// A row that is not driven.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refused {
    /// Line of the file, from 1.
    pub line: u64,
    /// Name of its car; empty where it has none.
    pub id: String,
    /// Reason, with the column, the value and what is allowed.
    pub reason: String,
}

impl Sheet {
    /// Reads a table: the first line has the names; cells are parted by the comma, semicolon or tab that parts the names.
    ///
    /// # Errors
    /// A file that is no text, no rows, columns without a name or with the name of another one.
    pub fn read(file: &str, bytes: &[u8]) -> Result<Sheet, Problems> {
        if bytes.iter().all(u8::is_ascii_whitespace) {
            return Err(Problem::missing("the file is empty")
                .in_file(file)
                .hint(HINT)
                .into());
        }
        let text = table_text(file, bytes, "cvtcycle.fleet(frame)")?;
        let head = text
            .lines()
            .find(|line| !line.trim().is_empty())
            .unwrap_or_default();
        let count = |sign: &u8| head.bytes().filter(|b| b == sign).count();
        let delimiter = [b',', b';', b'\t']
            .into_iter()
            .max_by_key(|sign| count(sign))
            .unwrap_or(b',');
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(delimiter)
            .flexible(true)
            .trim(csv::Trim::All)
            .from_reader(text.as_bytes());
        let unreadable = |error: csv::Error| {
            Problem::unreadable(format!("the table cannot be read: {error}")).in_file(file)
        };
        let names: Vec<String> = reader
            .headers()
            .map_err(unreadable)?
            .iter()
            .map(str::to_owned)
            .collect();
        check_names(file, &names)?;
        let mut sheet = Sheet {
            file: file.to_owned(),
            names,
            rows: Vec::new(),
            refused: Vec::new(),
        };
        let (mut line, mut counted) = (1, 0);
        for record in reader.records() {
            let record = record.map_err(unreadable)?;
            // The position of a record is before the line feed of the line above it, where lines end with CR LF.
            let at = record.position().map_or(0, csv::Position::byte) as usize;
            let behind = text.as_bytes().get(at..).unwrap_or_default();
            let ends = behind.iter().take_while(|b| matches!(b, b'\r' | b'\n'));
            let begin = at + ends.count();
            let passed = text.as_bytes().get(counted..begin).unwrap_or_default();
            line += passed.iter().filter(|b| **b == b'\n').count() as u64;
            counted = begin;
            let cells: Vec<String> = record.iter().map(str::to_owned).collect();
            if cells.iter().all(String::is_empty) {
                continue;
            }
            if sheet.rows.len() + sheet.refused.len() == MAX_ROWS {
                let problem = Problem::too_large("the table has too many rows").in_file(file);
                return Err(problem
                    .allowed(format!("up to {MAX_ROWS}"))
                    .hint("split the table")
                    .into());
            }
            if cells.len() != sheet.names.len() {
                let reason = format!(
                    "{} cells in a table of {} columns",
                    cells.len(),
                    sheet.names.len()
                );
                sheet.refused.push(Refused {
                    line,
                    id: String::new(),
                    reason,
                });
                continue;
            }
            sheet.rows.push(Row { line, cells });
        }
        if sheet.rows.is_empty() && sheet.refused.is_empty() {
            return Err(Problem::missing("the table has no rows")
                .in_file(file)
                .hint(HINT)
                .into());
        }
        Ok(sheet)
    }

    /// Adds the columns of another table to the rows with the same word in the column `by`; rows that it does not have keep empty cells.
    ///
    /// # Errors
    /// A table without that column; columns that both have are left as they are.
    pub fn join(&mut self, other: &Sheet, by: &str) -> Result<(), Problems> {
        let (Some(own), Some(at)) = (self.column(by), other.column(by)) else {
            let file = if self.column(by).is_none() {
                &self.file
            } else {
                &other.file
            };
            return Err(
                Problem::missing(format!("no column `{by}` by which rows are joined"))
                    .in_file(file)
                    .hint("name the column of the cars' names")
                    .into(),
            );
        };
        let new: Vec<usize> = (0..other.names.len())
            .filter(|k| self.column(&other.names[*k]).is_none())
            .collect();
        self.names
            .extend(new.iter().map(|k| other.names[*k].clone()));
        // The first row of a name counts.
        let rows = other.rows.iter().rev();
        let by_name: HashMap<&str, &Row> = rows.map(|row| (row.cells[at].as_str(), row)).collect();
        for row in &mut self.rows {
            let found = by_name.get(row.cells[own].as_str());
            row.cells.extend(
                new.iter()
                    .map(|k| found.map_or_else(String::new, |found| found.cells[*k].clone())),
            );
        }
        Ok(())
    }

    /// Index of a column.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|own| own == name)
    }
}

fn check_names(file: &str, names: &[String]) -> Result<(), Problems> {
    let mut problems = Problems::new();
    for (k, name) in names.iter().enumerate() {
        if name.is_empty() {
            let problem = Problem::missing(format!("column {} has no name", k + 1)).in_file(file);
            problems.push(problem.hint("give each column a name in the first line"));
        } else if names[..k].contains(name) {
            let problem =
                Problem::conflict(format!("two columns are named `{name}`")).in_file(file);
            problems.push(
                problem
                    .key(name.as_str())
                    .hint("rename or remove one of them"),
            );
        }
    }
    problems.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: an editor's line numbers of the same text, whatever ends its lines; an empty line and a quoted line end count.
    #[test]
    fn val_lines_are_those_of_an_editor() {
        let text = "carid,mass\na,1\n\n\"b\nb\",2\nc,3\nd\n";
        for text in [text.to_owned(), text.replace('\n', "\r\n")] {
            let sheet = Sheet::read("t.csv", text.as_bytes()).expect("a table");
            let lines: Vec<u64> = sheet.rows.iter().map(|row| row.line).collect();
            assert_eq!(lines, [2, 4, 6], "{text:?}");
            assert_eq!(sheet.refused[0].line, 7, "{text:?}");
        }
    }

    /// Truth: the code charts of Unicode and of Windows-1252, in which é is E9.
    #[test]
    fn val_encodings_are_those_of_spreadsheets() {
        let text = "carid;make\na;Citro\u{eb}n\nb;\u{e9}t\u{e9}\n";
        let utf16 = |bytes: fn(u16) -> [u8; 2], mark: bool| -> Vec<u8> {
            let mark = mark.then_some('\u{feff}');
            let all: String = mark.into_iter().chain(text.chars()).collect();
            all.encode_utf16().flat_map(bytes).collect()
        };
        let latin: Vec<u8> = text.chars().map(|c| c as u8).collect();
        for bytes in [
            text.as_bytes().to_vec(),
            [b"\xef\xbb\xbf", text.as_bytes()].concat(),
            utf16(u16::to_le_bytes, true),
            utf16(u16::to_be_bytes, true),
            utf16(u16::to_le_bytes, false),
            latin,
        ] {
            let sheet = Sheet::read("t.csv", &bytes).expect("a table");
            assert_eq!(sheet.names, ["carid", "make"], "{bytes:?}");
            let cells: Vec<&str> = sheet.rows.iter().map(|row| row.cells[1].as_str()).collect();
            assert_eq!(cells, ["Citro\u{eb}n", "\u{e9}t\u{e9}"], "{bytes:?}");
        }
        let problems = Sheet::read("t.xlsx", b"PK\x03\x04abc").expect_err("no text");
        assert!(
            problems
                .iter()
                .all(|own| own.hint.contains("cvtcycle.fleet(frame)"))
        );
    }

    #[test]
    fn a_file_of_blanks_is_no_table() {
        let problems = Sheet::read("t.csv", b" \r\n").expect_err("no table");
        assert!(problems.iter().all(|problem| problem.hint == HINT));
    }
}
