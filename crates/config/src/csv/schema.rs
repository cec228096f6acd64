//! The columns that a table may have, as data, and the checks of its line of column names.

use std::borrow::Cow;

use super::dialect::with_point;
use super::heading::Foreign;
use super::named::Columns;
use crate::channel::bare;
use crate::{Bound, Problem, Setting, suggestion, unit_of};

/// Content of the cells of a column.
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
    /// Name in the file.
    pub name: Cow<'static, str>,
    /// Content of the cells.
    pub cells: Cells,
    /// A table has just one column of a group; each column without a group is one of its own.
    pub group: &'static str,
    /// True if the table has to have the column, or another one of its group.
    pub required: bool,
    /// Columns, or names of another program, with one of which a table needs no [`Column::required`] one.
    pub unless: &'static [&'static str],
    /// True if a cell may be empty.
    pub may_be_empty: bool,
    /// Accepted cells in words, in place of the range.
    pub allowed: &'static str,
    /// Hint for a bad cell, in place of the general ones.
    pub hint: &'static str,
    /// True if it is a column of its group in another unit, which lists of the columns leave out.
    pub is_alias: bool,
    /// True of a column that says something of the value of a table, and spans no axis of its grid.
    pub is_extra: bool,
    /// True if it is passed over where the table has another column of its group that is none.
    pub is_spare: bool,
}

impl Column {
    /// An optional column.
    pub fn new(name: impl Into<Cow<'static, str>>, cells: Cells) -> Self {
        Column {
            name: name.into(),
            cells,
            group: "",
            required: false,
            unless: &[],
            may_be_empty: false,
            allowed: "",
            hint: "",
            is_alias: false,
            is_extra: false,
            is_spare: false,
        }
    }

    /// The column is passed over where the table has another one of its group that is none.
    #[must_use]
    pub fn spare(self) -> Self {
        Column {
            is_spare: true,
            ..self
        }
    }

    /// The column says something of the value of a table.
    #[must_use]
    pub fn extra(self) -> Self {
        Column {
            is_extra: true,
            ..self
        }
    }

    /// The column is one in another unit.
    #[must_use]
    pub fn alias(self) -> Self {
        Column {
            is_alias: true,
            ..self
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

    /// The table has to have it, or one of these columns or names of another program.
    #[must_use]
    pub fn required_unless(self, unless: &'static [&'static str]) -> Self {
        Column {
            unless,
            ..self.required()
        }
    }

    /// Allows empty cells.
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

    /// True if a table has just one of the two.
    pub(crate) fn is_same(&self, other: &Column) -> bool {
        self.name == other.name || !self.group.is_empty() && self.group == other.group
    }

    /// The number in a cell, with a decimal comma or a decimal point.
    pub(super) fn parse(&self, text: &str, decimal_comma: bool) -> Result<f64, Problem> {
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
        let number = match decimal_comma && text.contains(',') {
            true if text.contains('.') => None,
            true => with_point(text).parse::<f64>().ok(),
            // A point in one of them may be a sign between thousands.
            false if decimal_comma && text.contains('.') => None,
            false => text.parse::<f64>().ok(),
        };
        let problem = match number {
            // turns -0 into 0
            Some(x) if range.contains(x) && is_whole(x) => return Ok(x + 0.0),
            Some(x) if x.is_nan() => Problem::wrong_type("this is not a number").hint(gap),
            Some(x) if x.is_infinite() => {
                Problem::out_of_range("this is not a finite number").hint(gap)
            }
            Some(x) if !is_whole(x) => {
                Problem::wrong_type("this is not a whole number").hint("write it without decimals")
            }
            Some(_) => Problem::out_of_range("this value is out of range").hint(
                match unit_of(&self.name) {
                    "-" => "",
                    _ => "the unit is in the column's name",
                },
            ),
            None if text.is_empty() => Problem::missing("the value is missing").hint(gap),
            None if decimal_comma && text.contains('.') => Problem::wrong_type(
                "this is not a number",
            )
            .hint("the file has decimal commas: write 12,5, without a sign between thousands"),
            None if !decimal_comma && text.contains(',') => {
                Problem::wrong_type("this is not a number")
                    .hint("write a decimal point: 12.5 and not 12,5")
            }
            None => Problem::wrong_type("this is not a number")
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

/// Allowed content of a table.
#[derive(Clone, Debug)]
pub struct Schema {
    /// All columns.
    pub columns: Vec<Column>,
    /// The columns in words where their list would be too long.
    pub names: Cow<'static, str>,
    /// Name of the table and a hint, if unknown columns are ignored: a file without any known column is something else.
    pub lenient: Option<(&'static str, &'static str)>,
    /// Largest number of rows, and what helps beyond it.
    pub max_rows: (usize, &'static str),
    /// Largest number of values: rows times columns.
    pub max_values: usize,
    /// The rows in words.
    pub rows: &'static str,
    /// Names of the columns in the tables of other programs.
    pub foreign: Foreign,
    /// Columns as named by the user; empty if the names of the file decide. With `None` the user cannot name them.
    pub named: Option<Columns>,
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
            foreign: Foreign::default(),
            named: None,
        }
    }
}

impl Schema {
    /// The first column of every group, and those of none.
    pub(super) fn firsts(&self) -> impl Iterator<Item = &Column> {
        let columns = self.columns.iter().enumerate();
        let is_first = |k: usize, own: &Column| !self.columns[..k].iter().any(|c| c.is_same(own));
        columns.filter_map(move |(k, own)| is_first(k, own).then_some(own))
    }

    pub(super) fn read(&self) -> impl Iterator<Item = &Column> {
        self.columns.iter().filter(|c| c.cells != Cells::Ignored)
    }

    /// Columns that lists have.
    pub(super) fn listed(&self) -> impl Iterator<Item = &Column> {
        self.read().filter(|column| !column.is_alias)
    }

    /// The names of all columns that are read, or words for them.
    pub(super) fn all(&self) -> String {
        if self.names.is_empty() {
            self.listed().map(name).collect::<Vec<_>>().join(", ")
        } else {
            self.names.to_string()
        }
    }

    /// A name that is none of the columns'.
    pub(super) fn unknown(&self, text: &str, close: &[&str]) -> Problem {
        let word = self.foreign.own_word(bare(text));
        let is_unit = |full: &&str| {
            full.strip_prefix(&*word)
                .is_some_and(|unit| unit.starts_with('_'))
        };
        let without_unit: Vec<&str> = self.read().map(name).filter(is_unit).collect();
        match without_unit.as_slice() {
            _ if text.is_empty() => Problem::missing("this column has no name")
                .allowed(self.all())
                .hint("remove the comma or name the column"),
            [] => {
                let problem = Problem::unknown_key("there is no such column").allowed(self.all());
                match suggestion(close) {
                    Some(question) => problem.hint(question),
                    None if self.named.is_some() => problem
                        .hint("remove it, rename it, or say which columns are meant")
                        .settings(&[Setting::Columns]),
                    None => problem.hint("remove it or rename it"),
                }
            }
            [full] => Problem::unknown_key("this column has no unit")
                .allowed(*full)
                .hint(format!("if it is in that unit, name it {full}")),
            several => Problem::unknown_key("this column has no unit")
                .allowed(several.join(", "))
                .hint("name it by its unit"),
        }
    }
}

/// The name of a column.
pub(super) fn name(column: &Column) -> &str {
    &column.name
}
