//! Tables of plain text: aligned columns, no rules, fit for a terminal of 80 to 100 columns and for `grep`.

use comfy_table::presets::NOTHING;
use comfy_table::{Cell, CellAlignment, ColumnConstraint, ContentArrangement, Table, Width};

/// Width that tables keep to where they can; beyond it the last column is wrapped.
pub const WIDTH: u16 = 98;

/// A table in the making.
#[derive(Debug)]
pub struct Grid {
    table: Table,
    right: Vec<bool>,
    indent: &'static str,
}

impl Grid {
    /// A table with columns set flush right (`r`) or left (`l`).
    pub fn new(columns: &str) -> Self {
        let mut table = Table::new();
        table
            .load_style(NOTHING)
            .set_content_arrangement(ContentArrangement::Dynamic)
            .set_width(WIDTH);
        Grid {
            table,
            right: columns.bytes().map(|c| c == b'r').collect(),
            indent: "",
        }
    }

    /// Sets all lines in.
    pub fn indented(mut self) -> Self {
        self.indent = "  ";
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

    /// Keeps the leading columns at least this wide, so that tables under each other line up.
    pub fn text_with_widths(self, widths: &[usize]) -> String {
        self.arrange(widths)
    }

    /// The text, with a line end.
    pub fn text(self) -> String {
        self.arrange(&[])
    }

    fn arrange(mut self, least: &[usize]) -> String {
        let last = self.right.len().saturating_sub(1);
        let content = self.table.column_max_content_widths();
        for (k, column) in self.table.column_iter_mut().enumerate() {
            column.set_padding((0, if k == last { 0 } else { 2 }));
            if k < last {
                let own = content.get(k).copied().unwrap_or(0);
                let floor = least
                    .get(k)
                    .and_then(|w| u16::try_from(*w).ok())
                    .unwrap_or(0);
                column.set_constraint(ColumnConstraint::Absolute(Width::Fixed(own.max(floor) + 2)));
            }
        }
        let mut text = String::new();
        for line in self.table.trim_fmt().lines() {
            text.push_str(self.indent);
            text.push_str(line.trim_end());
            text.push('\n');
        }
        text
    }
}
