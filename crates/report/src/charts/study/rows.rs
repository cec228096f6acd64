//! Rows of names with bars beside them, over a common horizontal axis.

use super::super::axis::Axis;
use super::super::figure::{Figure, INK, Rect, text_width};
use super::super::legend::Mark;
use super::super::panel::{BELOW, LEFT, Panel};
use super::super::picture::{Picture, PictureTable};
use super::text::{SIZE, Side, foot, foot_height, name};
use super::{RIGHT, WIDTH};

/// Height of a row, pixels.
pub(super) const ROW: f64 = 27.0;
/// Most rows that fit on a page.
pub(super) const MOST_ROWS: usize = 30;
const TOP: f64 = 58.0;
/// Widest names, pixels.
const NAMES: f64 = 280.0;
const MARGIN: f64 = 12.0;

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

/// Left edge of the plotting area beside names, pixels.
fn left_of<'n>(names: impl Iterator<Item = &'n str>) -> f64 {
    let widest = names
        .map(|name| text_width(name, SIZE))
        .fold(0.0, f64::max)
        .min(NAMES);
    (MARGIN + widest + 10.0).max(LEFT + 8.0)
}

/// Width of the plotting area beside names, pixels.
pub(super) fn width_of<'n>(names: impl Iterator<Item = &'n str>) -> f64 {
    RIGHT - left_of(names)
}

/// Rows in their place.
pub(super) struct Rows {
    pub figure: Figure,
    pub panel: Panel,
}

impl Rows {
    /// Draws axes, names, legend and notes. `paints` makes the marks of the legend, whose patterns have to be defined first.
    pub fn new(frame: Frame, paints: impl FnOnce(&mut Figure) -> Vec<Mark>) -> Self {
        let left = left_of(frame.names.iter().copied());
        let rows = frame.names.len().max(2) as f64;
        let rect = Rect {
            left,
            top: TOP,
            right: RIGHT,
            bottom: TOP + rows * ROW + 6.0,
        };
        let (below, wide) = ((MARGIN, rect.bottom + BELOW + 8.0), RIGHT - MARGIN);
        let size = (
            WIDTH,
            below.1 + foot_height(frame.entries.into_iter(), wide, &frame.notes),
        );
        let mut figure = Figure::new(size, MARGIN, &frame.title, frame.subject, &frame.desc);
        let mut y = Axis::exact("", 0.0, 1.0, 2);
        // Rows have names in place of numbers.
        y.ticks.clear();
        let panel = Panel::draw(&mut figure, rect, frame.x, y, true);
        let marks = paints(&mut figure);
        for (k, row) in frame.names.iter().enumerate() {
            let at = (left - 8.0, middle_of(&panel, k) + 4.0);
            name(
                &mut figure,
                at,
                Side::Left,
                (SIZE, left - 8.0 - 8.0),
                &format!("class=\"row\" data-row=\"{k}\""),
                row,
            );
        }
        foot(
            &mut figure,
            below,
            wide,
            marks.into_iter().zip(frame.entries).collect(),
            &frame.notes,
        );
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
            self.figure.line(
                (x, rect.top),
                (x, rect.bottom),
                &format!("stroke=\"{INK}\" stroke-width=\"4\""),
            );
        }
    }

    /// A bar of a row of the table from one value to another between two heights; none where a value is not finite.
    pub fn bar(
        &mut self,
        row: usize,
        (from, to): (f64, f64),
        (top, bottom): (f64, f64),
        paint: &str,
    ) {
        if !from.is_finite() || !to.is_finite() {
            return;
        }
        let (a, b) = (self.panel.px(from), self.panel.px(to));
        let rect = Rect {
            left: a.min(b),
            right: a.max(b),
            top,
            bottom,
        };
        self.figure.rect(rect, &format!("class=\"bar\" data-row=\"{row}\" fill=\"{paint}\" stroke=\"{INK}\" stroke-width=\"2\""));
    }

    /// An interval with end marks, on a pale line that shows it on dark fills too.
    pub fn whisker(&mut self, row: usize, [low, high]: [f64; 2], y: f64) {
        let (a, b) = (self.panel.px(low), self.panel.px(high));
        for paint in [
            "stroke=\"#ffffff\" stroke-width=\"9\"",
            "class=\"interval\" stroke=\"#000000\" stroke-width=\"5\"",
        ] {
            let paint = format!("{paint} data-row=\"{row}\"");
            self.figure.line((a, y), (b, y), &paint);
            for x in [a, b] {
                self.figure.line((x, y - 3.0), (x, y + 3.0), &paint);
            }
        }
    }

    /// The picture with its numbers.
    pub fn finish(mut self, table: PictureTable) -> Picture {
        self.panel.outline(&mut self.figure);
        Picture {
            svg: self.figure.finish(),
            table,
        }
    }
}

fn middle_of(panel: &Panel, row: usize) -> f64 {
    panel.rect.top + 3.0 + (row as f64 + 0.5) * ROW
}
