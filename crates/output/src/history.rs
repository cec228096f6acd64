//! Trace of a car by column, from a run in memory or a file on disk, for plots and reports.
//!
//! Numbers are in the units of [`trace`](super::trace). Writing and reading a history preserves every bit.

mod read;

pub use read::{AGAIN, FLAGS, too_many_phases};

use super::table::{Kind, Scope};
use super::trace::{COLUMNS, TraceColumn, loss_column};
use super::{Component, Flags, Row};

/// Maximum number of phases, as for a cycle.
const MAX_PHASES: usize = 200;
/// Hint for a trace that is too long.
pub const SHORTER: &str = "run it again with a larger time step, or a part of the cycle";

/// Steps of one car through one cycle, by column.
#[derive(Clone, Debug, Default)]
pub struct History {
    columns: Vec<(&'static TraceColumn, Vec<f64>)>,
    phases: Vec<String>,
    phase: Vec<usize>,
    flags: Vec<Flags>,
}

impl History {
    /// Converts the rows of a run to columns. `phases` are the names that [`Row::phase`] indexes; only those that occur are kept, in their
    /// order.
    pub fn from_rows(rows: &[Row], columns: &[&'static TraceColumn], phases: &[String]) -> Self {
        let numbers = |column: &&'static TraceColumn| {
            let mut numbers = Vec::with_capacity(rows.len());
            column.numbers(rows, &mut numbers);
            numbers.iter_mut().for_each(|x| *x = plain(*x));
            (*column, numbers)
        };
        let mut history = History {
            columns: columns
                .iter()
                .filter(|column| is_number(column))
                .map(numbers)
                .collect(),
            ..History::default()
        };
        for row in rows {
            let name = phases
                .get(usize::from(row.phase))
                .map_or("", String::as_str);
            history.step(name, row.flags);
        }
        history
    }

    /// Creates a history with these columns and no steps.
    pub fn empty(columns: &[&'static TraceColumn]) -> Self {
        History {
            columns: columns.iter().map(|column| (*column, Vec::new())).collect(),
            ..History::default()
        }
    }

    /// Replaces the numbers of a column.
    pub fn put(&mut self, name: &str, numbers: Vec<f64>) {
        if let Some((_, own)) = self
            .columns
            .iter_mut()
            .find(|(column, _)| column.name == name)
        {
            *own = numbers;
        }
    }

    /// Appends phase and flags of a step.
    pub fn step(&mut self, phase: &str, flags: Flags) {
        // Most steps have the phase of the step before.
        let known = |at: &usize| self.phases.get(*at).is_some_and(|name| name == phase);
        let before = self.phase.last().copied().filter(known);
        let index = before
            .or_else(|| self.phases.iter().position(|name| name == phase))
            .unwrap_or_else(|| {
                self.phases.push(phase.to_owned());
                self.phases.len() - 1
            });
        self.phase.push(index);
        self.flags.push(flags);
    }

    /// Numbers of a column, one a step, in the unit of the column; NaN for missing values. Empty for an unknown column or one of words.
    pub fn column(&self, name: &str) -> &[f64] {
        let mut columns = self.columns.iter();
        let own = columns.find(|(column, _)| column.name == name);
        own.map_or(&[], |(_, numbers)| numbers)
    }

    /// Iterates over the columns of numbers, in the order of the table.
    pub fn columns(&self) -> impl Iterator<Item = (&'static TraceColumn, &[f64])> {
        self.columns
            .iter()
            .map(|(column, numbers)| (*column, numbers.as_slice()))
    }

    /// Tests for a column of numbers of that name.
    pub fn has(&self, name: &str) -> bool {
        self.columns.iter().any(|(column, _)| column.name == name)
    }

    /// True for a car with a belt, false for one with gears.
    pub fn is_cvt(&self) -> bool {
        self.has("belt_ratio")
    }

    /// Ends of the steps, s.
    pub fn time_s(&self) -> &[f64] {
        self.column("time_s")
    }

    /// Lengths of the steps, s.
    pub fn dt_s(&self) -> &[f64] {
        self.column("dt_s")
    }

    /// Number of steps.
    pub fn len(&self) -> usize {
        self.flags.len()
    }

    /// True if there are no steps.
    pub fn is_empty(&self) -> bool {
        self.flags.is_empty()
    }

    /// Names of the phases, in the order in which they begin.
    pub fn phases(&self) -> &[String] {
        &self.phases
    }

    /// Phase of a step, as index into [`History::phases`]; 0 beyond the last step.
    pub fn phase(&self, step: usize) -> usize {
        self.phase.get(step).copied().unwrap_or(0)
    }

    /// Flags of a step; empty beyond the last one.
    pub fn flags(&self, step: usize) -> Flags {
        self.flags.get(step).copied().unwrap_or_default()
    }

    /// Loss components that have a column, in the order of the power flow.
    pub fn components(&self) -> Vec<Component> {
        Component::ALL
            .into_iter()
            .filter(|component| {
                loss_column(*component).is_some_and(|column| self.has(&column.name))
            })
            .collect()
    }

    /// Loss power of a component at each step, W; empty if the car has none.
    pub fn loss_w(&self, component: Component) -> &[f64] {
        loss_column(component).map_or(&[], |column| self.column(&column.name))
    }
}

/// Normalises a number as the files do: not finite becomes NaN, and zero loses its sign.
fn plain(number: f64) -> f64 {
    if number.is_finite() {
        number + 0.0
    } else {
        f64::NAN
    }
}

/// True if the cells of a column are numbers.
pub fn is_number(column: &TraceColumn) -> bool {
    column.kind != Kind::Text
}

/// Parses the flags of a cell.
pub fn flags_of(cell: &str) -> Result<Flags, &str> {
    let mut flags = Flags::default();
    for word in cell.split('|').filter(|_| !cell.is_empty()) {
        let own = Flags::NAMES.iter().find(|(_, name)| *name == word);
        let (flag, _) = own.ok_or(word)?;
        flags.set(*flag, true);
    }
    Ok(flags)
}

/// Columns that a trace with the columns `there` must have and lacks: those of every trace, and those of a belt or of gears.
pub fn missing(there: &[&'static TraceColumn]) -> Vec<&'static TraceColumn> {
    let cvt = there.iter().any(|column| column.scope == Scope::Cvt);
    let kind = if cvt { Scope::Cvt } else { Scope::Manual };
    let wanted = |own: &&TraceColumn| own.scope == Scope::Always || own.scope == kind;
    let has = |own: &TraceColumn| there.iter().any(|column| column.name == own.name);
    COLUMNS
        .iter()
        .filter(wanted)
        .filter(|own| !has(own))
        .collect()
}

/// Looks up columns by name, in the order of the table; unknown names are skipped.
pub fn known<'n>(names: impl Iterator<Item = &'n str>) -> Vec<&'static TraceColumn> {
    let names: Vec<&str> = names.collect();
    COLUMNS
        .iter()
        .filter(|own| names.contains(&&*own.name))
        .collect()
}
