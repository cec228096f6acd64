//! Rows of a table against its schema.

use super::collector::{Cell, Collector, Line};
use super::header::Header;
use super::schema::{Cells, Column, Schema};
use super::text::{Delimiter, Field, split};
use crate::Problem;

/// Content of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// A number.
    Number(f64),
    /// A word.
    Word,
    /// Nothing, where that is allowed.
    Empty,
    /// A problem was reported.
    Bad,
}

/// A table whose column names were read.
#[derive(Debug)]
pub struct Table<'s> {
    schema: &'s Schema,
    header: Header,
    /// Column of the file of each column of the schema.
    positions: Vec<Option<usize>>,
    fields: Vec<Field>,
    values: Vec<Value>,
}

impl<'s> Table<'s> {
    /// Reads the line of column names, with those below it, from which the signs between columns and decimals are found; none where the
    /// rows cannot be understood. [`Table::head_lines`] of the lines are no rows.
    pub fn open<'t>(
        names: Line<'t>,
        below: impl Iterator<Item = Line<'t>> + Clone,
        schema: &'s Schema,
        problems: &mut Collector<'_>,
    ) -> Option<Table<'s>> {
        let mut header = schema.header(names, below, problems)?;
        let columns = &header.columns;
        let position = |index| columns.iter().position(|known| *known == Some(index));
        Some(Table {
            schema,
            positions: (0..schema.columns.len()).map(position).collect(),
            values: vec![Value::Bad; columns.len()],
            fields: std::mem::take(&mut header.fields),
            header,
        })
    }

    /// Number of lines above the first row, without blank ones and comments.
    pub fn head_lines(&self) -> usize {
        self.header.lines
    }

    /// How the table was read, in words, where it is not written as the program's own are: its separators, a row of units, names of
    /// other programs.
    pub fn read_as(&self) -> Option<&str> {
        self.header.read_as.as_deref()
    }

    /// The columns of the file in its order; `None` for one that is not known.
    pub fn columns(&self) -> impl Iterator<Item = Option<&'s Column>> {
        let column = |index: &Option<usize>| index.map(|index| &self.schema.columns[index]);
        self.header.columns.iter().map(column)
    }

    /// The fields of the line that was read last.
    pub fn fields(&self) -> &[Field] {
        &self.fields
    }

    /// True if the file has that column of the schema.
    pub fn has(&self, column: usize) -> bool {
        self.positions[column].is_some()
    }

    /// The column of a group that the file has, as index of the schema.
    pub fn group_column(&self, group: &str) -> Option<usize> {
        let is_in = |index: &usize| self.schema.columns[*index].group == group;
        self.header.columns.iter().flatten().copied().find(is_in)
    }

    /// Columns of the schema that say again what another one of their group says; [`Row::spare`] has their cells.
    pub fn spares(&self) -> impl Iterator<Item = usize> {
        self.header.spares.iter().map(|own| own.index)
    }

    /// The name of a column of the schema in the file. Behind the line of names, as its fields are those of the line that was read last.
    pub fn written<'t>(&self, names: Line<'t>, column: usize) -> Option<&'t str> {
        let mut spares = self.header.spares.iter();
        let spare = || Some(spares.find(|own| own.index == column)?.at);
        let at = self.positions[column].or_else(spare)?;
        Some(names.text_of(*self.fields.get(at)?))
    }

    /// Name of a column of the schema.
    pub fn name(&self, column: usize) -> &'s str {
        &self.schema.columns[column].name
    }

    /// Reads a row. After a problem of the whole line every value is bad.
    pub fn row<'a, 't>(&'a mut self, line: Line<'t>, problems: &mut Collector<'_>) -> Row<'a, 't> {
        self.values.fill(Value::Bad);
        let (count, delimiter) = (self.values.len(), self.header.delimiter);
        if problems.split(line, delimiter, count, &mut self.fields) {
            for (at, value) in self.values.iter_mut().enumerate() {
                *value = match self.header.columns[at] {
                    Some(index) => {
                        let column = &self.schema.columns[index];
                        let cell = (line, self.fields[at]);
                        read_cell(cell, column, self.header.decimal_comma, problems)
                    }
                    None => Value::Word,
                };
            }
            for spare in &self.header.spares {
                let cell = (line, self.fields[spare.at]);
                self.values[spare.at] =
                    read_cell(cell, &spare.column, self.header.decimal_comma, problems);
            }
        } else {
            self.fields.clear();
        }
        Row { table: self, line }
    }
}

