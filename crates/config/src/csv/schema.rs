//! The columns that a table may have, as data, and the checks of its line of column names.

use std::borrow::Cow;

use super::collector::{Collector, Line};
use super::text::Field;
use crate::{Bound, Problem, near, suggestion, unit_of};

/// What the cells of a column hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cells {
    /// Numbers in the unit at the end of the column's name.
    Number(Bound),
    /// Whole numbers.
    Whole(Bound),
    /// Words.
    Word,
    /// Anything: the column is not read.
    Ignored,
}

/// One column that a table may have.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its name in the file.
    pub name: Cow<'static, str>,
    /// What its cells hold.
    pub cells: Cells,
    /// A table has just one column of a group; each column without a group is one of its own.
    pub group: &'static str,
    /// True if the table has to have the column, or another one of its group.
    pub required: bool,
    /// True if a cell may be empty.
    pub may_be_empty: bool,
    /// Accepted cells in words, in place of the range.
    pub allowed: &'static str,
    /// Hint for a bad cell, in place of the general ones.
    pub hint: &'static str,
}

impl Column {
    /// An optional column.
    pub fn new(name: impl Into<Cow<'static, str>>, cells: Cells) -> Self {
        Column {
            name: name.into(),
            cells,
            group: "",
            required: false,
            may_be_empty: false,
            allowed: "",
            hint: "",
        }
    }

    /// An optional column of numbers.
    pub fn number(name: impl Into<Cow<'static, str>>, range: Bound) -> Self {
        Column::new(name, Cells::Number(range))
    }

    /// The table has to have it, or another column of its group.
    #[must_use]
    pub fn required(self) -> Self {
        Column {
            required: true,
            ..self
        }
    }

    /// Its cells may be empty.
    #[must_use]
    pub fn or_empty(self) -> Self {
        Column {
            may_be_empty: true,
            ..self
        }
    }

    /// It gives the same quantity as the other columns of this group.
    #[must_use]
    pub fn group(self, group: &'static str) -> Self {
        Column { group, ..self }
    }

    /// Accepted cells in words.
    #[must_use]
    pub fn allowed(self, allowed: &'static str) -> Self {
        Column { allowed, ..self }
    }

    /// Hint for a bad cell.
    #[must_use]
    pub fn hint(self, hint: &'static str) -> Self {
        Column { hint, ..self }
    }

    fn is_same(&self, other: &Column) -> bool {
        self.name == other.name || !self.group.is_empty() && self.group == other.group
    }

    /// The number in a cell.
    pub(super) fn parse(&self, text: &str) -> Result<f64, Problem> {
        let (range, whole) = match self.cells {
            Cells::Number(range) => (range, false),
            Cells::Whole(range) => (range, true),
            Cells::Word | Cells::Ignored => (Bound::any(), false),
        };
        let is_whole = |x: f64| !whole || x.fract() == 0.0;
        let gap = if self.may_be_empty {
            "leave the cell empty where nothing was measured"
        } else {
            "fill the gap or remove the row"
        };
        let problem = match text.parse::<f64>() {
            // turns -0 into 0
            Ok(x) if range.contains(x) && is_whole(x) => return Ok(x + 0.0),
            Ok(x) if x.is_nan() => Problem::wrong_type("this is not a number").hint(gap),
            Ok(x) if x.is_infinite() => {
                Problem::out_of_range("this is not a finite number").hint(gap)
            }
            Ok(x) if !is_whole(x) => {
                Problem::wrong_type("this is not a whole number").hint("write it without decimals")
            }
            Ok(_) => Problem::out_of_range("this value is out of range").hint(
                match unit_of(&self.name) {
                    "-" => "",
                    _ => "the unit is in the column's name",
                },
            ),
            Err(_) if text.is_empty() => Problem::missing("the value is missing").hint(gap),
            Err(_) if text.contains(',') => Problem::wrong_type("this is not a number")
                .hint("write a decimal point: 12.5 and not 12,5"),
            Err(_) => Problem::wrong_type("this is not a number")
                .hint("write the bare number; the unit is in the column's name"),
        };
        let allowed = match (self.allowed, whole) {
            ("", true) => format!("a whole number from {}", range.in_unit("-")),
            ("", false) => range.in_unit(unit_of(&self.name)).to_string(),
            (words, _) => words.to_owned(),
        };
        Err(match self.hint {
            "" => problem.allowed(allowed),
            hint => problem.allowed(allowed).hint(hint),
        })
    }
}

