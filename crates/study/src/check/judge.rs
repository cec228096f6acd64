//! Sources computed once, rows judged.

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

use super::expr::{Computed, compute};
use super::row::{File, Row};
use super::rule::{Verdict, off, verdict};
use super::source::Source;
use super::store::{Cars, Store, View, once};
use cvtcycle_config::rig::PREFIX;
use cvtcycle_config::setup::{Options, Setup, load};
use cvtcycle_config::{KeyInfo, Problem, Problems};
use cvtcycle_model::bench::transmission::Conditions;

/// The vehicle that is validated: sources that name none are computed for it.
#[derive(Clone, Debug, Default)]
pub struct Subject {
    /// Name or path.
    pub vehicle: String,
    /// Transmission oil in place of its own.
    pub lubricant: Option<String>,
    /// Overrides.
    pub set: Vec<String>,
}

/// A row with what came out.
#[derive(Clone, Debug)]
pub struct Judged {
    /// The row.
    pub row: Row,
    /// Its file.
    pub file: String,
    /// Computed; none for what cannot be compared.
    pub computed: Option<Computed>,
    /// Verdict of the rule.
    pub verdict: Verdict,
    /// Whether it is another one than recorded.
    pub moved: bool,
    /// Number behind the reason.
    pub cause: Option<Computed>,
    /// Points of its sources left out because the belt slips grossly there.
    pub left_out: usize,
    /// Points that count though they lie outside the validity of a model.
    pub outside: usize,
}

impl Judged {
    /// How far it is off, in widths of its tolerance.
    #[must_use]
    pub fn off(&self) -> Option<f64> {
        off(
            self.computed.as_ref()?,
            self.row.printed?,
            self.row.tolerance_widths,
        )
    }
}

/// What the rows that nothing was fitted to say.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct HeldOut {
    /// Rows.
    pub rows: usize,
    /// Those that agree.
    pub agree: usize,
    /// Rows with a number and a tolerance.
    pub numbers: usize,
    /// Median of how far these are off, in widths of their tolerances; none without numbers.
    pub median_off: Option<f64>,
    /// Numbers within one width, thus agreeing.
    pub numbers_agree: usize,
}

/// All rows.
#[derive(Clone, Debug)]
pub struct Report {
    /// The vehicle that was validated.
    pub subject: Subject,
    /// Rows in order.
    pub rows: Vec<Judged>,
}

impl Report {
    /// Rows with a verdict.
    #[must_use]
    pub fn count(&self, verdict: Verdict) -> usize {
        self.rows
            .iter()
            .filter(|row| row.verdict == verdict)
            .count()
    }

    /// What the rows that nothing was fitted to say.
    #[must_use]
    pub fn held_out(&self) -> HeldOut {
        let rows: Vec<&Judged> = self
            .rows
            .iter()
            .filter(|row| row.row.is_held_out())
            .collect();
        let agrees = |row: &&&Judged| row.verdict == Verdict::Agrees;
        let mut off: Vec<f64> = rows.iter().filter_map(|row| row.off()).collect();
        off.sort_by(f64::total_cmp);
        let middle = off.len() / 2;
        let median_off = match off.len() {
            0 => None,
            n if n % 2 == 1 => Some(off[middle]),
            _ => Some(f64::midpoint(off[middle - 1], off[middle])),
        };
        HeldOut {
            rows: rows.len(),
            agree: rows.iter().filter(agrees).count(),
            numbers: off.len(),
            median_off,
            numbers_agree: rows
                .iter()
                .filter(|row| row.off().is_some())
                .filter(agrees)
                .count(),
        }
    }

    /// Rows whose verdict is another one than recorded.
    pub fn moved(&self) -> impl Iterator<Item = &Judged> {
        self.rows.iter().filter(|row| row.moved)
    }
}

