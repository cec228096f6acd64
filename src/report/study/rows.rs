//! Rows of names with bars beside them, over a common horizontal axis.

use super::super::axis::Axis;
use super::super::figure::{Figure, INK, Rect, text_width};
use super::super::legend::Mark;
use super::super::panel::{BELOW, LEFT, Panel};
use super::text::{SIZE, Side, entries, entries_height, name, notes, notes_height};

/// Height of a row, pixels.
pub(super) const ROW: f64 = 27.0;
/// Width of the plotting area, pixels.
pub(super) const WIDE: f64 = 460.0;
const TOP: f64 = 58.0;
const STRIP: f64 = 230.0;
/// Widest names, pixels.
const NAMES: f64 = 280.0;

/// What stands around the rows.
pub(super) struct Frame<'a> {
    pub title: String,
    pub subject: &'a str,
    pub desc: String,
    pub x: Axis,
    pub names: Vec<&'a str>,
    pub entries: [&'a str; 2],
    pub notes: Vec<String>,
}

/// Rows in their place.
pub(super) struct Rows {
    pub figure: Figure,
    pub panel: Panel,
}

impl Rows {
    /// Draws axes, names, legend and notes. `paints` makes the marks of the legend, whose patterns have to be defined first.
    pub fn new(frame: Frame, paints: impl FnOnce(&mut Figure) -> Vec<Mark>) -> Self {
        let widest = frame.names.iter().map(|name| text_width(name, SIZE)).fold(0.0, f64::max).min(NAMES);
        let left = (12.0 + widest + 10.0).max(LEFT + 8.0);
        let rows = frame.names.len().max(2) as f64;
        let rect = Rect { left, top: TOP, right: left + WIDE, bottom: TOP + rows * ROW + 6.0 };
        let beside = (rect.right + 18.0, STRIP - 8.0);
        let legend_end = TOP + entries_height(2) + 10.0;
        let notes_end = legend_end + notes_height(&frame.notes, beside.1) + 6.0;
        let size = (rect.right + 18.0 + STRIP, (rect.bottom + BELOW + 6.0).max(notes_end));
        let mut figure = Figure::new(size, 12.0, &frame.title, frame.subject, &frame.desc);
        let mut y = Axis::exact("", 0.0, 1.0, 2);
        // Rows have names in place of numbers.
        y.ticks.clear();
        let panel = Panel::draw(&mut figure, rect, frame.x, y, true);
        let marks = paints(&mut figure);
        for (k, row) in frame.names.iter().enumerate() {
            let at = (left - 8.0, middle_of(&panel, k) + 4.0);
            name(&mut figure, at, Side::Left, (SIZE, left - 8.0 - 8.0), "class=\"row\"", row);
        }
        entries(&mut figure, (beside.0, TOP), beside.1, marks.into_iter().zip(frame.entries).collect());
        notes(&mut figure, (beside.0, legend_end), beside.1, &frame.notes);
        if frame.names.is_empty() {
            panel.empty(&mut figure);
        }
        Rows { figure, panel }
    }

    /// Height of the middle of a row, pixels.
    pub fn middle(&self, row: usize) -> f64 {
        middle_of(&self.panel, row)
    }

    /// A vertical line over all rows at a value.
    pub fn mark(&mut self, x: f64) {
        let (x, rect) = (self.panel.px(x), self.panel.rect);
        if rect.left <= x && x <= rect.right {
            self.figure.line((x, rect.top), (x, rect.bottom), &format!("stroke=\"{INK}\" stroke-width=\"4\""));
        }
    }

    /// A bar from one value to another between two heights; none where a value is not finite.
    pub fn bar(&mut self, (from, to): (f64, f64), (top, bottom): (f64, f64), paint: &str) {
        if !from.is_finite() || !to.is_finite() {
            return;
        }
        let (a, b) = (self.panel.px(from), self.panel.px(to));
        let rect = Rect { left: a.min(b), right: a.max(b), top, bottom };
        self.figure.rect(rect, &format!("class=\"bar\" fill=\"{paint}\" stroke=\"{INK}\" stroke-width=\"2\""));
    }

    /// An interval with end marks, on a pale line that shows it on dark fills too.
    pub fn whisker(&mut self, [low, high]: [f64; 2], y: f64) {
        let (a, b) = (self.panel.px(low), self.panel.px(high));
        for paint in ["stroke=\"#ffffff\" stroke-width=\"9\"", "class=\"interval\" stroke=\"#000000\" stroke-width=\"5\""] {
            self.figure.line((a, y), (b, y), paint);
            for x in [a, b] {
                self.figure.line((x, y - 3.0), (x, y + 3.0), paint);
            }
        }
    }

    /// The document.
    pub fn finish(mut self) -> String {
        self.panel.outline(&mut self.figure);
        self.figure.finish()
    }
}

fn middle_of(panel: &Panel, row: usize) -> f64 {
    panel.rect.top + 3.0 + (row as f64 + 0.5) * ROW
}
