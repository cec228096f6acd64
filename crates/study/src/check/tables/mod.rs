//! Sources to tables of numbers in engineer's units.

/// Columns of rows `R`, one a line: `NAME ROW => NUMBER;`.
macro_rules! columns {
    ($row:ty; $($name:literal $r:pat => $value:expr;)*) => {
        vec![$(Column::<$row> { name: $name, get: |$r: &$row| $value }),*]
    };
}

mod belt;
pub mod bench;
mod fluid;
mod rig;
mod run;

use super::expr::Table;
use super::source::{Kind, Source};
use cvtcycle_config::setup::Setup;
use cvtcycle_model::bench::transmission::Conditions;

use cvtcycle_model::keys::rpm;
pub use run::{Driven, drive};

/// A column: its name with the unit, and the number of a row.
pub struct Column<R> {
    pub name: &'static str,
    pub get: fn(&R) -> f64,
}

pub fn names<R>(columns: Vec<Column<R>>) -> impl Iterator<Item = &'static str> {
    columns.into_iter().map(|column| column.name)
}

pub fn numbers<R>(columns: &[Column<R>], row: &R) -> impl Iterator<Item = f64> {
    columns.iter().map(move |column| (column.get)(row))
}

/// Every combination of the values of some axes, the last axis fastest.
pub fn combinations(axes: &[Vec<f64>]) -> Vec<Vec<f64>> {
    axes.iter().fold(vec![Vec::new()], |rows, axis| {
        let with = |row: &Vec<f64>, x: f64| row.iter().copied().chain([x]).collect::<Vec<f64>>();
        rows.iter()
            .flat_map(|row| axis.iter().map(move |x| with(row, *x)))
            .collect()
    })
}

/// What counts of a row besides its numbers.
pub struct Marks {
    pub weight: f64,
    /// The belt slips grossly.
    pub gross: bool,
    /// Outside the validity of a model.
    pub outside: bool,
}

impl Default for Marks {
    fn default() -> Self {
        Marks {
            weight: 1.0,
            gross: false,
            outside: false,
        }
    }
}

/// A table that is made row by row.
pub struct Rows {
    table: Table,
}

impl Rows {
    /// None yet of so many columns, with room for so many rows.
    pub fn new(columns: usize, room: usize) -> Self {
        Rows {
            table: Table {
                columns: (0..columns).map(|_| Vec::with_capacity(room)).collect(),
                weight: Vec::with_capacity(room),
                gross: Vec::with_capacity(room),
                outside: Vec::with_capacity(room),
            },
        }
    }

    /// Adds a row, a number for each column.
    pub fn add(&mut self, numbers: impl Iterator<Item = f64>, marks: &Marks) {
        let table = &mut self.table;
        for (column, x) in table.columns.iter_mut().zip(numbers) {
            column.push(x);
        }
        table.weight.push(marks.weight);
        table.gross.push(marks.gross);
        table.outside.push(marks.outside);
    }

    /// The table.
    pub fn table(self) -> Table {
        self.table
    }
}

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
