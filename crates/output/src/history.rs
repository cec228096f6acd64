//! The trace of a car by column: what plots and reports read, whether the run has just been driven or lies on disk.
//!
//! Numbers are in the units of [`trace`](super::trace). A history that was written and read again has the same numbers, bit by bit.

mod read;

pub use read::{AGAIN, FLAGS, too_many_phases};

use super::table::{Kind, Scope};
use super::trace::{COLUMNS, TraceColumn, loss_column};
use super::{Component, Flags, Row};

/// Most phases, as of a cycle.
const MAX_PHASES: usize = 200;
/// What helps with a trace that is too long.
pub const SHORTER: &str = "run it again with a larger time step, or a part of the cycle";

/// The steps of one car through one cycle, by column.
#[derive(Clone, Debug, Default)]
pub struct History {
    columns: Vec<(&'static TraceColumn, Vec<f64>)>,
    phases: Vec<String>,
    phase: Vec<usize>,
    flags: Vec<Flags>,
}

impl History {
    /// Rows of a run as columns. `phases` are the names that belong to [`Row::phase`]; only those that occur are kept, in their order.
    pub fn of(rows: &[Row], columns: &[&'static TraceColumn], phases: &[String]) -> Self {
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

    /// A history of these columns without steps yet.
    pub fn empty(columns: &[&'static TraceColumn]) -> Self {
        History {
            columns: columns.iter().map(|column| (*column, Vec::new())).collect(),
            ..History::default()
        }
    }

    /// Puts the numbers of a column in place.
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
        // A phase mostly is that of the step before.
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

    /// The numbers of a column, one a step, in the unit of the column; NaN where there is none. Empty for a column that is not there
    /// or that holds words.
    pub fn column(&self, name: &str) -> &[f64] {
        let mut columns = self.columns.iter();
        let own = columns.find(|(column, _)| column.name == name);
        own.map_or(&[], |(_, numbers)| numbers)
    }

    /// All columns of numbers, in the order of the table.
    pub fn columns(&self) -> impl Iterator<Item = (&'static TraceColumn, &[f64])> {
        self.columns
            .iter()
            .map(|(column, numbers)| (*column, numbers.as_slice()))
    }

    /// Whether there is a column of numbers of that name.
    pub fn has(&self, name: &str) -> bool {
        self.columns.iter().any(|(column, _)| column.name == name)
    }

    /// Whether the car has a belt; otherwise it has gears.
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

    /// Whether there is no step.
    pub fn is_empty(&self) -> bool {
        self.flags.is_empty()
    }

    /// Names of the phases, in the order in which they begin.
    pub fn phases(&self) -> &[String] {
        &self.phases
    }

    /// The phase of a step, as index into [`History::phases`]; 0 beyond the last step.
    pub fn phase(&self, step: usize) -> usize {
        self.phase.get(step).copied().unwrap_or(0)
    }

    /// Flags of a step; none beyond the last one.
    pub fn flags(&self, step: usize) -> Flags {
        self.flags.get(step).copied().unwrap_or_default()
    }

    /// The loss components that have a column, in the order of the power flow.
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

/// A number as the files keep it: NaN where it is not finite, zero without a sign.
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

/// The flags of a cell; the first word that is no flag, where there is one.
pub fn flags_of(cell: &str) -> Result<Flags, &str> {
    let mut flags = Flags::default();
    for word in cell.split('|').filter(|_| !cell.is_empty()) {
        let own = Flags::NAMES.iter().find(|(_, name)| *name == word);
        let (flag, _) = own.ok_or(word)?;
        flags.set(*flag, true);
    }
    Ok(flags)
}

/// The columns that a trace with the columns `there` has to have besides: those of every trace, and of one with a belt or with gears.
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

/// The columns of these names that this program knows, in the order of the table.
pub fn known<'n>(names: impl Iterator<Item = &'n str>) -> Vec<&'static TraceColumn> {
    let names: Vec<&str> = names.collect();
    COLUMNS
        .iter()
        .filter(|own| names.contains(&&*own.name))
        .collect()
}
