//! Plots of runs as SVG text.
//!
//! Plotters draws the frames: grid, ticks and axis titles. The data themselves are written as SVG
//! paths here, for plotters has neither dash patterns in one path nor hatches nor legends beside
//! the plot, and all three are needed to tell series apart in print.
use crate::results::History;

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

/// An engine's fuel map on a grid.
#[derive(Clone, Debug, Default)]
pub struct FuelMap {
    /// Engine speeds, rad/s, ascending.
    pub speed_rad_s: Vec<f64>,
    /// Torques, Nm, ascending.
    pub torque_nm: Vec<f64>,
    /// Brake specific fuel consumption, kg/J, by speed and torque; NaN above full load.
    pub bsfc_kg_j: Vec<Vec<f64>>,
    /// Full-load torque at each speed, Nm.
    pub full_load_nm: Vec<f64>,
}
