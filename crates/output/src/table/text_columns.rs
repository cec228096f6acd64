//! A text table as a list of columns: heading, alignment and the text of an item.

use super::text::TextTable;
use crate::number::fixed;

/// Heading, alignment and text of an item.
type TextColumn<'a, T> = (String, bool, Box<dyn Fn(&T) -> String + 'a>);

/// Columns of a table for people; each row is an item of one type.
///
/// ```
/// use cvtcycle_output::table::TextColumns;
/// let columns = TextColumns::new()
///     .left("part", |row: &(&str, f64)| row.0)
///     .number("Nm", 2, |row| row.1);
/// assert_eq!(columns.text(&[("belt", 3.25), ("pump", 12.5)]), "  part     Nm\n  belt   3.25\n  pump  12.50\n");
/// ```
pub struct TextColumns<'a, T>(Vec<TextColumn<'a, T>>);

impl<T> Default for TextColumns<'_, T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<'a, T> TextColumns<'a, T> {
    /// Creates an empty list of columns.
    pub fn new() -> Self {
        TextColumns(Vec::new())
    }

    /// Adds a column aligned left.
    pub fn left<S: Into<String>>(
        self,
        head: impl Into<String>,
        get: impl Fn(&T) -> S + 'a,
    ) -> Self {
        self.with(head.into(), false, move |item| get(item).into())
    }

    /// Adds a column aligned right.
    pub fn right<S: Into<String>>(
        self,
        head: impl Into<String>,
        get: impl Fn(&T) -> S + 'a,
    ) -> Self {
        self.with(head.into(), true, move |item| get(item).into())
    }

    /// Adds a column of numbers with fixed decimals.
    pub fn number<X: Into<Option<f64>>>(
        self,
        head: impl Into<String>,
        decimals: usize,
        get: impl Fn(&T) -> X + 'a,
    ) -> Self {
        self.with(head.into(), true, move |item| fixed(get(item), decimals))
    }

    fn with(mut self, head: String, right: bool, get: impl Fn(&T) -> String + 'a) -> Self {
        self.0.push((head, right, Box::new(get)));
        self
    }

    /// The table of some items, with its headings.
    pub fn table<'t>(&self, items: impl IntoIterator<Item = &'t T>) -> TextTable
    where
        T: 't,
    {
        let sides = self
            .0
            .iter()
            .map(|(_, right, _)| if *right { 'r' } else { 'l' });
        let mut table = TextTable::new(&sides.collect::<String>());
        table.row(self.0.iter().map(|(head, ..)| head));
        for item in items {
            table.row(self.0.iter().map(|(_, _, get)| get(item)));
        }
        table
    }

    /// Formats the table of some items; empty if there are no items.
    pub fn lines<'t>(&self, items: impl IntoIterator<Item = &'t T>) -> String
    where
        T: 't,
    {
        self.table(items).unless_empty()
    }

    /// Formats the table of some items, indented.
    pub fn text<'t>(&self, items: impl IntoIterator<Item = &'t T>) -> String
    where
        T: 't,
    {
        self.table(items).indented().unless_empty()
    }
}
