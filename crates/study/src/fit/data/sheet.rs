//! A CSV file of numbers and words in known columns.

use super::points::SD;
use cvtcycle_config::cycle::problems::{Collector, Complaint, Line};
use cvtcycle_config::cycle::text::Field;
use cvtcycle_config::{Bound, Place, Problem, unit_of};

/// What a column may hold.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Column {
    /// Name; empty for a column that nobody knows.
    pub name: String,
    /// Range of numbers, in the unit of the name; none for words.
    pub range: Option<Bound>,
    /// Whether a cell may be empty.
    pub may_be_empty: bool,
}

/// One cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// A number.
    Number(f64),
    /// A word.
    Word(String),
    /// Nothing.
    Empty,
    /// Something that was complained of.
    Bad,
}

/// One row.
#[derive(Clone, Debug)]
pub struct Row {
    /// Line, counted from 1.
    pub line: usize,
    /// Its text.
    pub text: String,
    /// Cells in the order of the columns, with the place of each: column of the first character, width.
    pub cells: Vec<(Cell, usize, usize)>,
}

/// A whole file.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// Name of the file.
    pub file: String,
    /// Columns in order.
    pub columns: Vec<Column>,
    /// Rows in order.
    pub rows: Vec<Row>,
}

impl Sheet {
    /// Index of a column.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column.name == name)
    }

    /// The number of a cell; none where it is empty or the column is not there.
    pub fn number(&self, row: usize, column: Option<usize>) -> Option<f64> {
        match self.rows.get(row)?.cells.get(column?)?.0 {
            Cell::Number(x) => Some(x),
            _ => None,
        }
    }

    /// Whether a cell was complained of.
    pub fn is_bad(&self, row: usize, column: Option<usize>) -> bool {
        let cell = column.and_then(|k| self.rows.get(row)?.cells.get(k));
        matches!(cell, Some((Cell::Bad, ..)))
    }

    /// The word of a cell; empty where there is none.
    pub fn word(&self, row: usize, column: Option<usize>) -> &str {
        match column.and_then(|k| self.rows.get(row).and_then(|row| row.cells.get(k))) {
            Some((Cell::Word(word), ..)) => word,
            _ => "",
        }
    }

    /// Where a cell stands.
    pub fn place(&self, row: usize, column: usize) -> Place {
        let Some(row) = self.rows.get(row) else {
            return Place {
                file: self.file.clone(),
                ..Place::default()
            };
        };
        let (start, width) = row
            .cells
            .get(column)
            .map_or((1, row.text.chars().count().max(1)), |(_, start, width)| {
                (*start, *width)
            });
        Place {
            file: self.file.clone(),
            line: row.line,
            column: start,
            line_text: row.text.clone(),
            width,
        }
    }

    /// A problem of a cell.
    pub fn problem(&self, row: usize, column: usize, complaint: Complaint) -> Problem {
        let key = self
            .columns
            .get(column)
            .map(|column| column.name.clone())
            .unwrap_or_default();
        let value = match self.rows.get(row).and_then(|row| row.cells.get(column)) {
            Some((Cell::Number(x), ..)) => x.to_string(),
            Some((Cell::Word(word), ..)) => word.clone(),
            _ => String::new(),
        };
        let Complaint {
            message,
            allowed,
            hint,
        } = complaint;
        Problem::invalid(message)
            .at(self.place(row, column))
            .key(key)
            .value(value)
            .allowed(allowed)
            .hint(hint)
    }
}

/// What a sort of file has to look like.
pub struct Rules<'r> {
    /// What a column of a name may hold.
    pub known: &'r dyn Fn(&str) -> Result<Column, Complaint>,
    /// Columns that have to be there.
    pub required: &'r [&'r str],
    /// Which columns are measured; none where rows say what was measured.
    pub is_measured: Option<&'r dyn Fn(&str) -> bool>,
    /// One of these columns.
    pub example: &'static str,
}

/// Most values of a file, rows times columns: each is kept with its place.
const MOST_VALUES: usize = 500_000;

/// Longest line of which the text is kept for carets.
const LONGEST_KEPT: usize = 300;

