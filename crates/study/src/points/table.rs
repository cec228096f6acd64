//! A table of points from its lines to whoever takes the rows.

use std::io::BufRead;

use cvtcycle_config::Problems;
use cvtcycle_config::cycle::problems::{Cell, Collector, Complaint, Line};
use cvtcycle_model::transmission::cvt::variator::Formulation;
use cvtcycle_model::transmission::cvt::variator::point::{PointFlags, PointStatus};

use super::columns::{Column, Header, NUMBERS};
use super::lines::{Broken, Lines};
use super::model::{Model, Solved};
use super::rows;

/// Takes computed rows in the order of the table. What it cannot do ends the reading.
pub trait Take {
    /// The line of names is good, rows follow; whether they have a `case`.
    ///
    /// # Errors
    /// Why no row can be taken.
    fn begin(&mut self, with_case: bool) -> Result<(), Problems>;

    /// A row and its `case` as it stood in the input, quotes within doubled; empty where there is none. Rows that come before a bad one
    /// are given too: whoever keeps them drops them when the table turns out bad.
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
    pub ignored: Vec<&'static str>,
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
        PointStatus::ALL
            .into_iter()
            .map(PointStatus::name)
            .zip(self.status)
    }

    /// Name of every flag with its number of points.
    pub fn by_flag(&self) -> impl Iterator<Item = (&'static str, u64)> {
        PointFlags::NAMES
            .into_iter()
            .map(|(name, _)| name)
            .zip(self.flags)
    }

    /// The counts in words, after the name of the file that holds the rows.
    #[must_use]
    pub fn text(&self, out: &str) -> String {
        let some = |counts: &mut dyn Iterator<Item = (&'static str, u64)>| {
            let words: Vec<String> = counts
                .filter(|(_, count)| *count > 0)
                .map(|(name, count)| format!("{count} {name}"))
                .collect();
            if words.is_empty() {
                "none".to_owned()
            } else {
                words.join(", ")
            }
        };
        let (status, flags) = (some(&mut self.by_status()), some(&mut self.by_flag()));
        let noun = if self.points == 1 { "point" } else { "points" };
        format!(
            "{out}: {} {noun}: {status}\nflagged: {flags}\n",
            self.points
        )
    }
}

/// A table on its way.
struct Table<'f, 't> {
    found: Collector<'f>,
    job: Job<'t>,
    counts: Counts,
}

/// Reads the table called `file`, one line at a time, and gives away its rows.
///
/// # Errors
/// All problems of the table, or why a row could not be taken.
pub fn read(file: &str, reader: impl BufRead, job: Job<'_>) -> Result<Done, Problems> {
    let mut table = Table {
        found: Collector::new(file),
        job,
        counts: Counts::default(),
    };
    let ignored = table.read(Lines::new(reader))?;
    let Table { found, counts, .. } = table;
    if found.is_empty() {
        Ok(Done { counts, ignored })
    } else {
        Err(found.finish())
    }
}

impl Table<'_, '_> {
    /// Goes through the lines; gives the columns of the input that are computed and not read.
    fn read(&mut self, mut lines: Lines<impl BufRead>) -> Result<Vec<&'static str>, Problems> {
        let header = match lines.next() {
            None => {
                self.found.file(Complaint::new(
                    "the file is empty",
                    "",
                    "it needs a line of column names and at least one row",
                ));
                None
            }
            Some(Err(broken)) => {
                self.broken(broken);
                None
            }
            Some(Ok(line)) => Header::read(line, &mut self.found),
        };
        let Some(header) = header else {
            return Ok(Vec::new());
        };
        if self.job.model.is_some() && self.found.is_empty() {
            self.job.rows.begin(header.has(Column::Case))?;
        }
        while let Some(line) = lines.next() {
            self.counts.points += 1;
            match line {
                Ok(line) => self.row(line, &header)?,
                Err(broken) => {
                    if !self.broken(broken) {
                        return Ok(Vec::new());
                    }
                }
            }
        }
        if self.counts.points == 0 {
            self.found.file(Complaint::new(
                "the file has column names and no rows",
                "at least one row",
                "",
            ));
        }
        Ok(header.ignored())
    }

    fn row(&mut self, line: Line<'_>, header: &Header) -> Result<(), Problems> {
        let mut fields = Vec::with_capacity(header.columns.len());
        if !self.found.split(line, header.columns.len(), &mut fields) {
            return Ok(());
        }
        let (given, mut good) = rows::read(line, &fields, header, &mut self.found);
        let Some(model) = &mut self.job.model else {
            return Ok(());
        };
        let found = &mut self.found;
        let mut complain = |(place, complaint): (usize, Complaint)| {
            let at = header
                .columns
                .iter()
                .position(|column| *column == Some(Column::Number(place)));
            let key = NUMBERS[place].name;
            match at.and_then(|at| fields.get(at)) {
                Some(&field) => found.cell(&Cell { line, key, field }, || complaint),
                None => found.line(line, key, || complaint),
            }
        };
        for complaint in model.check(&given, self.job.formulation) {
            good = false;
            complain(complaint);
        }
        // A row that lacks a required column says nothing more than the line of names did.
        if !good || !given.is_whole() {
            return Ok(());
        }
        match model.solve(&given, self.job.formulation) {
            Err(complaint) => complain(complaint),
            // What will not be written need not be formatted.
            Ok(row) if self.found.is_empty() => {
                self.counts.add(&row);
                self.job.rows.put(given.case, &row)?;
            }
            Ok(_) => {}
        }
        Ok(())
    }

    /// Notes what is broken; whether the next line can be read.
    fn broken(&mut self, broken: Broken) -> bool {
        match broken {
            Broken::Line(number, complaint) => {
                self.found.line(Line { number, text: "" }, "", || complaint);
                true
            }
            Broken::File(complaint) => {
                self.found.file(complaint);
                false
            }
        }
    }
}