/// What a table may hold.
#[derive(Clone, Debug)]
pub struct Schema {
    /// All columns.
    pub columns: Vec<Column>,
    /// The columns in words where their list would be too long.
    pub names: Cow<'static, str>,
    /// What the table is, if columns that are not known are passed over, and a hint: a file without any known column is something else.
    pub lenient: Option<(&'static str, &'static str)>,
    /// Largest number of rows, and what helps beyond it.
    pub max_rows: (usize, &'static str),
    /// Largest number of values: rows times columns.
    pub max_values: usize,
    /// The rows in words.
    pub rows: &'static str,
}

impl Default for Schema {
    fn default() -> Self {
        Schema {
            columns: Vec::new(),
            names: "".into(),
            lenient: None,
            max_rows: (usize::MAX, ""),
            max_values: usize::MAX,
            rows: "at least one row",
        }
    }
}

impl Schema {
    /// The columns of a file, as indices of the schema, in the order of the file, and the fields of their names; `None` for a column that
    /// is not known. Without a value where the rows cannot be understood.
    pub(super) fn header(
        &self,
        line: Line<'_>,
        problems: &mut Collector<'_>,
    ) -> Option<(Vec<Option<usize>>, Vec<Field>)> {
        let fields = problems.names(line)?;
        if fields
            .iter()
            .all(|f| line.text_of(*f).parse::<f64>().is_ok())
        {
            problems.line(line, "", || {
                let example: Vec<&str> = self.firsts().filter(|c| c.required).map(name).collect();
                Problem::missing("the first line has numbers and no column names").hint(format!(
                    "put the names above the numbers, for example {}",
                    example.join(",")
                ))
            });
            return None;
        }
        let mut found = Vec::with_capacity(fields.len());
        let mut meant = Vec::new();
        for &field in &fields {
            let index = self.column(line, field, &found, &mut meant, problems);
            found.push(index);
        }
        if let Some((title, hint)) = self.lenient
            && found.iter().all(Option::is_none)
        {
            problems.line(line, "", || {
                Problem::missing(format!("this is no {title}: it has none of its columns"))
                    .allowed(self.all())
                    .hint(hint)
            });
            return None;
        }
        self.require(line, &found, &meant, problems);
        Some((found, fields))
    }

    fn column<'s>(
        &'s self,
        line: Line<'_>,
        field: Field,
        found: &[Option<usize>],
        meant: &mut Vec<&'s str>,
        problems: &mut Collector<'_>,
    ) -> Option<usize> {
        let text = line.text_of(field);
        let Some(index) = self.columns.iter().position(|known| known.name == text) else {
            if self.lenient.is_none() {
                let close = near(text, self.read().map(name));
                problems.value(line, field, text, || self.unknown(text, &close));
                meant.extend(close);
            }
            return None;
        };
        let own = &self.columns[index];
        let known = found.iter().flatten().map(|k| &self.columns[*k]);
        let Some(first) = known.into_iter().find(|other| other.is_same(own)) else {
            return Some(index);
        };
        problems.value(line, field, text, || {
            if first.name == own.name {
                Problem::duplicate("duplicate column").allowed("each column once")
            } else {
                Problem::conflict(format!("{text} and {} say the same thing", first.name))
                    .names_key()
                    .allowed("one of them")
            }
            .hint("remove one of them")
        });
        None
    }

    /// Reports missing columns, but not those that an unknown name may have meant.
    fn require(
        &self,
        line: Line<'_>,
        found: &[Option<usize>],
        meant: &[&str],
        problems: &mut Collector<'_>,
    ) {
        for own in self.firsts() {
            let same = || self.columns.iter().filter(|other| other.is_same(own));
            let is_there = found
                .iter()
                .flatten()
                .any(|k| self.columns[*k].is_same(own));
            if own.required && !is_there && !same().any(|c| meant.contains(&name(c))) {
                problems.line(line, &own.name, || {
                    let names: Vec<&str> = same().map(name).collect();
                    Problem::missing(format!("the column {} is missing", names.join(" or ")))
                        .names_key()
                        .allowed(self.all())
                        .hint("add it; the unit is in the name")
                });
            }
        }
    }

    /// The first column of every group, and those of none.
    fn firsts(&self) -> impl Iterator<Item = &Column> {
        let columns = self.columns.iter().enumerate();
        let is_first = |k: usize, own: &Column| !self.columns[..k].iter().any(|c| c.is_same(own));
        columns.filter_map(move |(k, own)| is_first(k, own).then_some(own))
    }

    fn read(&self) -> impl Iterator<Item = &Column> {
        self.columns.iter().filter(|c| c.cells != Cells::Ignored)
    }

    /// The names of all columns that are read, or words for them.
    fn all(&self) -> String {
        if self.names.is_empty() {
            self.read().map(name).collect::<Vec<_>>().join(", ")
        } else {
            self.names.to_string()
        }
    }

    fn unknown(&self, text: &str, close: &[&str]) -> Problem {
        let without_unit: Vec<&str> = self
            .read()
            .map(name)
            .filter(|full| {
                full.strip_prefix(text)
                    .is_some_and(|unit| unit.starts_with('_'))
            })
            .collect();
        match without_unit.as_slice() {
            _ if text.is_empty() => Problem::missing("this column has no name")
                .allowed(self.all())
                .hint("remove the comma or name the column"),
            [] => Problem::unknown_key("there is no such column")
                .allowed(self.all())
                .hint(suggestion(close).unwrap_or_else(|| "remove it or rename it".to_owned())),
            [full] => Problem::unknown_key("this column has no unit")
                .allowed(*full)
                .hint(format!("if it is in that unit, name it {full}")),
            several => Problem::unknown_key("this column has no unit")
                .allowed(several.join(", "))
                .hint("name it by its unit"),
        }
    }
}

fn name(column: &Column) -> &str {
    &column.name
}
