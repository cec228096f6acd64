//! Pictures as SVG text, each with the table of its numbers.
//!
//! Every picture is a function from plain numbers to a [`Picture`]: it fills in a chart of the `engine`, which draws it.

pub mod ambient;
pub mod calibration;
pub mod decision;
mod engine;
pub mod figures;
mod fleet;
mod fleet_groups;
mod grids;
mod levers;
pub mod lines;
mod loss_table;
mod picture;
mod price;
mod printed;
pub mod rig_transmission;
mod run;
pub mod study;
mod variator_curves;

pub use engine::cell;
pub use fleet::{FleetMark, fleet_scatter};
pub use fleet_groups::{
    FleetError, FleetPair, fleet_by_group, fleet_over, fleet_pairs, repeat_percent,
};
pub use levers::{foremost_levers, lever_strip, lever_title, saves};
pub use loss_table::loss_figures;
pub use picture::{Picture, PictureTable};
pub use price::price_dots;
pub use run::{
    LossBins, PlotRun, PublishedDrive, bin_losses, driveline, fuel_bars, group_fuel, logged,
    losses, operating_points, pressure, published_drive, temperatures,
};
pub use variator_curves::variator_figures;
