//! A picture with the numbers behind it: what is drawn can be read as a table, and the table answers what the pointer stands on.

use super::axis::number;

/// A picture and its numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// The drawing. A panel's frame (`class="plot"`) bears `data-x0` and `data-x1`, the values at its left and right edge, where the
    /// first column of the table is its horizontal axis; every other mark bears `data-row`, the index of its row.
    pub svg: String,
    /// The numbers.
    pub table: PictureTable,
}

/// The numbers of a picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PictureTable {
    /// Name and unit of each column; no unit for words and plain numbers.
    pub columns: Vec<(String, &'static str)>,
    /// Cells, row by row, as they are shown.
    pub rows: Vec<Vec<String>>,
    /// What a reader has to know of the table, such as which rows are left out; may be empty.
    pub note: String,
}

impl PictureTable {
    /// A table of columns.
    #[must_use]
    pub fn new(columns: &[(&str, &'static str)]) -> Self {
        PictureTable {
            columns: columns
                .iter()
                .map(|(name, unit)| ((*name).to_owned(), *unit))
                .collect(),
            ..PictureTable::default()
        }
    }

    /// Adds a row and returns its index, for `data-row`.
    pub fn push(&mut self, cells: Vec<String>) -> usize {
        self.rows.push(cells);
        self.rows.len() - 1
    }
}

/// A number for a cell, with as many decimals as `step` between neighbours needs; empty where there is none.
#[must_use]
pub fn cell(value: f64, step: f64) -> String {
    if value.is_finite() {
        number(value, step)
    } else {
        String::new()
    }
}
