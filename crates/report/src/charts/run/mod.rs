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

pub use super::printed::{PublishedDrive, published_drive};

use cvtcycle_model::drive::FuelMap;
use cvtcycle_output::History;
use cvtcycle_output::summary::RunSummary;

/// A run and the additional data of its pictures.
#[derive(Clone, Debug)]
pub struct PlotRun<'a> {
    /// Name of the car in the picture.
    pub name: &'a str,
    /// Trace.
    pub history: &'a History,
    /// Engine, for the operating points.
    pub fuel_map: Option<FuelMap>,
    /// Fuel in L/100 km of each phase group and of the `total`, in the order of the plot.
    pub group_fuel: Vec<(String, f64)>,
    /// Published numbers of this drive.
    pub published: PublishedDrive,
}

/// Fuel of each phase group, of the cycle, and weighted where the cycle is, L/100 km: for [`PlotRun::group_fuel`].
pub fn group_fuel(run: &RunSummary) -> Vec<(String, f64)> {
    // The only group of an undivided cycle is its total.
    let phases = run.phases.iter().filter(|_| run.phases.len() > 1);
    let phases = phases.map(|phase| (phase.name.as_str(), phase.fuel_l_per_100km));
    let weighted = run.weighted_fuel_l_per_100km.map(Some);
    let whole = [
        ("total", Some(run.fuel_l_per_100km)),
        ("weighted", weighted),
    ];
    let whole = whole
        .into_iter()
        .filter_map(|(name, fuel)| Some((name, fuel?)));
    let named = |(name, fuel): (&str, Option<f64>)| (name.to_owned(), fuel.unwrap_or(f64::NAN));
    phases.chain(whole).map(named).collect()
}
