//! The chart engine: a [`Chart`] is data - panels with axes and shapes, legends, notes, a table - and one renderer draws it.
//!
//! Plotters draws the frames of the panels, on a backend that writes our SVG; data, hatches and legends go to the same surface.

mod axis;
mod backend;
mod chart;
mod label;
mod legend;
mod place;
mod render;
mod rows;
mod style;
mod svg;
mod symbol;
mod text;

pub use axis::cell;
pub(crate) use axis::{Axis, number, range, round_step};
pub(crate) use chart::{
    BELOW, Block, Chart, Entry, Item, Key, LEFT, Mark, PLOT_LEFT, Panel, Shape, Side, WIDTH, free,
    grid,
};
pub(crate) use place::{Label, Place, at};
pub(crate) use rows::{row_middle, rows_left, rows_panel};
pub(crate) use style::{
    CONTEXT, DIVERGING, Fill, INK, PLAIN, QUIET, RULE, STROKES, Stroke, Style, ZERO, between, ramp,
    stroke,
};
pub(crate) use svg::{Point, Rect};
pub(crate) use symbol::Symbol;
pub(crate) use text::{Cut, lines, text_width};
