//! A CSV file of numbers and words in known columns.

use std::borrow::Cow;

use cvtcycle_config::csv::{self, Collector, Column, Line, Schema, Table, Value};
use cvtcycle_config::{Bound, Place, Problem};

/// Prefix of the column of standard deviations.
pub const SD: &str = "sd_";

/// One cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// A number.
    Number(f64),
    /// A word.
    Word(String),
    /// Nothing.
    Empty,
    /// A problem was reported.
    Bad,
}

/// One row.
#[derive(Clone, Debug)]
pub struct Row {
    /// Line, counted from 1.
    pub line: usize,
    /// Text of the file.
    pub text: String,
    /// Cells in the order of the columns, with the place of each: column of the first character, width.
    pub cells: Vec<(Cell, usize, usize)>,
}

/// A whole file.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// Name of the file.
    pub file: String,
    /// Names of the columns in order; empty for one that is not known.
    pub columns: Vec<String>,
    /// Indices of the measured columns.
    pub measured: Vec<usize>,
    /// Rows in order.
    pub rows: Vec<Row>,
}

impl Sheet {
    /// Index of a column.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column == name)
    }

    fn cell(&self, row: usize, column: Option<usize>) -> Option<&(Cell, usize, usize)> {
        self.rows.get(row)?.cells.get(column?)
    }

    /// The number of a cell; none where it is empty or the column is not there.
    pub fn number(&self, row: usize, column: Option<usize>) -> Option<f64> {
        match self.cell(row, column)?.0 {
            Cell::Number(x) => Some(x),
            _ => None,
        }
    }

    /// True if a problem of the cell was reported.
    pub fn is_bad(&self, row: usize, column: Option<usize>) -> bool {
        matches!(self.cell(row, column), Some((Cell::Bad, ..)))
    }

    /// The word of a cell; empty where there is none.
    pub fn word(&self, row: usize, column: Option<usize>) -> &str {
        match self.cell(row, column) {
            Some((Cell::Word(word), ..)) => word,
            _ => "",
        }
    }

    /// The place of a cell.
    pub fn place(&self, row: usize, column: usize) -> Place {
        let Some(own) = self.rows.get(row) else {
            return Place::file(&self.file);
        };
        let whole = (1, own.text.chars().count().max(1));
        let cell = self.cell(row, Some(column));
        let (start, width) = cell.map_or(whole, |(_, start, width)| (*start, *width));
        Place {
            line: own.line,
            column: start,
            line_text: own.text.as_str().into(),
            width,
            ..Place::file(&self.file)
        }
    }

    /// A problem with the place of a cell.
    pub fn problem(&self, row: usize, column: usize, problem: Problem) -> Problem {
        let key = self.columns.get(column).cloned().unwrap_or_default();
        let value = match self.cell(row, Some(column)) {
            Some((Cell::Number(x), ..)) => x.to_string(),
            Some((Cell::Word(word), ..)) => word.clone(),
            _ => String::new(),
        };
        problem.at(self.place(row, column)).key(key).value(value)
    }
}

/// Columns that a sort of file can measure.
#[derive(Clone, Copy)]
pub struct Measured<'r> {
    /// Names of the columns that can be measured.
    pub names: &'r [&'static str],
    /// One of them.
    pub example: &'static str,
}

/// Largest number of values of a file, rows times columns: each is kept with its place.
const MAX_VALUES: usize = 500_000;

/// Longest line of which the text is kept for carets.
const MAX_KEPT_LEN: usize = 300;

/// Reads a file and all its problems, with line, column and value; after 50 the rest is counted. What can be understood of a bad file is
/// given, so that more can be said of it; no sheet where that is nothing.
pub fn read<'f>(
    file: &'f str,
    bytes: &[u8],
    settings: impl IntoIterator<Item = Column>,
    names: impl Into<Cow<'static, str>>,
    measured: Option<Measured>,
) -> (Option<Sheet>, Collector<'f>) {
    let measurable = measured.map_or(&[][..], |measured| measured.names);
    let with_sd = measurable.iter().flat_map(|name| {
        let deviation = Column::number(format!("{SD}{name}"), Bound::positive());
        [Column::number(*name, Bound::any()), deviation].map(Column::or_empty)
    });
    let schema = Schema {
        columns: settings.into_iter().chain(with_sd).collect(),
        names: names.into(),
        max_rows: (
            usize::MAX,
            "leave out columns that are not needed, or rows: values that are close in time say the same",
        ),
        max_values: MAX_VALUES,
        rows: "a row for every measurement",
        ..Schema::default()
    };
    let mut problems = Collector::new(file);
    let mut rows = Vec::new();
    let check = |table: &Table, header: Line<'_>, problems: &mut Collector<'_>| {
        if let Some(measured) = measured {
            check_measured(table, header, measured, problems);
        }
    };
    let table = csv::read(bytes, &schema, &mut problems, check, |row, _| {
        rows.push(Row::new(row));
        true
    });
    let sheet = table.map(|table| {
        let columns = table.columns();
        let name =
            |column: Option<&Column>| column.map_or_else(String::new, |c| c.name.to_string());
        let columns: Vec<String> = columns.map(name).collect();
        let is_measured = |k: &usize| measurable.contains(&columns[*k].as_str());
        Sheet {
            file: file.to_owned(),
            measured: (0..columns.len()).filter(is_measured).collect(),
            columns,
            rows,
        }
    });
    (sheet, problems)
}

impl Row {
    fn new(row: &csv::Row<'_, '_>) -> Self {
        let line = row.line;
        let cells = row.fields().iter().zip(row.values()).map(|(field, value)| {
            let cell = match value {
                Value::Number(x) => Cell::Number(*x),
                Value::Word => Cell::Word(line.text_of(*field).to_owned()),
                Value::Empty => Cell::Empty,
                Value::Bad => Cell::Bad,
            };
            let (start, width) = line.columns_of(*field);
            (cell, start, width)
        });
        let kept = Some(line.text).filter(|text| text.len() <= MAX_KEPT_LEN);
        Row {
            line: line.number,
            cells: cells.collect(),
            text: kept.unwrap_or_default().to_owned(),
        }
    }
}

/// Reports that nothing was measured, and standard deviations without what was measured. A name that is not known may be the misspelt one.
fn check_measured(
    table: &Table,
    header: Line<'_>,
    measured: Measured,
    problems: &mut Collector<'_>,
) {
    let names = table
        .columns()
        .map(|column| column.map(|column| &*column.name));
    let Some(names) = names.collect::<Option<Vec<&str>>>() else {
        return;
    };
    if !names.iter().any(|name| measured.names.contains(name)) {
        let hint = format!("add what was measured, for example {}", measured.example);
        let problem = Problem::missing("no column was measured");
        problems.line(header, "", || problem.hint(hint));
    }
    for (name, field) in names.iter().zip(table.fields()) {
        if let Some(of) = name.strip_prefix(SD).filter(|of| !names.contains(of)) {
            problems.value(header, *field, name, || {
                Problem::missing(format!("a standard deviation without a column {of}"))
                    .hint(format!("add the measured {of}, or remove it"))
            });
        }
    }
}

/// Words for the rows beyond the first one of which the same is to be said.
pub fn and_more(rows: usize) -> String {
    match rows {
        0 | 1 => String::new(),
        2 => ", nor is it right in 1 more row".to_owned(),
        _ => format!(", nor is it right in {} more rows", rows - 1),
    }
}
