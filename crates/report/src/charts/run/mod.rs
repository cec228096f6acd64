//! Pictures of a run: traces, losses, operating points, fuel.

mod fuel_bars;
mod losses;
mod operating;
mod timeline;
mod traces;

pub use fuel_bars::fuel_bars;
pub use losses::{LossBins, bin_losses, losses};
pub use operating::operating_points;
pub use traces::{driveline, pressure, temperatures};

use cvtcycle_model::drive::FuelMap;
use cvtcycle_output::History;

/// A run and what else its pictures show.
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
