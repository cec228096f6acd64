//! A table of points from its lines to the sink.

use std::io::BufRead;

use cvtcycle::config::Problem;
use cvtcycle::cycle::problems::{Cell, Complaint, Line, Problems};
use cvtcycle::results::file::OutputFile;
use cvtcycle::transmission::cvt::variator::Formulation;
use cvtcycle::transmission::cvt::variator::point::{PointFlags, PointStatus};

use super::columns::{Column, Header, NUMBERS};
use super::lines::{Broken, Lines};
use super::model::{Model, Solved};
use super::rows;
use super::sink::Sink;

/// What is to be done with the points.
#[derive(Debug)]
pub struct Job {
    /// None where the options are bad: rows are then checked and not computed.
    pub model: Option<Model>,
    /// Formulation of rows that name none.
    pub formulation: Formulation,
    pub out: Option<OutputFile>,
    pub json: bool,
}

/// What came of a table.
#[derive(Debug)]
pub struct Done {
    pub counts: Counts,
    pub sink: Sink,
    /// Columns of the input that were not read.
    pub ignored: Vec<&'static str>,
}

/// Points by status and by flag.
#[derive(Debug, Default)]
pub struct Counts {
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

    pub fn by_status(&self) -> impl Iterator<Item = (&'static str, u64)> {
        PointStatus::ALL.into_iter().map(PointStatus::name).zip(self.status)
    }

    pub fn by_flag(&self) -> impl Iterator<Item = (&'static str, u64)> {
        PointFlags::NAMES.into_iter().map(|(name, _)| name).zip(self.flags)
    }

    /// The counts in words, after the name of the file that holds the rows.
    pub fn text(&self, out: &str) -> String {
        let some = |counts: &mut dyn Iterator<Item = (&'static str, u64)>| {
            let words: Vec<String> = counts.filter(|(_, count)| *count > 0).map(|(name, count)| format!("{count} {name}")).collect();
            if words.is_empty() { "none".to_owned() } else { words.join(", ") }
        };
        let (status, flags) = (some(&mut self.by_status()), some(&mut self.by_flag()));
        let noun = if self.points == 1 { "point" } else { "points" };
        format!("{out}: {} {noun}: {status}\nflagged: {flags}\n", self.points)
    }
}

/// A table on its way.
struct Table<'f> {
    found: Problems<'f>,
    job: Job,
    sink: Option<Sink>,
    counts: Counts,
}

/// Reads all rows of the table called `file` and puts them into a sink, which is still to be finished. None where there is no model.
pub fn read(file: &str, reader: impl BufRead, job: Job) -> Result<Option<Done>, Vec<Problem>> {
    let mut table = Table { found: Problems::new(file), job, sink: None, counts: Counts::default() };
    let ignored = table.read(Lines::new(reader))?;
    let Table { found, sink, counts, .. } = table;
    if found.is_empty() { Ok(sink.map(|sink| Done { counts, sink, ignored })) } else { Err(found.finish()) }
}

impl Table<'_> {
    /// Goes through the lines; gives the columns of the input that are computed and not read.
    fn read(&mut self, mut lines: Lines<impl BufRead>) -> Result<Vec<&'static str>, Vec<Problem>> {
        let header = match lines.next() {
            None => {
                self.found.file(Complaint::new("the file is empty", "", "it needs a line of column names and at least one row"));
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
            self.sink = Some(Sink::new(self.job.out.take(), self.job.json, header.has(Column::Case))?);
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
            self.found.file(Complaint::new("the file has column names and no rows", "at least one row", ""));
        }
        Ok(header.ignored())
    }

    fn row(&mut self, line: Line<'_>, header: &Header) -> Result<(), Vec<Problem>> {
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
            let at = header.columns.iter().position(|column| *column == Some(Column::Number(place)));
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
                self.sink.as_mut().map_or(Ok(()), |sink| sink.put(given.case, &row))?;
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
