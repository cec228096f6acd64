//! A car through a cycle: the loop over the steps, its rows, energy balances and totals.

mod balance;
mod row;
mod run;
mod simulate;
mod totals;
mod vehicle;

pub use balance::{TERM_NAMES, Terms};
pub use row::{Component, Flags, Row};
pub use run::{
    Conditions, FuelMap, Give, Outcome, Start, components, drive, drive_into, fuel_map,
    litres_per_100km,
};
pub use simulate::{Car, Recorder, State, loss_heat_w, simulate};
pub use totals::{PhaseTotals, Totals};
pub use vehicle::Vehicle;
