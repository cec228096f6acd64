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

use std::rc::Rc;

use super::expr::Table;
use super::source::{Kind, Source};
use cvtcycle_config::setup::Setup;
use cvtcycle_model::rig::transmission::Conditions;

use cvtcycle_model::keys::rpm;
pub use run::{Driven, drive};

/// A column of a table of rows `R`.
pub struct Column<R> {
    /// Name with the unit.
    pub name: &'static str,
    /// Reads the number from a row.
    pub get: fn(&R) -> f64,
}

/// Names of the columns.
pub fn names<R>(columns: Vec<Column<R>>) -> impl Iterator<Item = &'static str> {
    columns.into_iter().map(|column| column.name)
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
    /// Weight in means.
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

/// What the rows of a table are of, with their marks.
pub struct Rows<T> {
    of: Vec<T>,
    weight: Vec<f64>,
    gross: Vec<bool>,
    outside: Vec<bool>,
}

impl<T: 'static> Rows<T> {
    /// None yet, with room for so many.
    pub fn new(room: usize) -> Self {
        Rows {
            of: Vec::with_capacity(room),
            weight: Vec::with_capacity(room),
            gross: Vec::with_capacity(room),
            outside: Vec::with_capacity(room),
        }
    }

    /// Adds a row.
    pub fn add(&mut self, of: T, marks: &Marks) {
        self.of.push(of);
        self.weight.push(marks.weight);
        self.gross.push(marks.gross);
        self.outside.push(marks.outside);
    }

    /// The table of so many columns; `number` is that of a row in a column.
    pub fn table(self, columns: usize, number: impl Fn(&T, usize) -> f64 + 'static) -> Table {
        let of = self.of;
        let make = move |column: usize| of.iter().map(|row| number(row, column)).collect();
        Table::new(
            columns,
            Box::new(make),
            self.weight,
            [self.gross, self.outside],
        )
    }

    /// The table of some columns.
    pub fn by(self, columns: Vec<Column<T>>) -> Table {
        self.table(columns.len(), move |row, column| (columns[column].get)(row))
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
pub fn of_run(source: &Source, driven: &Rc<Driven>, totals: bool) -> Table {
    if totals {
        run::totals(source, driven)
    } else {
        run::trace(source, driven)
    }
}
