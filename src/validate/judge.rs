//! Sources computed once, rows judged.

use std::cell::{Cell, RefCell};
use std::collections::HashMap;
use std::rc::Rc;

use super::expr::{Computed, Table, Tables, compute};
use super::row::{File, Row};
use super::rule::{Verdict, verdict};
use super::source::{Kind, Source};
use super::tables::{self, Driven};
use crate::config::{KeyInfo, Place, Problem};
use crate::rig::transmission::Conditions;
use crate::rig::transmission::conditions::PREFIX;
use crate::setup::{Options, Setup, load};

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
        self.rows.iter().filter(|row| row.verdict == verdict).count()
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
pub fn judge(files: &[File], subject: &Subject, wanted: impl Fn(&Row) -> bool) -> Result<Report, Vec<Problem>> {
    let store = Store { subject, setups: RefCell::default(), runs: RefCell::default(), tables: RefCell::default() };
    let mut problems = Vec::new();
    // Once for all: what is wrong with the subject is no problem of a file.
    if let Err(mut p) = load(&subject.vehicle, "--vehicle", &store.options(None)) {
        problems.append(&mut p);
        return Err(problems);
    }
    store.conditions(None)?;
    for source in files.iter().flat_map(|file| &file.sources) {
        let loaded = store.setup(Some(source)).and_then(|_| store.conditions(Some(source)));
        if let Err(found) = loaded {
            for problem in found.iter() {
                let place = if problem.place.line > 0 { problem.place.clone() } else { source.place.clone() };
                let problem = Problem { place, message: format!("source `{}`: {}", source.name, problem.message), ..problem.clone() };
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
        let view = View { store: &store, file, left_out: Cell::default(), outside: Cell::default() };
        for row in file.rows.iter().filter(|row| wanted(row)) {
            match view.judged(row) {
                Ok(judged) => rows.push(judged),
                Err(problem) => problems.push(problem),
            }
        }
    }
    if problems.is_empty() { Ok(Report { subject: subject.clone(), rows }) } else { Err(problems) }
}

type Shared<T, E> = Rc<Result<T, E>>;

/// Everything that was computed, shared by all rows and files: sources of equal contents are one.
struct Store<'a> {
    subject: &'a Subject,
    setups: RefCell<HashMap<String, Shared<Setup, Vec<Problem>>>>,
    runs: RefCell<HashMap<String, Shared<Driven, String>>>,
    tables: RefCell<HashMap<String, Result<Rc<Table>, String>>>,
}

/// The value for a key, made once.
fn once<T: Clone>(map: &RefCell<HashMap<String, T>>, key: String, make: impl FnOnce() -> T) -> T {
    if let Some(found) = map.borrow().get(&key) {
        return found.clone();
    }
    let made = make();
    map.borrow_mut().insert(key, made.clone());
    made
}

impl Store<'_> {
    fn options(&self, source: Option<&Source>) -> Options {
        let own = source.is_none_or(|source| source.vehicle.is_none());
        let subject_set = if own { self.subject.set.as_slice() } else { &[] };
        let source_set = source.map(|source| source.set.as_slice()).unwrap_or_default();
        let lubricant = source.and_then(|source| source.lubricant.clone());
        Options {
            lubricant: lubricant.or_else(|| self.subject.lubricant.clone().filter(|_| own)),
            engine_oil: None,
            set: subject_set.iter().chain(source_set).filter(|set| !set.starts_with(PREFIX)).cloned().collect(),
            formulation: source.map(|source| source.formulation).unwrap_or_default(),
        }
    }

    fn setup(&self, source: Option<&Source>) -> Result<Rc<Result<Setup, Vec<Problem>>>, Vec<Problem>> {
        let vehicle = source.and_then(|source| source.vehicle.as_deref()).unwrap_or(&self.subject.vehicle);
        let options = self.options(source);
        let shared = once(&self.setups, format!("{vehicle} {options:?}"), || Rc::new(load(vehicle, "vehicle", &options)));
        if let Err(problems) = shared.as_ref() {
            return Err(problems.clone());
        }
        Ok(shared)
    }

    /// What the transmission rig is set to, for a source.
    fn conditions(&self, source: Option<&Source>) -> Result<(Conditions, Vec<KeyInfo>), Vec<Problem>> {
        let own = source.map(|source| source.set.as_slice()).unwrap_or_default();
        let sets: Vec<String> = self.subject.set.iter().chain(own).cloned().collect();
        Conditions::load(&sets)
    }

    fn table(&self, source: &Source, totals: bool) -> Result<Rc<Table>, String> {
        let bare = Source { name: String::new(), place: Place::default(), ..source.clone() };
        once(&self.tables, format!("{totals} {bare:?}"), || self.compute(&bare, totals).map(Rc::new))
    }

    fn compute(&self, source: &Source, totals: bool) -> Result<Table, String> {
        let shared = self.setup(Some(source)).map_err(|_| "its vehicle cannot be loaded".to_owned())?;
        let Ok(setup) = shared.as_ref() else {
            return Err("its vehicle cannot be loaded".to_owned());
        };
        if source.kind != Kind::Run {
            let (conditions, _) = self.conditions(Some(source)).map_err(|_| "the rig's conditions cannot be read".to_owned())?;
            return tables::table(source, setup, &conditions);
        }
        // Phases of the same run share it.
        let whole = Source { phase: String::new(), ..source.clone() };
        let driven = once(&self.runs, format!("{whole:?}"), || Rc::new(tables::drive(&whole, setup)));
        match driven.as_ref() {
            Ok(driven) => tables::of_run(source, driven, totals),
            Err(why) => Err(why.clone()),
        }
    }
}

