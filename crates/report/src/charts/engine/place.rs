//! Places in a panel, and texts at them.

use super::style::{INK, QUIET};
use super::svg::Point;
use super::text::Cut;

/// A place in the units of the axes with an offset in pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub x: f64,
    pub y: f64,
    pub dx: f64,
    pub dy: f64,
}

/// A place in the units of the axes; infinite ones are the edges of the panel.
pub(crate) fn at(x: f64, y: f64) -> Place {
    let (dx, dy) = (0.0, 0.0);
    Place { x, y, dx, dy }
}

impl Place {
    /// Shifts the place by pixels to the right and down.
    pub fn shift(self, dx: f64, dy: f64) -> Self {
        Place { dx, dy, ..self }
    }
}

/// Right end of a line in the units of the axes, and its label.
#[derive(Clone, Debug)]
pub(crate) struct End {
    pub at: Point,
    pub text: String,
    pub colour: &'static str,
}

/// A line of text at its base line.
#[derive(Clone, Debug)]
pub(crate) struct Label {
    pub at: Place,
    pub text: String,
    pub size: f64,
    /// SVG `text-anchor`: part of the text at its place.
    pub anchor: &'static str,
    pub bold: bool,
    /// True for text rotated to be read from the right.
    pub turned: bool,
    /// True for text on a white background, legible on lines and cells.
    pub ground: bool,
    pub colour: &'static str,
    /// Method of cutting a text wider than `room` pixels; the full one shows as a tooltip.
    pub cut: Cut,
    pub room: f64,
    pub class: &'static str,
    pub row: Option<usize>,
}

impl Label {
    /// Text of 11 px that begins at a place.
    pub fn new(at: Place, text: impl Into<String>) -> Self {
        Label {
            at,
            text: text.into(),
            size: 11.0,
            anchor: "start",
            bold: false,
            turned: false,
            ground: false,
            colour: INK,
            cut: Cut::End,
            room: f64::INFINITY,
            class: "",
            row: None,
        }
    }

    /// Right-aligns the text.
    pub fn end(mut self) -> Self {
        self.anchor = "end";
        self
    }

    /// Centres the text.
    pub fn middle(mut self) -> Self {
        self.anchor = "middle";
        self
    }

    pub fn size(mut self, size: f64) -> Self {
        self.size = size;
        self
    }

    pub fn bold(mut self, bold: bool) -> Self {
        self.bold = bold;
        self
    }

    pub fn turned(mut self) -> Self {
        self.turned = true;
        self
    }

    pub fn quiet(self) -> Self {
        self.colour(QUIET)
    }

    pub fn colour(mut self, colour: &'static str) -> Self {
        self.colour = colour;
        self
    }

    pub fn cut(mut self, cut: Cut, room: f64) -> Self {
        (self.cut, self.room) = (cut, room);
        self
    }

    pub fn class(mut self, class: &'static str) -> Self {
        self.class = class;
        self
    }

    pub fn row(mut self, row: usize) -> Self {
        self.row = Some(row);
        self
    }
}
