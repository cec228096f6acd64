//! Published numbers in a panel: a band for a range over a span, a line for one number over a span, a diamond at a point.

use super::super::engine::{Entry, Fill, PUBLISHED, Panel, Style, Symbol, at, stroke};

/// Colour of a band in the legend: the colour of published numbers on white.
const BAND: &str = "#f6eae8";

/// A published number or range over a place or a span of the horizontal axis, in the units of the axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PrintedMark {
    /// Ends of the span; equal for a point.
    pub x: [f64; 2],
    /// Ends of the range; equal for a number.
    pub y: [f64; 2],
}

impl PrintedMark {
    /// Draws the mark. Over areas a band has edges only, so that it does not hide them.
    pub(crate) fn draw(&self, panel: &mut Panel, over_areas: bool) {
        let ([from, to], [low, high]) = (self.x, self.y);
        if self.is_band() && !over_areas {
            let band = Style::colour(PUBLISHED).fill_opacity(0.10);
            panel.rectangle(at(from, low), at(to, high), band.class("printed"));
        }
        let line = Style::line(stroke(PUBLISHED, 1.2, &[3.0, 2.0]));
        match to > from {
            true => {
                for y in [low, high] {
                    panel.segment(at(from, y), at(to, y), line.clone());
                }
            }
            false => panel.segment(at(from, low), at(from, high), line),
        }
        if !self.is_band() {
            let middle = at(0.5 * (from + to), 0.5 * (low + high));
            let style = Symbol::white(PUBLISHED).class("printed");
            panel.symbol(Symbol::DIAMOND, middle, 4.5, style);
        }
    }

    /// True for a range over a span.
    fn is_band(&self) -> bool {
        self.x[1] > self.x[0] && self.y[1] > self.y[0]
    }
}

/// Entries of the legend.
pub(crate) fn entries<'m>(marks: impl Iterator<Item = &'m PrintedMark> + Clone) -> Vec<Entry> {
    let mut list = Vec::new();
    if marks.clone().any(PrintedMark::is_band) {
        list.push(Entry::fill(
            Fill::plain(BAND),
            "range printed in the thesis",
        ));
    }
    if marks.into_iter().any(|mark| !mark.is_band()) {
        let style = Symbol::white(PUBLISHED);
        list.push(Entry::symbol(
            Symbol::DIAMOND,
            style,
            "printed in the thesis",
        ));
    }
    list
}
