//! Operating points of the belt in a table, row by row: what `cvtcycle belt` reads and computes.
//!
//! A table may have any length: one line is in memory at a time.

mod columns;
mod model;
mod rows;

pub use columns::{OUTPUTS, Point, output_columns};
pub(crate) use model::{GivenFriction, belt_k, belt_load};
pub use model::{Model, Solved};
pub use rows::NUMBERS;

use std::io::BufRead;

use columns::schema;
use cvtcycle_config::Problems;
use cvtcycle_config::csv::{Cells, Collector, Lines, Row};
use cvtcycle_model::transmission::cvt::variator::Formulation;
use cvtcycle_model::transmission::cvt::variator::point::{PointFlags, PointStatus};
use rows::{CASE_INDEX, Given};

/// Takes computed rows in the order of the table. What it cannot do ends the reading.
pub trait Take {
    /// The line of names is good, rows follow; whether they have a `case`.
    ///
    /// # Errors
    /// Why no row can be taken.
    fn begin(&mut self, with_case: bool) -> Result<(), Problems>;

    /// A row and its `case` as in the input, quotes within doubled; empty where there is none. Rows that come before a bad one
    /// are given too: the consumer drops them when the table turns out bad.
    ///
    /// # Errors
    /// Why the row cannot be taken.
    fn put(&mut self, case: &str, row: &Solved) -> Result<(), Problems>;
}

/// What is to be done with the points.
pub struct Job<'t> {
    /// None where the options are bad: rows are then checked and not computed.
    pub model: Option<Model>,
    /// Formulation of rows that name none.
    pub formulation: Formulation,
    /// Who takes the rows.
    pub rows: &'t mut dyn Take,
}

/// What came of a table.
#[derive(Debug)]
pub struct Done {
    /// Points by status and flag.
    pub counts: Counts,
    /// Columns of the input that were not read.
    pub ignored: Vec<String>,
}

/// Points by status and by flag.
#[derive(Debug, Default)]
pub struct Counts {
    /// Rows of the table.
    pub points: u64,
    status: [u64; PointStatus::ALL.len()],
    flags: [u64; PointFlags::NAMES.len()],
}

impl Counts {
    fn add(&mut self, row: &Solved) {
        for (count, status) in self.status.iter_mut().zip(PointStatus::ALL) {
            *count += u64::from(status == row.point.status);
        }
        for (place, count) in self.flags.iter_mut().enumerate() {
            *count += u64::from(row.flags.has(place));
        }
    }

    /// Name of every status with its number of points.
    pub fn by_status(&self) -> impl Iterator<Item = (&'static str, u64)> {
        let names = PointStatus::ALL.into_iter().map(PointStatus::name);
        names.zip(self.status)
    }

    /// Name of every flag with its number of points.
    pub fn by_flag(&self) -> impl Iterator<Item = (&'static str, u64)> {
        let names = PointFlags::NAMES.into_iter().map(|(name, _)| name);
        names.zip(self.flags)
    }

    /// The counts in words, after the name of the file that holds the rows.
    pub fn text(&self, out: &str) -> String {
        let some = |counts: &mut dyn Iterator<Item = (&'static str, u64)>| {
            let counts = counts.filter(|(_, count)| *count > 0);
            let words: Vec<String> = counts
                .map(|(name, count)| format!("{count} {name}"))
                .collect();
            match words.as_slice() {
                [] => "none".to_owned(),
                words => words.join(", "),
            }
        };
        let (status, flags) = (some(&mut self.by_status()), some(&mut self.by_flag()));
        let noun = if self.points == 1 { "point" } else { "points" };
        let points = self.points;
        format!("{out}: {points} {noun}: {status}\nflagged: {flags}\n")
    }
}

/// Reads the table called `file`, one line at a time, and gives away its rows.
///
/// # Errors
/// All problems of the table, or why a row could not be taken.
pub fn read(file: &str, reader: impl BufRead, mut job: Job<'_>) -> Result<Done, Problems> {
    let mut problems = Collector::new(file);
    let mut done = Done {
        counts: Counts::default(),
        ignored: Vec::new(),
    };
    let (schema, mut lines) = (schema(), Lines::new(reader));
    let Some(mut table) = lines.open(&schema, &mut problems) else {
        return Err(problems.finish());
    };
    let columns = table.columns().flatten();
    let ignored = columns.filter(|column| column.cells == Cells::Ignored);
    done.ignored = ignored.map(|column| column.name.to_string()).collect();
    if job.model.is_some() && problems.is_empty() {
        job.rows.begin(table.has(CASE_INDEX))?;
    }
    let before = problems.count();
    while let Some(line) = lines.next(&mut problems) {
        done.counts.points += 1;
        let row = table.row(line, &mut problems);
        job.row(&row, &mut problems, &mut done.counts)?;
    }
    if done.counts.points == 0 && problems.count() == before {
        problems.no_rows(schema.rows);
    }
    problems.finish().finish()?;
    Ok(done)
}

impl Job<'_> {
    fn row(
        &mut self,
        row: &Row<'_, '_>,
        problems: &mut Collector<'_>,
        counts: &mut Counts,
    ) -> Result<(), Problems> {
        let given = Given::read(row, problems);
        let Some(model) = &mut self.model else {
            return Ok(());
        };
        let found = model.check(&given, self.formulation);
        let is_good = found.is_empty() && !row.has_bad();
        for (place, problem) in found {
            row.report(place, problems, problem);
        }
        // A row that lacks a required column says nothing more than the line of names did.
        if !is_good || !given.is_whole() {
            return Ok(());
        }
        match model.solve(&given, self.formulation) {
            Err(refused) => row.report(refused.0, problems, refused.1),
            // What will not be written need not be formatted.
            Ok(solved) if problems.is_empty() => {
                counts.add(&solved);
                self.rows.put(given.case, &solved)?;
            }
            Ok(_) => {}
        }
        Ok(())
    }
}
