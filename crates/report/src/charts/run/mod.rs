//! Pictures of a run: traces, losses, operating points, fuel.

mod fuel_bars;
mod logged;
mod losses;
mod operating;
mod timeline;
mod traces;

pub use fuel_bars::fuel_bars;
pub use logged::logged;
pub use losses::{LossBins, bin_losses, losses};
pub use operating::operating_points;
pub use traces::{driveline, pressure, temperatures};

pub use super::printed::{PublishedDrive, published_drive};

use cvtcycle_model::drive::FuelMap;
use cvtcycle_output::History;
use cvtcycle_output::summary::{Over, RunSummary};

/// A run and the additional data of its pictures.
#[derive(Clone, Debug)]
pub struct PlotRun<'a> {
    /// Name of the car in the picture.
    pub name: &'a str,
    /// Trace.
    pub history: &'a History,
    /// Engine, for the operating points.
    pub fuel_map: Option<FuelMap>,
    /// Fuel of each phase group and of the `total`, in the order of the plot.
    pub group_fuel: Vec<(String, f64)>,
    /// Unit of that fuel, L/100 km, or L/h for a drive without way.
    pub fuel_unit: &'static str,
    /// Energy of the fuel of the cycle, kJ.
    pub fuel_energy_kj: f64,
    /// Published numbers of this drive.
    pub published: PublishedDrive,
}

impl PlotRun<'_> {
    /// Fuel of an energy, in the unit of the fuel for each kJ; `None` without fuel.
    fn fuel_of_kj(&self) -> Option<f64> {
        let total = self.group_fuel.iter().find(|(name, _)| name == "total");
        let fuel = total?.1 / self.fuel_energy_kj;
        (fuel.is_finite() && fuel > 0.0).then_some(fuel)
    }
}

/// Fuel of each phase group, of the cycle, and weighted where the cycle is, L/100 km, or L/h for a drive without way: for [`PlotRun::group_fuel`].
pub fn group_fuel(run: &RunSummary) -> Vec<(String, f64)> {
    // The only group of an undivided cycle is its total.
    let phases = run.phases.iter().filter(|_| run.phases.len() > 1);
    let over = run.over();
    let phases = phases.map(|phase| {
        let fuel = match over {
            Over::Distance => phase.fuel_l_per_100km,
            Over::Time => phase.fuel_l_per_h,
        };
        (phase.name.as_str(), fuel)
    });
    let weighted = run.weighted_fuel_l_per_100km.map(Some);
    let total = match over {
        Over::Distance => run.fuel_l_per_100km,
        Over::Time => run.litres_per_hour(),
    };
    let whole = [("total", Some(total)), ("weighted", weighted)];
    let whole = whole
        .into_iter()
        .filter_map(|(name, fuel)| Some((name, fuel?)));
    let named = |(name, fuel): (&str, Option<f64>)| (name.to_owned(), fuel.unwrap_or(f64::NAN));
    phases.chain(whole).map(named).collect()
}
