//! A picture with the table of its numbers, which also fills its tooltips.

use crate::number::with_unit;
use std::fmt;
use std::sync::Arc;

/// A picture and its numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// The drawing. Where the first column of the table is the horizontal axis of a panel, its frame (`class="plot"`) has `data-x0` and
    /// `data-x1`, the values at its left and right edge; every other mark has `data-row`, the index of its row.
    pub svg: String,
    /// The drawing for a narrow screen, made where it is wanted.
    pub narrow: Narrow,
    /// The numbers.
    pub table: PictureTable,
}

/// Draws a picture for a narrow screen; none where that cannot be.
type Draw = dyn Fn() -> Option<String> + Send + Sync;

/// The drawing of a picture for a narrow screen, by what drew the picture: pictures know no chart.
#[derive(Clone, Default)]
pub struct Narrow(Option<Arc<Draw>>);

impl Narrow {
    /// A drawing that is made by this.
    pub(super) fn by(draw: impl Fn() -> Option<String> + Send + Sync + 'static) -> Self {
        Narrow(Some(Arc::new(draw)))
    }

    /// The picture for a narrow screen; `None` for one that is drawn in pixels.
    #[must_use]
    pub fn svg(&self) -> Option<String> {
        self.0.as_ref().and_then(|draw| draw())
    }
}

impl fmt::Debug for Narrow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Narrow").field(&self.0.is_some()).finish()
    }
}

/// Pictures of the same drawing are the same.
impl PartialEq for Narrow {
    fn eq(&self, _: &Self) -> bool {
        true
    }
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

/// Maximum number of rows and cells listed in the picture in words.
const MAX_LISTED: (usize, usize) = (12, 50);
/// Maximum number of columns whose span is listed there.
pub(crate) const MAX_SPANS: usize = 6;

impl PictureTable {
    /// A table of columns.
    pub fn new(columns: &[(&str, &'static str)]) -> Self {
        let column = |(name, unit): &(&str, &'static str)| ((*name).to_owned(), *unit);
        PictureTable {
            columns: columns.iter().map(column).collect(),
            ..PictureTable::default()
        }
    }

    /// A table whose names and units are known only at run time.
    pub fn with_columns(columns: impl IntoIterator<Item = (String, &'static str)>) -> Self {
        PictureTable {
            columns: columns.into_iter().collect(),
            ..PictureTable::default()
        }
    }

    /// Adds a remark.
    #[must_use]
    pub fn note(mut self, note: impl Into<String>) -> Self {
        self.note = note.into();
        self
    }

    /// Adds a row and returns its index, for `data-row`.
    pub fn push(&mut self, cells: impl IntoIterator<Item = String>) -> usize {
        self.rows.push(cells.into_iter().collect());
        self.rows.len() - 1
    }

    /// Numbers of a column with their cells; `None` if it holds words, or nothing.
    pub(crate) fn numbers(&self, column: usize) -> Option<Vec<(f64, &str)>> {
        let cells = self.rows.iter().filter_map(|row| row.get(column));
        let cells = cells.filter(|cell| !cell.is_empty());
        let number = |cell: &String| cell.replace('\u{2212}', "-").parse().ok();
        let numbers: Option<Vec<_>> = cells.map(|cell| Some((number(cell)?, &**cell))).collect();
        numbers.filter(|list| !list.is_empty())
    }

    /// "Torque [Nm] from 2 to 11", over some columns; `None` if they hold words, or nothing.
    pub(crate) fn span(&self, name: &str, columns: &[usize]) -> Option<String> {
        let numbers = columns.iter().filter_map(|column| self.numbers(*column));
        let numbers: Vec<(f64, &str)> = numbers.flatten().collect();
        let low = numbers.iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
        let high = numbers.iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(format!("{name} from {} to {}", low.1, high.1))
    }

    /// Formats the numbers in words: the rows of a short table, the spans of the first columns of a long one.
    pub(crate) fn in_words(&self) -> String {
        let heads = self.columns.iter();
        let heads: Vec<String> = heads.map(|(name, unit)| with_unit(name, unit)).collect();
        let rows = self.rows.len();
        if rows == 0 {
            return String::new();
        }
        if rows <= MAX_LISTED.0 && rows * heads.len() <= MAX_LISTED.1 {
            let rows: Vec<String> = self.rows.iter().map(|row| row.join(", ")).collect();
            return format!("{}: {}", heads.join(", "), rows.join("; "));
        }
        let spans = heads.iter().enumerate();
        let spans = spans.filter_map(|(k, head)| self.span(head, &[k]));
        spans.take(MAX_SPANS).collect::<Vec<_>>().join("; ")
    }
}
