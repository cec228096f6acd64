//! Tables of plain text: aligned columns without rules, for a terminal of 80 to 100 columns and for `grep`.

use comfy_table::presets::NOTHING;
use comfy_table::{Cell, CellAlignment, ColumnConstraint, ContentArrangement, Table, Width};

/// Width of a table; the last column is wrapped beyond it.
pub const WIDTH: u16 = 98;

/// A table of texts, row by row.
#[derive(Debug)]
pub struct TextTable {
    table: Table,
    right: Vec<bool>,
    indent: &'static str,
    min_widths: Vec<usize>,
}

impl TextTable {
    /// A table with columns aligned right (`r`) or left (`l`).
    pub fn new(columns: &str) -> Self {
        let mut table = Table::new();
        table
            .load_style(NOTHING)
            .set_content_arrangement(ContentArrangement::Dynamic)
            .set_width(WIDTH);
        TextTable {
            table,
            right: columns.bytes().map(|c| c == b'r').collect(),
            indent: "",
            min_widths: Vec::new(),
        }
    }

    /// Indents all lines.
    pub fn indented(mut self) -> Self {
        self.indent = "  ";
        self
    }

    /// Keeps the leading columns at least this wide, which aligns tables that follow each other.
    pub fn min_widths(mut self, widths: &[usize]) -> Self {
        self.min_widths = widths.to_vec();
        self
    }

    /// Another width than [`WIDTH`].
    pub fn width(mut self, width: usize) -> Self {
        self.table.set_width(u16::try_from(width).unwrap_or(WIDTH));
        self
    }

    /// Adds a row.
    pub fn row<S: AsRef<str>>(&mut self, cells: impl IntoIterator<Item = S>) {
        let cells = cells.into_iter().zip(&self.right).map(|(text, right)| {
            let side = if *right {
                CellAlignment::Right
            } else {
                CellAlignment::Left
            };
            Cell::new(text.as_ref()).set_alignment(side)
        });
        self.table.add_row(cells.collect::<Vec<_>>());
    }

    /// The lines.
    pub fn text(mut self) -> String {
        let last = self.right.len().saturating_sub(1);
        let content = self.table.column_max_content_widths();
        for (k, column) in self.table.column_iter_mut().enumerate() {
            column.set_padding((0, if k == last { 0 } else { 2 }));
            if k < last {
                let own = content.get(k).copied().unwrap_or(0);
                let min = self.min_widths.get(k).copied().unwrap_or(0);
                let width = own.max(u16::try_from(min).unwrap_or(0)) + 2;
                column.set_constraint(ColumnConstraint::Absolute(Width::Fixed(width)));
            }
        }
        let lines = self.table.trim_fmt();
        let lines = lines.lines().map(|line| (self.indent, line.trim_end()));
        lines
            .map(|(indent, line)| format!("{indent}{line}\n"))
            .collect()
    }
}

type GetText<'a, T> = Box<dyn Fn(&T) -> String + 'a>;

/// Columns of a table whose rows are items of one type: heading, alignment, text of an item.
pub struct TextColumns<'a, T>(Vec<(String, bool, GetText<'a, T>)>);

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
        self.with(head.into(), false, get)
    }

    /// Adds a column aligned right.
    pub fn right<S: Into<String>>(
        self,
        head: impl Into<String>,
        get: impl Fn(&T) -> S + 'a,
    ) -> Self {
        self.with(head.into(), true, get)
    }

    fn with<S: Into<String>>(
        mut self,
        head: String,
        right: bool,
        get: impl Fn(&T) -> S + 'a,
    ) -> Self {
        self.0
            .push((head, right, Box::new(move |item| get(item).into())));
        self
    }

    /// The table of some items, with its headings.
    pub fn table<'t>(&self, items: impl IntoIterator<Item = &'t T>) -> TextTable
    where
        T: 't,
    {
        let side = |(_, right, _): &(String, bool, GetText<'a, T>)| if *right { 'r' } else { 'l' };
        let mut table = TextTable::new(&self.0.iter().map(side).collect::<String>());
        table.row(self.0.iter().map(|(head, ..)| head));
        for item in items {
            table.row(self.0.iter().map(|(_, _, get)| get(item)));
        }
        table
    }
}

/// A text cut to a number of characters.
pub fn cut(text: &str, max_len: usize) -> String {
    if text.chars().count() <= max_len {
        text.to_owned()
    } else {
        text.chars().take(max_len - 1).collect::<String>() + "…"
    }
}
