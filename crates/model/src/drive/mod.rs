//! A car through a cycle: the loop over the steps, its rows, energy balances and totals.

mod accelerate;
mod balance;
mod car;
mod forward;
mod gears;
mod physics;
mod row;
mod run;
mod simulate;
mod step;
mod stopping;
mod together;
mod totals;
mod vehicle;
pub(crate) mod vehicle_keys;

pub use accelerate::{Accelerated, Driven, FullThrottle, Grip, Instant, accelerate};
pub use balance::{EnergyTerms, TERM_NAMES};
pub use car::Car;
pub use forward::{Forward, Given, Turned};
pub use gears::{CarTrace, WltcClass};
pub use physics::{Finding, Law, PhysicsCheck, check_physics};
pub use row::{HIGHEST_K, Row};
pub use run::{
    Conditions, FuelMap, Outcome, RowSink, SHORTEST_M, SLOWEST_M_S, Start, co2_g_per_km,
    distance_counts, drive, drive_into, fuel_map, litres_per_100km, litres_per_hour, own_trace,
    start_state,
};
pub use simulate::{Recorder, State, simulate};
pub use step::{Drive, loss_heat_w};
pub use together::{MAX_TOGETHER, Run, drive_each, drive_each_on};
pub use totals::{Extreme, PhaseTotals, Totals};
pub use vehicle::{ChangedParts, Vehicle};
