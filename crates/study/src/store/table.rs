//! Columns and rows of a study as they are kept in memory, by column: one part of a table at a time.

use std::sync::Arc;

pub use cvtcycle_output::table::{Head, Kind};

/// Cells of a column.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// See [`Kind::Number`].
    Number(Vec<f64>),
    /// See [`Kind::Count`].
    Count(Vec<i64>),
    /// See [`Kind::Text`].
    Text(Vec<Arc<str>>),
}

impl Values {
    /// An empty column of a kind with room for a number of cells.
    pub fn with_capacity(kind: Kind, cells: usize) -> Self {
        match kind {
            Kind::Number => Values::Number(Vec::with_capacity(cells)),
            Kind::Count => Values::Count(Vec::with_capacity(cells)),
            Kind::Text => Values::Text(Vec::with_capacity(cells)),
        }
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        match self {
            Values::Number(v) => v.len(),
            Values::Count(v) => v.len(),
            Values::Text(v) => v.len(),
        }
    }

    /// True if there are no cells.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Type of the cells.
    pub fn kind(&self) -> Kind {
        match self {
            Values::Number(_) => Kind::Number,
            Values::Count(_) => Kind::Count,
            Values::Text(_) => Kind::Text,
        }
    }

    /// Appends the cells of another column of the same kind.
    fn append(&mut self, other: &mut Values) {
        match (self, other) {
            (Values::Number(into), Values::Number(cells)) => into.append(cells),
            (Values::Count(into), Values::Count(cells)) => into.append(cells),
            (Values::Text(into), Values::Text(cells)) => into.append(cells),
            _ => debug_assert!(false, "columns of two kinds"),
        }
    }

    fn clear(&mut self) {
        match self {
            Values::Number(cells) => cells.clear(),
            Values::Count(cells) => cells.clear(),
            Values::Text(cells) => cells.clear(),
        }
    }
}

/// Some rows of a table: the cells of every column, all of one length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rows {
    /// By column, in the order of the heads.
    pub values: Vec<Values>,
}

impl Rows {
    /// No rows yet, with room for a number of them.
    pub fn with_capacity(columns: &[Head], rows: usize) -> Self {
        Rows {
            values: columns
                .iter()
                .map(|column| Values::with_capacity(column.kind, rows))
                .collect(),
        }
    }

    /// Drops all rows and keeps the room.
    pub fn clear(&mut self) {
        self.values.iter_mut().for_each(Values::clear);
    }

    /// Moves the rows of a table with the same columns behind its own.
    pub fn append(&mut self, mut other: Rows) {
        for (into, cells) in self.values.iter_mut().zip(&mut other.values) {
            into.append(cells);
        }
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.values.first().map_or(0, Values::len)
    }

    /// True if there are no rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