/// Reads a file and all its problems, with line, column and value; after 50 the rest is counted. What can be understood of a bad file is
/// given, so that more can be said of it; no sheet where that is nothing.
pub fn read<'f>(file: &'f str, bytes: &[u8], rules: &Rules) -> (Option<Sheet>, Collector<'f>) {
    let mut problems = Collector::new(file);
    if std::str::from_utf8(bytes)
        .is_ok_and(|text| text.trim_start_matches('\u{feff}').trim().is_empty())
    {
        problems.file(Complaint::new(
            "the file is empty",
            "a line of column names, then a row for every measurement",
            "was it cut off?",
        ));
        return (None, problems);
    }
    let Some(mut lines) = problems.lines(bytes) else {
        return (None, problems);
    };
    let Some(columns) = lines
        .next()
        .and_then(|line| header(line, rules, &mut problems))
    else {
        return (None, problems);
    };
    let mut rows = Vec::new();
    let mut fields = Vec::new();
    let mut values = 0;
    for line in lines {
        values += columns.len();
        if values > MOST_VALUES {
            let hint = "leave out columns that are not needed, or rows: values that are close in time say the same";
            problems.line(line, "", || {
                Complaint::new(
                    "the file has too many values",
                    format!("up to {MOST_VALUES}, rows times columns"),
                    hint,
                )
            });
            break;
        }
        if problems.split(line, columns.len(), &mut fields) {
            let cells = fields
                .iter()
                .zip(&columns)
                .map(|(field, column)| match column {
                    Some(column) => (
                        cell(line, *field, column, &mut problems),
                        start(line, *field),
                        field.text.chars().count().max(1),
                    ),
                    None => (Cell::Bad, 1, 1),
                });
            let text = if line.text.len() <= LONGEST_KEPT {
                line.text.to_owned()
            } else {
                String::new()
            };
            rows.push(Row {
                line: line.number,
                text,
                cells: cells.collect(),
            });
        }
    }
    if rows.is_empty() && problems.is_empty() {
        problems.file(Complaint::new(
            "the file has column names and no rows",
            "a row for every measurement",
            "add the rows",
        ));
    }
    let columns = columns.into_iter().map(Option::unwrap_or_default).collect();
    (
        Some(Sheet {
            file: file.to_owned(),
            columns,
            rows,
        }),
        problems,
    )
}

fn start(line: Line, field: Field) -> usize {
    line.text
        .get(..field.start)
        .unwrap_or_default()
        .chars()
        .count()
        + 1
}

/// The columns; none where the lines below cannot be understood, none in place of a column that nobody knows.
fn header(line: Line, rules: &Rules, problems: &mut Collector) -> Option<Vec<Option<Column>>> {
    let fields = problems.names(line)?;
    let mut columns: Vec<Option<Column>> = Vec::new();
    for field in &fields {
        let (field, found) = (*field, (rules.known)(field.text));
        match &found {
            Err(complaint) => problems.value(line, field, field.text, || complaint.clone()),
            Ok(_)
                if columns
                    .iter()
                    .flatten()
                    .any(|column| column.name == field.text) =>
            {
                problems.value(line, field, field.text, || {
                    Complaint::new(
                        "this column stands here twice",
                        "each column once",
                        "remove one of them",
                    )
                })
            }
            Ok(_) => {}
        }
        columns.push(found.ok());
    }
    // A name that is not known may be the misspelt one.
    let none = |is: &dyn Fn(&str) -> bool| {
        columns
            .iter()
            .all(|column| column.as_ref().is_some_and(|column| !is(&column.name)))
    };
    for name in rules.required {
        if none(&|column| column == *name) {
            let message = format!("a column {name} is missing");
            problems.line(line, name, || {
                Complaint::new(message, "", "add it; the unit is in the name")
            });
        }
    }
    if let Some(is_measured) = rules.is_measured {
        if none(is_measured) {
            let hint = format!("add what was measured, for example {}", rules.example);
            problems.line(line, "", || {
                Complaint::new("no column was measured", "", hint)
            });
        }
        for (field, column) in fields.iter().zip(&columns) {
            let of = column
                .as_ref()
                .and_then(|column| column.name.strip_prefix(SD));
            if let Some(of) = of.filter(|of| none(&|column| column == *of)) {
                let message = format!("this column stands without a column {of}");
                problems.value(line, *field, field.text, || {
                    Complaint::new(message, "", format!("add the measured {of}, or remove it"))
                });
            }
        }
    }
    Some(columns)
}

fn cell(line: Line, field: Field, column: &Column, problems: &mut Collector) -> Cell {
    if field.text.is_empty() && column.may_be_empty {
        return Cell::Empty;
    }
    let Some(range) = column.range else {
        if field.text.is_empty() {
            problems.value(line, field, &column.name, || {
                Complaint::new(
                    "the value is missing",
                    "a word",
                    "fill the gap or remove the row",
                )
            });
        }
        return if field.text.is_empty() {
            Cell::Bad
        } else {
            Cell::Word(field.text.to_owned())
        };
    };
    let (message, hint) = match field.text.parse::<f64>() {
        // turns -0 into 0
        Ok(x) if range.contains(x) => return Cell::Number(x + 0.0),
        Ok(x) if x.is_finite() => (
            "this value is out of range",
            "the unit is in the column's name",
        ),
        Ok(_) if column.may_be_empty => (
            "this is not a finite number",
            "leave the cell empty where nothing was measured",
        ),
        Ok(_) => (
            "this is not a finite number",
            "remove the row where nothing was measured",
        ),
        Err(_) if field.text.is_empty() => {
            ("the value is missing", "fill the gap or remove the row")
        }
        Err(_) if field.text.contains(',') => (
            "this is not a number",
            "write a decimal point: 12.5 and not 12,5",
        ),
        Err(_) => (
            "this is not a number",
            "write the bare number; the unit is in the column's name",
        ),
    };
    problems.value(line, field, &column.name, || {
        Complaint::new(message, range.in_unit(unit_of(&column.name)), hint)
    });
    Cell::Bad
}
