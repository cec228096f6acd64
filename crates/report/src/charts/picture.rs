//! A picture with the table of its numbers, which also fills the box under the pointer.

/// A picture and its numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// The drawing. Where the first column of the table is the horizontal axis of a panel, its frame (`class="plot"`) has `data-x0` and
    /// `data-x1`, the values at its left and right edge; every other mark has `data-row`, the index of its row.
    pub svg: String,
    /// The numbers.
    pub table: PictureTable,
}

/// The numbers of a picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PictureTable {
    /// Name and unit of each column; no unit for words and plain numbers.
    pub columns: Vec<(String, &'static str)>,
    /// Cells as they are shown, row by row.
    pub rows: Vec<Vec<String>>,
    /// Remark on the table, such as which rows are left out; may be empty.
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

    /// A table with names and units of its columns that are made at run time, and a note.
    #[must_use]
    pub fn with_columns(columns: Vec<(String, &'static str)>, note: String) -> Self {
        PictureTable {
            columns,
            note,
            ..PictureTable::default()
        }
    }

    /// Adds a row and returns its index, for `data-row`.
    pub fn push(&mut self, cells: Vec<String>) -> usize {
        self.rows.push(cells);
        self.rows.len() - 1
    }
}
