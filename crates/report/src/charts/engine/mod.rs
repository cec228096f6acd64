//! The chart engine: a [`Chart`] is data - panels with axes and shapes, legends, notes - and one renderer draws it as SVG.
//!
//! Plotters draws the frames of the panels, on a backend that writes our SVG; data, hatches and legends go to the same surface.

mod axis;
mod backend;
mod chart;
mod ends;
mod legend;
mod narrow;
mod panel;
mod place;
mod render;
mod style;
mod svg;
mod symbol;
mod text;

pub use axis::cell;
pub(crate) use axis::{Axis, number, optional_cell, range, round_step};
pub(crate) use chart::{Block, Chart, Entry, Key, LEFT, PLOT_LEFT, Side, WIDTH};
pub(crate) use ends::ON_CELLS;
pub(crate) use panel::{BELOW, Item, Panel, Shape, free, grid, row_middle, rows_left, rows_panel};
pub(crate) use place::{End, Label, Place, at};
pub use style::Palette;
pub(crate) use style::{
    CONTEXT, DIVERGING, Fill, INK, PLAIN, PUBLISHED, QUIET, RULE, STROKES, Stroke, Style, ZERO,
    between, group_line, ramp, signed_colour, stroke,
};
pub(crate) use svg::{Point, Rect};
pub(crate) use symbol::Symbol;
pub(crate) use text::{Cut, lines, text_width};
