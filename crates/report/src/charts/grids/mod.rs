//! Quantities over two axes: lines of equal value, filled bands, time spent in cells.

mod contour;
mod density;
mod iso;
mod map;

pub(crate) use density::{Density, DensityCell};
pub(crate) use iso::{ISO, iso_lines};
pub(crate) use map::{MapFigure, map_figure, panels_left_of};
