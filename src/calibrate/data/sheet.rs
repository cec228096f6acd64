//! A CSV file of numbers and words in known columns.

use crate::config::{Bound, Place, Problem};
use crate::cycle::problems::{Complaint, Line, Problems};
use crate::cycle::text::{Field, split};

/// What a column may hold.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Column {
    /// Name.
    pub name: String,
    /// Range of numbers, in the unit of the name; none for words.
    pub range: Option<Bound>,
    /// Whether a cell may be empty.
    pub may_be_empty: bool,
}

/// One cell.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Cell {
    /// A number.
    Number(f64),
    /// A word.
    Word(String),
    /// Nothing.
    Empty,
}

/// One row.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    /// Line, counted from 1.
    pub line: usize,
    /// Its text.
    pub text: String,
    /// Cells in the order of the columns, with the place of each: column of the first character, width.
    pub cells: Vec<(Cell, usize, usize)>,
}

/// A whole file.
#[derive(Clone, Debug)]
pub(crate) struct Sheet {
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

    /// The word of a cell; empty where there is none.
    pub fn word(&self, row: usize, column: Option<usize>) -> &str {
        match column.and_then(|k| self.rows.get(row).and_then(|row| row.cells.get(k))) {
            Some((Cell::Word(word), ..)) => word,
            _ => "",
        }
    }

    /// Where a cell stands.
    pub fn place(&self, row: usize, column: usize) -> Place {
        let Some(row) = self.rows.get(row) else { return Place { file: self.file.clone(), ..Place::default() } };
        let (start, width) = row.cells.get(column).map_or((1, row.text.chars().count().max(1)), |(_, start, width)| (*start, *width));
        Place { file: self.file.clone(), line: row.line, column: start, line_text: row.text.clone(), width }
    }

    /// A problem of a cell.
    pub fn problem(&self, row: usize, column: usize, complaint: Complaint) -> Problem {
        let key = self.columns.get(column).map(|column| column.name.clone()).unwrap_or_default();
        let value = match self.rows.get(row).and_then(|row| row.cells.get(column)) {
            Some((Cell::Number(x), ..)) => x.to_string(),
            Some((Cell::Word(word), ..)) => word.clone(),
            _ => String::new(),
        };
        let Complaint { message, allowed, hint } = complaint;
        Problem { place: self.place(row, column), key, value, allowed, message, hint }
    }
}

/// Longest line of which the text is kept for carets.
const LONGEST_KEPT: usize = 300;

/// Reads a file; `known` says what a column of a name may hold, `required` which have to be there.
///
/// # Errors
/// All problems with line, column and value; after 50 the rest is counted in one last entry.
pub(crate) fn read(
    file: &str,
    bytes: &[u8],
    known: &dyn Fn(&str) -> Result<Column, Complaint>,
    required: &[&str],
) -> Result<Sheet, Vec<Problem>> {
    let mut problems = Problems::new(file);
    let Some(mut lines) = problems.lines(bytes) else {
        return Err(problems.finish());
    };
    let Some(columns) = lines.next().and_then(|line| header(line, known, required, &mut problems)) else {
        if problems.is_empty() {
            problems.file(Complaint::new("the file is empty", "a line of column names, then rows", "was it cut off?"));
        }
        return Err(problems.finish());
    };
    let mut rows = Vec::new();
    let mut fields = Vec::new();
    for line in lines {
        if problems.split(line, columns.len(), &mut fields) {
            let cells = fields.iter().zip(&columns).map(|(field, column)| match column {
                Some(column) => (cell(line, *field, column, &mut problems), start(line, *field), field.text.chars().count().max(1)),
                None => (Cell::Empty, 1, 1),
            });
            let text = if line.text.len() <= LONGEST_KEPT { line.text.to_owned() } else { String::new() };
            rows.push(Row { line: line.number, text, cells: cells.collect() });
        }
    }
    if rows.is_empty() && problems.is_empty() {
        problems.file(Complaint::new("the file has column names and no rows", "a row for every measurement", "add the rows"));
    }
    if !problems.is_empty() {
        return Err(problems.finish());
    }
    Ok(Sheet { file: file.to_owned(), columns: columns.into_iter().flatten().collect(), rows })
}

fn start(line: Line, field: Field) -> usize {
    line.text.get(..field.start).unwrap_or_default().chars().count() + 1
}

/// The columns; none where the lines below cannot be understood, none in place of a column that nobody knows.
fn header(
    line: Line,
    known: &dyn Fn(&str) -> Result<Column, Complaint>,
    required: &[&str],
    problems: &mut Problems,
) -> Option<Vec<Option<Column>>> {
    if !problems.is_table(line) {
        return None;
    }
    let mut fields = Vec::new();
    if let Err(start) = split(line.text, &mut fields) {
        problems.open_quote(line, start);
        return None;
    }
    let mut columns: Vec<Option<Column>> = Vec::new();
    for field in fields {
        let found = known(field.text);
        match &found {
            Err(complaint) => problems.value(line, field, field.text, || complaint.clone()),
            Ok(_) if columns.iter().flatten().any(|column| column.name == field.text) => problems.value(line, field, field.text, || {
                Complaint::new("this column stands here twice", "each column once", "remove one of them")
            }),
            Ok(_) => {}
        }
        columns.push(found.ok());
    }
    for name in required {
        // A name that is not known may be the misspelt one.
        if columns.iter().all(|column| column.as_ref().is_some_and(|column| column.name != *name)) {
            let message = format!("a column {name} is missing");
            problems.line(line, name, || Complaint::new(message, "", "add it; the unit is in the name"));
        }
    }
    Some(columns)
}

fn cell(line: Line, field: Field, column: &Column, problems: &mut Problems) -> Cell {
    if field.text.is_empty() && column.may_be_empty {
        return Cell::Empty;
    }
    let Some(range) = column.range else {
        if field.text.is_empty() {
            problems
                .value(line, field, &column.name, || Complaint::new("the value is missing", "a word", "fill the gap or remove the row"));
        }
        return Cell::Word(field.text.to_owned());
    };
    let (message, hint) = match field.text.parse::<f64>() {
        // turns -0 into 0
        Ok(x) if range.contains(x) => return Cell::Number(x + 0.0),
        Ok(x) if x.is_finite() => ("this value is out of range", "the unit is in the column's name"),
        Ok(_) => ("this is not a finite number", "leave the cell empty where nothing was measured"),
        Err(_) if field.text.is_empty() => ("the value is missing", "fill the gap or remove the row"),
        Err(_) if field.text.contains(',') => ("this is not a number", "write a decimal point: 12.5 and not 12,5"),
        Err(_) => ("this is not a number", "write the bare number; the unit is in the column's name"),
    };
    problems.value(line, field, &column.name, || Complaint::new(message, range.to_string(), hint));
    Cell::Empty
}
