//! Plots of runs as SVG text.
//!
//! Plotters draws the frames: grid, ticks and axis titles. The data themselves are written as SVG
//! paths here, for plotters has neither dash patterns in one path nor hatches nor legends beside
//! the plot, and all three are needed to tell series apart in print.
use cvtcycle_model::drive::FuelMap;
use cvtcycle_output::History;

pub mod ambient;
mod axis;
mod bars;
pub mod calibration;
pub mod chart;
mod contour;
mod curves;
mod density;
mod figure;
mod iso;
mod legend;
mod loss_map;
mod loss_stack;
mod losses;
mod operating;
mod panel;
mod picture;
pub mod review_figures;
pub mod rig_transmission;
mod style;
pub mod study;
mod symbol;
mod timeline;
mod traces;

pub use bars::fuel_bars;
pub use curves::{CurveFigure, CurvePanel, CurveSeries, curve_figure};
pub use loss_map::{MapFigure, map_figure};
pub use loss_stack::{StackFigure, stack_figure};
pub use losses::{LossBins, bin_losses, losses};
pub use operating::operating_points;
pub use picture::{Picture, PictureTable, cell};
pub use traces::{driveline, pressure, temperatures};

/// What the plots need to know of a run.
#[derive(Clone, Debug)]
pub struct PlotRun<'a> {
    /// Name of the vehicle.
    pub name: &'a str,
    /// Its trace.
    pub history: &'a History,
    /// Its engine, for the operating points.
    pub fuel_map: Option<FuelMap>,
    /// Fuel in L/100 km of each phase group and of the `total`, in the order of the plot.
    pub group_fuel: Vec<(String, f64)>,
}
