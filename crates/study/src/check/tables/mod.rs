//! Sources to tables of numbers in engineer's units.

pub mod bench;
mod belt;
mod fluid;
mod rig;
mod run;

use super::expr::Table;
use super::source::{Kind, Source};
use cvtcycle_config::setup::Setup;
use cvtcycle_model::bench::transmission::Conditions;

pub use run::{Driven, drive};

/// Names of the columns of a kind of source, or of its totals.
#[must_use]
pub fn columns(kind: Kind, totals: bool) -> Vec<&'static str> {
    match kind {
        Kind::Bench => bench::columns(),
        Kind::Belt => belt::columns(),
        Kind::Run if totals => run::total_columns(),
        Kind::Run => run::columns(),
        Kind::Fluid => fluid::columns(),
        Kind::Transient => rig::transient_columns(),
        Kind::StripDown => rig::strip_down_columns(),
        Kind::Vehicle => Vec::new(),
    }
}

/// The table of a source that is no run; `conditions` are those of the transmission rig.
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
///
/// # Errors
/// Never for phases that the cycle has.
pub fn of_run(source: &Source, driven: &Driven, totals: bool) -> Result<Table, String> {
    if totals {
        run::totals(source, driven)
    } else {
        Ok(run::trace(source, driven))
    }
}

/// Every combination of the values of some axes, the last axis running fastest.
fn combinations(axes: &[Vec<f64>]) -> Vec<Vec<f64>> {
    axes.iter().fold(vec![Vec::new()], |rows, axis| {
        let with = |row: &Vec<f64>, x: f64| row.iter().copied().chain([x]).collect::<Vec<f64>>();
        rows.iter()
            .flat_map(|row| axis.iter().map(move |x| with(row, *x)))
            .collect()
    })
}

/// Places in a row of the numbers that mark it where they are above 0.
#[derive(Clone, Copy, Default)]
struct Marks {
    /// The belt slips grossly.
    gross: Option<usize>,
    /// Outside the validity of a model.
    outside: Option<usize>,
}

/// A table from rows of equal length.
fn from_rows(count: usize, rows: impl Iterator<Item = (Vec<f64>, f64)>, marks: Marks) -> Table {
    let mut table = Table {
        columns: vec![Vec::new(); count],
        ..Table::default()
    };
    for (row, weight) in rows {
        table.gross.extend(marks.gross.map(|k| row[k] > 0.5));
        table.outside.extend(marks.outside.map(|k| row[k] > 0.5));
        for (column, x) in table.columns.iter_mut().zip(row) {
            column.push(x);
        }
        table.weight.push(weight);
    }
    table
}

fn truth(on: bool) -> f64 {
    f64::from(u8::from(on))
}

fn rpm(rad_s: f64) -> f64 {
    rad_s * 30.0 / std::f64::consts::PI
}