fn read_cell(
    (line, field): (Line<'_>, Field),
    column: &Column,
    decimal_comma: bool,
    problems: &mut Collector<'_>,
) -> Value {
    let text = line.text_of(field);
    let found = match column.cells {
        Cells::Ignored => return Value::Word,
        _ if column.may_be_empty && is_nothing(text) => return Value::Empty,
        Cells::Word if text.is_empty() => Err(Problem::missing("the value is missing")
            .allowed(if column.allowed.is_empty() {
                "a word"
            } else {
                column.allowed
            })
            .hint(if column.hint.is_empty() {
                "fill the gap or remove the row"
            } else {
                column.hint
            })),
        Cells::Word => return Value::Word,
        Cells::Number(_) | Cells::Whole(_) => column.parse(text, decimal_comma),
    };
    found.map_or_else(
        |problem| {
            problems.value(line, field, &column.name, || problem);
            Value::Bad
        },
        Value::Number,
    )
}

/// True if a cell says that nothing was measured.
fn is_nothing(text: &str) -> bool {
    text.chars().all(|c| c == '-')
        || ["nan", "n/a", "na"]
            .iter()
            .any(|word| word.eq_ignore_ascii_case(text))
}

/// A row that was read; columns are indices of the schema.
#[derive(Clone, Copy, Debug)]
pub struct Row<'a, 't> {
    table: &'a Table<'a>,
    /// Line.
    pub line: Line<'t>,
}

impl<'a, 't> Row<'a, 't> {
    /// The table that it is of.
    pub fn table(&self) -> &'a Table<'a> {
        self.table
    }

    /// Values in the order of the file's columns.
    pub fn values(&self) -> &'a [Value] {
        &self.table.values
    }

    /// Fields in the order of the file's columns; none after a problem of the whole line.
    pub fn fields(&self) -> &'a [Field] {
        &self.table.fields
    }

    fn value(&self, column: usize) -> Option<Value> {
        self.table.positions[column].map(|at| self.table.values[at])
    }

    /// The number of a cell; none where it is empty, bad or not in the file.
    pub fn number(&self, column: usize) -> Option<f64> {
        match self.value(column) {
            Some(Value::Number(x)) => Some(x),
            _ => None,
        }
    }

    /// The number of a cell and half of its last digit, by which rounding may have moved it.
    pub fn rounded(&self, column: usize) -> Option<[f64; 2]> {
        Some([self.number(column)?, self.half_digit(self.field(column)?)])
    }

    /// The number of the spare column at that place of [`Table::spares`], half of its last digit, and its place in the line; none of an empty cell.
    pub fn spare(&self, place: usize) -> Option<([f64; 2], Field)> {
        let at = self.table.header.spares.get(place)?.at;
        let (value, field) = (self.table.values[at], *self.table.fields.get(at)?);
        match value {
            Value::Number(x) => Some(([x, self.half_digit(field)], field)),
            _ => None,
        }
    }

    fn half_digit(&self, field: Field) -> f64 {
        half_digit(self.line.text_of(field), self.table.header.decimal_comma)
    }

    /// The word of a cell; empty where there is none.
    pub fn word(&self, column: usize) -> &'t str {
        match (self.value(column), self.field(column)) {
            (Some(Value::Word), Some(field)) => self.line.text_of(field),
            _ => "",
        }
    }

    fn field(&self, column: usize) -> Option<Field> {
        self.table
            .fields
            .get(self.table.positions[column]?)
            .copied()
    }

    /// True if a problem of the cell, or of the whole row, was reported.
    pub fn is_bad(&self, column: usize) -> bool {
        self.value(column) == Some(Value::Bad)
    }

    /// True if a problem of any cell was reported.
    pub fn has_bad(&self) -> bool {
        self.table.values.contains(&Value::Bad)
    }

    /// The cell with its place; none where the file has no such column or the line could not be split.
    pub fn cell<'c>(&self, column: usize) -> Option<Cell<'c>>
    where
        'a: 'c,
        't: 'c,
    {
        Some(Cell {
            line: self.line,
            key: &self.table.schema.columns[column].name,
            field: self.field(column)?,
        })
    }

    /// Reports a problem of a cell; of the whole line where the file has no such column.
    pub fn report(&self, column: usize, problems: &mut Collector<'_>, problem: Problem) {
        match self.cell(column) {
            Some(cell) => problems.cell(&cell, || problem),
            None => {
                let key = &self.table.schema.columns[column].name;
                problems.line(self.line, key, || problem);
            }
        }
    }
}

