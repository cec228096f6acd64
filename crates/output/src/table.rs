//! Tables: rows of any type under named columns, written as CSV, JSON, aligned text and Markdown.
//!
//! A table of a file is a list of [`Column`]s, usually made with [`columns!`](crate::columns); its numbers are unrounded. A table for people has
//! [`TextColumns`], which round.
//!
//! ```
//! use cvtcycle_output::columns;
//! use cvtcycle_output::table::{json_row, write_csv};
//! let columns = columns! { (&'static str, f64);
//!     text "part", "", "component", (part, _) => *part;
//!     number "loss_nm", "Nm", "loss, torque at the input shaft", (_, nm) => *nm;
//! };
//! let mut csv = Vec::new();
//! write_csv(&mut csv, &columns, [("belt", 3.25)], &[])?;
//! assert_eq!(csv, b"part,loss_nm\nbelt,3.25\n");
//! assert_eq!(json_row(&columns, &("belt", 3.25)).to_string(), r#"{"part":"belt","loss_nm":3.25}"#);
//! # Ok::<(), std::io::Error>(())
//! ```

mod text;
mod text_columns;
mod write;

pub use text::{TextTable, cut, line_width, paragraphs, set_line_width, wrapped};
pub use text_columns::TextColumns;
pub use write::{CsvWriter, csv_bytes, json_columns, json_row, json_rows, write_csv, write_json};

use std::borrow::Cow;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

use crate::number::{finite, push_exact};
use crate::{Component, Flags};

/// One cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Real number; missing unless finite.
    Number(f64),
    /// A whole number.
    Count(u64),
    /// Words.
    Text(Cow<'static, str>),
    /// Index into the phase names of the cycle, which are passed separately.
    Phase(u16),
    /// A set of flags, written as names joined by `|`.
    Flags(Flags),
    /// Names out of a fixed list, written joined by `|`.
    Names(Vec<&'static str>),
}

impl Cell {
    /// The cell as a number; NaN for words.
    #[inline]
    pub fn number(&self) -> f64 {
        match self {
            Cell::Number(x) => *x,
            Cell::Count(n) => *n as f64,
            Cell::Phase(n) => f64::from(*n),
            Cell::Text(_) | Cell::Flags(_) | Cell::Names(_) => f64::NAN,
        }
    }

    /// Appends the cell as CSV: empty for a missing number or phase.
    pub fn push(&self, text: &mut String, phases: &[String]) {
        match self {
            Cell::Number(x) if !x.is_finite() => {}
            Cell::Number(x) => push_exact(text, *x),
            Cell::Count(n) => text.push_str(&n.to_string()),
            Cell::Text(words) => text.push_str(words),
            Cell::Phase(index) => {
                text.push_str(phases.get(usize::from(*index)).map_or("", String::as_str));
            }
            Cell::Flags(flags) => push_names(text, flags.names()),
            Cell::Names(names) => push_names(text, names.iter().copied()),
        }
    }

    /// Converts the cell to JSON: `null` for a missing number, a list for flags.
    pub fn json(&self) -> Json {
        match self {
            Cell::Number(x) => finite(*x).into(),
            Cell::Count(n) => (*n).into(),
            Cell::Text(words) => (&**words).into(),
            Cell::Phase(_) => Json::Null,
            Cell::Flags(flags) => flags.names().collect(),
            Cell::Names(names) => names.iter().copied().collect(),
        }
    }
}

fn push_names(text: &mut String, names: impl Iterator<Item = &'static str>) {
    for (k, name) in names.enumerate() {
        if k > 0 {
            text.push('|');
        }
        text.push_str(name);
    }
}

/// Keeps the first occurrence of each value, in order.
pub fn distinct<T: PartialEq>(values: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut list = Vec::new();
    for value in values {
        if !list.contains(&value) {
            list.push(value);
        }
    }
    list
}

/// Kind of the cells of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Real numbers; missing unless finite.
    Number,
    /// Whole numbers.
    Count,
    /// Words; an empty one is missing.
    Text,
}

/// Name, unit, meaning and kind of a column.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Head {
    /// Name, ending in its unit where it has one.
    pub name: String,
    /// Unit; empty for words and counts, `-` for plain ratios.
    pub unit: String,
    /// Meaning, one phrase.
    pub doc: String,
    /// Kind of the cells.
    pub kind: Kind,
}

/// Transmissions whose table has a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    /// All.
    Always,
    /// Those with a belt.
    Cvt,
    /// Manual boxes.
    Manual,
    /// Those that have this component.
    Has(Component),
}

impl Scope {
    /// True if a transmission with these components has the column.
    pub fn includes(self, cvt: bool, components: &[Component]) -> bool {
        match self {
            Scope::Always => true,
            Scope::Cvt => cvt,
            Scope::Manual => !cvt,
            Scope::Has(component) => components.contains(&component),
        }
    }
}

/// One column of a table of rows `R`.
pub struct Column<R> {
    /// Name, ending in its unit where it has one.
    pub name: Cow<'static, str>,
    /// Unit; empty for words and counts, `-` for plain ratios.
    pub unit: &'static str,
    /// Meaning, one phrase.
    pub doc: Cow<'static, str>,
    /// Kind of the cells.
    pub kind: Kind,
    /// Transmissions that have the column.
    pub scope: Scope,
    get: Arc<dyn Get<R>>,
}

