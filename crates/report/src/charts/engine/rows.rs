//! Panels of rows: names at the left, bars and marks over a common horizontal axis.

use super::axis::Axis;
use super::chart::{Panel, Shape};
use super::place::{Label, at};
use super::style::{INK, Style, stroke};
use super::svg::{Point, Rect};
use super::text::{Cut, text_width};

/// A panel of `count` rows of a pitch in pixels between an upper left corner and a right edge. Its vertical axis counts the rows from
/// the top: the middle of the first one is at 0.5.
pub(crate) fn rows_panel(
    (left, top): Point,
    right: f64,
    count: usize,
    pitch: f64,
    x: Axis,
) -> Panel {
    const PAD: f64 = 3.0;
    let rows = count.max(1) as f64;
    let rect = Rect::new(left, top, right - left, rows * pitch + 2.0 * PAD);
    let pad = PAD / pitch;
    Panel::new(rect, x, Axis::bare(rows + pad, -pad))
}

/// Left edge of rows with names: as far right as the longest name needs, within reason, pixels.
pub(crate) fn rows_left<'n>(names: impl Iterator<Item = &'n str>, size: f64) -> f64 {
    let widest = names.map(|name| text_width(name, size)).fold(0.0, f64::max);
    (widest + 24.0).clamp(74.0, 302.0)
}

/// Middle of a row on the vertical axis.
pub(crate) fn row_middle(row: usize) -> f64 {
    row as f64 + 0.5
}

impl Panel {
    /// Writes the name of a row to the left of the panel, cut in its middle.
    pub fn row_name(&mut self, row: usize, name: Label) {
        let place = at(f64::NEG_INFINITY, row_middle(row)).shift(-8.0, 4.0);
        let label = Label { at: place, ..name };
        let room = self.rect.left - 16.0;
        self.label(label.end().cut(Cut::Middle, room));
    }

    /// Adds a bar from one value to another between two heights in pixels from the middle of the row.
    pub fn bar(&mut self, row: usize, (from, to): Point, (top, bottom): Point, style: Style) {
        let y = row_middle(row);
        let corners = (at(from, y).shift(0.0, top), at(to, y).shift(0.0, bottom));
        self.add(Shape::Rect(corners.0, corners.1), style.class("bar"));
    }

    /// Adds an interval with end marks, on a pale line that shows it on dark fills too.
    pub fn whisker(&mut self, row: usize, [low, high]: [f64; 2], dy: f64, table_row: usize) {
        let place = |x: f64, more: f64| at(x, row_middle(row)).shift(0.0, dy + more);
        for (stroke, class) in [
            (stroke("#ffffff", 2.25, &[]), ""),
            (stroke(INK, 1.25, &[]), "interval"),
        ] {
            let style = Style::line(stroke).class(class).row(table_row);
            self.add(
                Shape::Segment(place(low, 0.0), place(high, 0.0)),
                style.clone(),
            );
            for x in [low, high] {
                self.add(Shape::Segment(place(x, -3.0), place(x, 3.0)), style.clone());
            }
        }
    }
}