/// Half of the last digit of a number: 0.05 of `12.5` and of `125e-1`.
fn half_digit(text: &str, decimal_comma: bool) -> f64 {
    let (digits, power) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let sign = if decimal_comma && digits.contains(',') {
        ','
    } else {
        '.'
    };
    let decimals = digits
        .split_once(sign)
        .map_or(0, |(_, behind)| behind.len());
    let decimals = i32::try_from(decimals).unwrap_or(i32::MAX);
    let power = power.parse::<i32>().unwrap_or(0);
    0.5 * 10f64.powi(power.saturating_sub(decimals))
}

/// Most lines of [`first_fields`].
const FIRST_LINES: usize = 2000;

/// The fields of the first lines of a table that is in memory, whatever they are; none where it cannot be understood. The sign between them is that of
/// the first line that has one.
pub fn first_fields(bytes: &[u8]) -> Vec<Vec<String>> {
    let Some(lines) = Collector::new("").lines(bytes) else {
        return Vec::new();
    };
    let lines: Vec<Line<'_>> = lines.take(FIRST_LINES).collect();
    let sign = (0..lines.len().min(2)).find_map(|k| {
        let below = lines[k + 1..].iter().copied().take(2);
        let delimiter = Delimiter::detect(lines[k], below).ok()?;
        lines[k]
            .text
            .contains(delimiter.sign())
            .then(|| delimiter.sign())
    });
    let mut fields = Vec::new();
    let split_line = |line: &Line<'_>| {
        split(line.text, sign.unwrap_or(','), &mut fields).ok()?;
        let text = |field: &Field| line.text_of(*field).to_owned();
        Some(fields.iter().map(text).collect())
    };
    lines.iter().map_while(split_line).collect()
}

/// Reads a table that is in memory. `check` receives the line of column names; `take` receives every row and returns false to end the
/// reading. None where the column names could not be read.
pub fn read<'s, 't>(
    bytes: &'t [u8],
    schema: &'s Schema,
    problems: &mut Collector<'_>,
    check: impl FnOnce(&Table<'s>, Line<'t>, &mut Collector<'_>),
    mut take: impl FnMut(&Row<'_, 't>, &mut Collector<'_>) -> bool,
) -> Option<Table<'s>> {
    let mut lines = problems.lines(bytes)?;
    let rows = lines.clone();
    let Some(header) = lines.next() else {
        problems.no_text();
        return None;
    };
    let mut table = Table::open(header, lines, schema, problems)?;
    check(&table, header, problems);
    let (max_rows, hint) = schema.max_rows;
    let mut count = 0;
    for line in rows.skip(table.head_lines()) {
        if count == max_rows || (count + 1) * table.values.len() > schema.max_values {
            problems.line(line, "", || {
                if count == max_rows {
                    Problem::too_large("the file has too many rows")
                        .allowed(format!("up to {max_rows} rows"))
                } else {
                    Problem::too_large("the file has too many values")
                        .allowed(format!("up to {}, rows times columns", schema.max_values))
                }
                .hint(hint)
            });
            return Some(table);
        }
        count += 1;
        let row = table.row(line, problems);
        if !take(&row, problems) {
            return Some(table);
        }
    }
    if count == 0 {
        problems.no_rows(schema.rows);
    }
    Some(table)
}