/// Reads a cell from a row, or the numbers of many rows in one call.
trait Get<R>: Send + Sync {
    fn cell(&self, row: &R) -> Cell;
    fn numbers(&self, rows: &[R], into: &mut Vec<f64>);
}

impl<R, F: Fn(&R) -> Cell + Send + Sync> Get<R> for F {
    fn cell(&self, row: &R) -> Cell {
        self(row)
    }

    fn numbers(&self, rows: &[R], into: &mut Vec<f64>) {
        into.extend(rows.iter().map(|row| self(row).number()));
    }
}

impl<R> Column<R> {
    fn new(
        name: impl Into<Cow<'static, str>>,
        unit: &'static str,
        doc: impl Into<Cow<'static, str>>,
        kind: Kind,
        get: impl Fn(&R) -> Cell + Send + Sync + 'static,
    ) -> Self {
        Column {
            name: name.into(),
            unit,
            doc: doc.into(),
            kind,
            scope: Scope::Always,
            get: Arc::new(get),
        }
    }

    /// A column of real numbers.
    pub fn number(
        name: impl Into<Cow<'static, str>>,
        unit: &'static str,
        doc: impl Into<Cow<'static, str>>,
        get: impl Fn(&R) -> f64 + Send + Sync + 'static,
    ) -> Self {
        let cell = move |row: &R| Cell::Number(get(row));
        Self::new(name, unit, doc, Kind::Number, cell)
    }

    /// A column of numbers that a row may not have.
    pub fn optional(
        name: impl Into<Cow<'static, str>>,
        unit: &'static str,
        doc: impl Into<Cow<'static, str>>,
        get: impl Fn(&R) -> Option<f64> + Send + Sync + 'static,
    ) -> Self {
        Self::number(name, unit, doc, move |row| get(row).unwrap_or(f64::NAN))
    }

    /// A column of whole numbers.
    pub fn count(
        name: impl Into<Cow<'static, str>>,
        unit: &'static str,
        doc: impl Into<Cow<'static, str>>,
        get: impl Fn(&R) -> u64 + Send + Sync + 'static,
    ) -> Self {
        let cell = move |row: &R| Cell::Count(get(row));
        Self::new(name, unit, doc, Kind::Count, cell)
    }

    /// A column of words.
    pub fn text<T: Into<Cow<'static, str>>>(
        name: impl Into<Cow<'static, str>>,
        unit: &'static str,
        doc: impl Into<Cow<'static, str>>,
        get: impl Fn(&R) -> T + Send + Sync + 'static,
    ) -> Self {
        let cell = move |row: &R| Cell::Text(get(row).into());
        Self::new(name, unit, doc, Kind::Text, cell)
    }

    /// A column of other cells that are written as words: phases, flags, names.
    pub fn words(
        name: impl Into<Cow<'static, str>>,
        unit: &'static str,
        doc: impl Into<Cow<'static, str>>,
        get: impl Fn(&R) -> Cell + Send + Sync + 'static,
    ) -> Self {
        Self::new(name, unit, doc, Kind::Text, get)
    }

    /// The column with another scope.
    #[must_use]
    pub fn only(self, scope: Scope) -> Self {
        Column { scope, ..self }
    }

    /// The cell of a row.
    pub fn cell(&self, row: &R) -> Cell {
        self.get.cell(row)
    }

    /// Number of a row; NaN where the cell is not a number.
    pub fn number_of(&self, row: &R) -> f64 {
        self.cell(row).number()
    }

    /// Appends the numbers of many rows.
    pub fn numbers(&self, rows: &[R], into: &mut Vec<f64>) {
        self.get.numbers(rows, into);
    }

    /// Name, unit, meaning and kind.
    pub fn head(&self) -> Head {
        Head {
            name: self.name.clone().into_owned(),
            unit: self.unit.to_owned(),
            doc: self.doc.clone().into_owned(),
            kind: self.kind,
        }
    }
}

impl<R> std::fmt::Debug for Column<R> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} [{}]", self.name, self.unit)
    }
}

impl<R> Clone for Column<R> {
    fn clone(&self) -> Self {
        Column {
            name: self.name.clone(),
            doc: self.doc.clone(),
            get: Arc::clone(&self.get),
            ..*self
        }
    }
}

/// Columns of a table, one a line: `KIND NAME, UNIT, DOC, row => VALUE;`, with `, SCOPE` before the semicolon where not all
/// transmissions have it. KIND is one of `number`, `optional`, `count`, `text` and `words`, the constructors of
/// [`Column`](crate::table::Column).
#[macro_export]
macro_rules! columns {
    ($row:ty; $($kind:ident $name:expr, $unit:expr, $doc:expr, $r:pat => $value:expr $(, $scope:expr)?;)*) => {
        vec![$($crate::table::Column::$kind($name, $unit, $doc, move |$r: &$row| $value)$(.only($scope))?),*]
    };
}
