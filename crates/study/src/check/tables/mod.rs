//! Sources to tables of numbers in engineer's units.

#[macro_use]
mod columns;
mod belt;
pub mod bench;
mod fluid;
mod rig;
mod run;

use super::expr::Table;
use super::source::{Kind, Source};
use cvtcycle_config::setup::Setup;
use cvtcycle_model::bench::transmission::Conditions;

use columns::names;

pub use run::{Driven, drive};

/// Names of the columns of a kind of source, or of its totals.
#[must_use]
pub fn columns(kind: Kind, totals: bool) -> Vec<&'static str> {
    match kind {
        Kind::Bench => bench::columns(),
        Kind::Belt => names(belt::columns()).collect(),
        Kind::Run if totals => run::total_columns(),
        Kind::Run => run::columns(),
        Kind::Fluid => names(fluid::columns()).collect(),
        Kind::Transient => rig::transient_columns(),
        Kind::StripDown => rig::strip_down_columns(),
        Kind::Vehicle => Vec::new(),
    }
}

/// The table of a source other than a run; `conditions` are those of the transmission rig.
///
/// # Errors
/// A sentence: the vehicle or the point does not fit the source.
pub fn table(source: &Source, setup: &Setup, conditions: &Conditions) -> Result<Table, String> {
    match source.kind {
        Kind::Bench => bench::table(source, setup),
        Kind::Belt => belt::table(source, setup),
        Kind::Fluid => Ok(fluid::table(source, setup)),
        Kind::Transient => rig::transients(source, setup, conditions),
        Kind::StripDown => rig::strip_downs(source, setup, conditions),
        Kind::Run | Kind::Vehicle => Err("this source has no rows".to_owned()),
    }
}

/// The trace or the totals of a run.
#[must_use]
pub fn of_run(source: &Source, driven: &Driven, totals: bool) -> Table {
    if totals {
        run::totals(source, driven)
    } else {
        run::trace(source, driven)
    }
}