/// The store as one file sees it.
struct View<'a> {
    store: &'a Store<'a>,
    file: &'a File,
    left_out: Cell<usize>,
    outside: Cell<usize>,
}

impl Tables for View<'_> {
    fn table(&self, source: usize, totals: bool) -> Result<Rc<Table>, String> {
        let spec = self.file.sources.get(source).ok_or("no such source")?;
        self.store.table(spec, totals).map_err(|why| format!("source `{}`: {why}", spec.name))
    }

    fn key(&self, source: Option<usize>, path: &str, item: Option<usize>) -> Result<f64, String> {
        let spec = source.and_then(|k| self.file.sources.get(k));
        if path.starts_with(PREFIX) {
            let (_, keys) = self.store.conditions(spec).map_err(|_| "the rig's conditions cannot be read".to_owned())?;
            let info = keys.iter().find(|info| info.key == path).ok_or_else(|| format!("the rig has no `{path}`"))?;
            return number_of(info, item).ok_or_else(|| format!("`{path}` is no number here: {}", info.value));
        }
        let shared = self.store.setup(spec).map_err(|_| "the vehicle cannot be loaded".to_owned())?;
        let Ok(setup) = shared.as_ref() else {
            return Err("the vehicle cannot be loaded".to_owned());
        };
        let info =
            setup.keys.iter().find(|info| info.key == path).ok_or_else(|| format!("the vehicle `{}` has no `{path}`", setup.name))?;
        number_of(info, item).ok_or_else(|| format!("`{path}` is no number here: {}", info.value))
    }

    fn left_out(&self, rows: usize) {
        self.left_out.set(self.left_out.get() + rows);
    }

    fn outside(&self, rows: usize) {
        self.outside.set(self.outside.get() + rows);
    }
}

/// A key's number in its own unit, an item of a list, 1 and 0 for true and false.
fn number_of(info: &KeyInfo, item: Option<usize>) -> Option<f64> {
    match (info.value.as_str(), item) {
        ("true", None) => Some(1.0),
        ("false", None) => Some(0.0),
        (value, None) => value.parse().ok(),
        (value, Some(k)) => {
            let inner = value.strip_prefix('[')?.strip_suffix(']')?;
            inner.split(',').nth(k)?.trim().parse().ok()
        }
    }
}

impl View<'_> {
    fn judged(&self, row: &Row) -> Result<Judged, Problem> {
        let problem = |what: &str, why: String| Problem {
            place: row.place.clone(),
            key: what.to_owned(),
            value: row.compute_text.clone(),
            message: format!("row {}: `{what}` cannot be computed: {why}", row.id),
            ..Problem::default()
        };
        self.left_out.set(0);
        self.outside.set(0);
        let computed = row.compute.as_ref().map(|expr| compute(expr, self)).transpose().map_err(|why| problem("compute", why))?;
        let (left_out, outside) = (self.left_out.get(), self.outside.get());
        let cause =
            row.cause.as_ref().map(|cause| compute(&cause.compute, self)).transpose().map_err(|why| problem("cause.compute", why))?;
        let verdict = match (&computed, row.printed) {
            (Some(computed), Some(printed)) => verdict(computed, printed, row.tolerance_widths, !row.fitted_to.is_empty()),
            _ => Verdict::NotComparable,
        };
        let moved = row.recorded.is_some_and(|recorded| recorded != verdict);
        Ok(Judged { row: row.clone(), file: self.file.name.clone(), computed, verdict, moved, cause, left_out, outside })
    }
}
