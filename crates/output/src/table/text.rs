//! Tables for people: aligned columns without rules, for a terminal of 80 to 100 columns and for `grep`, or Markdown.

use comfy_table::presets::NOTHING;
use comfy_table::{Cell, CellAlignment, ColumnConstraint, ContentArrangement, Table, Width};

use crate::number::fixed;

/// Width of a table; the last column is wrapped beyond it.
pub const WIDTH: u16 = 98;
/// Blanks between two columns.
const GAP: u16 = 2;

/// A table of texts, row by row.
#[derive(Clone, Debug)]
pub struct TextTable {
    right: Vec<bool>,
    rows: Vec<Vec<String>>,
    indent: &'static str,
    min_widths: Vec<usize>,
    width: u16,
}

impl TextTable {
    /// A table with columns aligned right (`r`) or left (`l`).
    ///
    /// ```
    /// use cvtcycle_output::table::TextTable;
    /// let mut table = TextTable::new("lr");
    /// table.row(["belt", "3.25"]);
    /// table.row(["oil pump", "12.50"]);
    /// assert_eq!(table.text(), "belt       3.25\noil pump  12.50\n");
    /// ```
    pub fn new(columns: &str) -> Self {
        TextTable {
            right: columns.bytes().map(|c| c == b'r').collect(),
            rows: Vec::new(),
            indent: "",
            min_widths: Vec::new(),
            width: WIDTH,
        }
    }

    /// Indents all lines by two blanks.
    #[must_use]
    pub fn indented(self) -> Self {
        TextTable {
            indent: "  ",
            ..self
        }
    }

    /// Keeps the leading columns at least this wide, which aligns tables that follow each other.
    #[must_use]
    pub fn min_widths(self, widths: &[usize]) -> Self {
        TextTable {
            min_widths: widths.to_vec(),
            ..self
        }
    }

    /// Adds a row.
    pub fn row<S: Into<String>>(&mut self, cells: impl IntoIterator<Item = S>) {
        self.rows.push(cells.into_iter().map(Into::into).collect());
    }

    /// The lines, for a terminal.
    pub fn text(&self) -> String {
        let mut table = Table::new();
        table.load_style(NOTHING).set_width(self.width);
        table.set_content_arrangement(ContentArrangement::Dynamic);
        for row in &self.rows {
            let cells = row
                .iter()
                .zip(&self.right)
                .map(|(text, right)| match right {
                    true => Cell::new(text).set_alignment(CellAlignment::Right),
                    false => Cell::new(text).set_alignment(CellAlignment::Left),
                });
            table.add_row(cells);
        }
        let last = self.right.len().saturating_sub(1);
        let content = table.column_max_content_widths();
        for (k, column) in table.column_iter_mut().enumerate() {
            column.set_padding((0, if k == last { 0 } else { GAP }));
            if k < last {
                let own = content.get(k).copied().unwrap_or(0);
                let min = self
                    .min_widths
                    .get(k)
                    .map_or(0, |min| u16::try_from(*min).unwrap_or(0));
                let width = Width::Fixed(own.max(min) + GAP);
                column.set_constraint(ColumnConstraint::Absolute(width));
            }
        }
        let lines = table.trim_fmt();
        let lines = lines.lines().map(str::trim_end);
        lines
            .map(|line| format!("{}{line}\n", self.indent))
            .collect()
    }
}

/// A sentence wrapped to the width of the tables, with a mark before its first line.
pub fn wrapped(sentence: &str, mark: &str) -> String {
    let blank = " ".repeat(mark.chars().count());
    let mut table = TextTable::new("l");
    table.width -= u16::try_from(blank.len()).unwrap_or(0);
    table.row([sentence]);
    let text = table.text();
    let marks = [mark].into_iter().chain(std::iter::repeat(blank.as_str()));
    let lines = text.lines().zip(marks);
    lines
        .map(|(line, mark)| format!("{mark}{line}\n"))
        .collect()
}

/// A text cut to a number of characters.
pub fn cut(text: &str, max_len: usize) -> String {
    match text.char_indices().nth(max_len) {
        None => text.to_owned(),
        Some(_) => text.chars().take(max_len - 1).collect::<String>() + "…",
    }
}

/// Heading, alignment and text of an item.
type TextColumn<'a, T> = (String, bool, Box<dyn Fn(&T) -> String + 'a>);

/// Columns of a table for people, whose rows are items of one type.
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
    /// No columns.
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

    /// The lines of the table of some items; none if there are no items.
    pub fn lines<'t>(&self, items: impl IntoIterator<Item = &'t T>) -> String
    where
        T: 't,
    {
        let table = self.table(items);
        match table.rows.len() {
            0 | 1 => String::new(),
            _ => table.text(),
        }
    }

    /// The same, indented.
    pub fn text<'t>(&self, items: impl IntoIterator<Item = &'t T>) -> String
    where
        T: 't,
    {
        let lines = self.lines(items);
        lines.lines().map(|line| format!("  {line}\n")).collect()
    }
}