/// Judges the rows of some files that `wanted` picks.
///
/// # Errors
/// Sources whose vehicle cannot be loaded, rows that cannot be computed.
pub fn judge(
    files: &[File],
    subject: &Subject,
    wanted: impl Fn(&Row) -> bool,
) -> Result<Report, Problems> {
    let cars = FromFiles {
        subject,
        setups: RefCell::default(),
    };
    let store = Store::new(&cars);
    let mut problems = Problems::new();
    // Once for all: what is wrong with the subject is no problem of a file.
    load(&subject.vehicle, "--vehicle", &cars.options(None))?;
    cars.conditions(None)?;
    for source in files.iter().flat_map(|file| &file.sources) {
        let loaded = cars
            .setup(Some(source))
            .and_then(|_| cars.conditions(Some(source)));
        if let Err(found) = loaded {
            for problem in found.iter() {
                let place = if problem.place.line > 0 {
                    problem.place.clone()
                } else {
                    source.place.clone()
                };
                let problem = problem
                    .clone()
                    .at(place)
                    .message(format!("source `{}`: {}", source.name, problem.message));
                if !problems.contains(&problem) {
                    problems.push(problem);
                }
            }
        }
    }
    if !problems.is_empty() {
        return Err(problems);
    }
    let mut rows = Vec::new();
    for file in files {
        let view = View::new(&store, &file.sources);
        for row in file.rows.iter().filter(|row| wanted(row)) {
            match judged(&view, file, row) {
                Ok(judged) => rows.push(judged),
                Err(problem) => problems.push(problem),
            }
        }
    }
    if problems.is_empty() {
        Ok(Report {
            subject: subject.clone(),
            rows,
        })
    } else {
        Err(problems)
    }
}

/// A car, or what is wrong with its files.
type Loaded = Result<Rc<Setup>, Problems>;

/// Cars from their files, each read once.
struct FromFiles<'a> {
    subject: &'a Subject,
    setups: RefCell<HashMap<String, Loaded>>,
}

impl FromFiles<'_> {
    fn options(&self, source: Option<&Source>) -> Options {
        let own = source.is_none_or(|source| source.vehicle.is_none());
        let subject_set = if own {
            self.subject.set.as_slice()
        } else {
            &[]
        };
        let source_set = source
            .map(|source| source.set.as_slice())
            .unwrap_or_default();
        let lubricant = source.and_then(|source| source.lubricant.clone());
        Options {
            lubricant: lubricant.or_else(|| self.subject.lubricant.clone().filter(|_| own)),
            engine_oil: None,
            set: subject_set
                .iter()
                .chain(source_set)
                .filter(|set| !set.starts_with(PREFIX))
                .cloned()
                .collect(),
            formulation: source.map(|source| source.formulation).unwrap_or_default(),
        }
    }
}

impl Cars for FromFiles<'_> {
    fn setup(&self, source: Option<&Source>) -> Result<Rc<Setup>, Problems> {
        let vehicle = source
            .and_then(|source| source.vehicle.as_deref())
            .unwrap_or(&self.subject.vehicle);
        let options = self.options(source);
        let key = format!("{vehicle} {options:?}");
        once(&self.setups, key, || {
            load(vehicle, "vehicle", &options).map(Rc::new)
        })
    }

    fn conditions(&self, source: Option<&Source>) -> Result<(Conditions, Vec<KeyInfo>), Problems> {
        let own = source
            .map(|source| source.set.as_slice())
            .unwrap_or_default();
        let sets: Vec<String> = self.subject.set.iter().chain(own).cloned().collect();
        cvtcycle_config::rig::load(&sets)
    }
}

fn judged(view: &View, file: &File, row: &Row) -> Result<Judged, Problem> {
    let problem = |what: &str, why: String| {
        Problem::invalid(format!(
            "row {}: `{what}` cannot be computed: {why}",
            row.id
        ))
        .at(row.place.clone())
        .key(what)
        .value(row.compute_text.clone())
    };
    view.begin();
    let computed = row
        .compute
        .as_ref()
        .map(|expr| compute(expr, view))
        .transpose()
        .map_err(|why| problem("compute", why))?;
    let (left_out, outside) = view.noted();
    let cause = row
        .cause
        .as_ref()
        .map(|cause| compute(&cause.compute, view))
        .transpose()
        .map_err(|why| problem("cause.compute", why))?;
    let verdict = match (&computed, row.printed) {
        (Some(computed), Some(printed)) => verdict(
            computed,
            printed,
            row.tolerance_widths,
            !row.fitted_to.is_empty(),
        ),
        _ => Verdict::NotComparable,
    };
    let moved = row.recorded.is_some_and(|recorded| recorded != verdict);
    Ok(Judged {
        row: row.clone(),
        file: file.name.clone(),
        computed,
        verdict,
        moved,
        cause,
        left_out,
        outside,
    })
}
