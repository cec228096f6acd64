//! Sources computed once, rows judged.

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

use super::expr::{Computed, Expr, MAX_EVALUATIONS, compute};
use super::rows::{RowFile, ValidationRow};
use super::rule::{Fleet, Group, Printed, Verdict, off, verdict};
use super::source::Source;
use super::store::{Cars, Store, View, once};
use cvtcycle_config::setup::{NamedBy, Options, Setup, load};
use cvtcycle_config::{KeyInfo, Override, Problem, ProblemKind, Problems, Target, rig};
use cvtcycle_model::rig::transmission::Conditions;

/// A row with its result.
#[derive(Clone, Debug)]
pub struct Judged {
    /// The row.
    pub row: ValidationRow,
    /// Its file.
    pub file: String,
    /// Whose number it has.
    pub group: Group,
    /// Computed; none for what cannot be compared, or not for this car.
    pub computed: Option<Computed>,
    /// Why the row cannot be computed.
    pub failure: Option<String>,
    /// Verdict of the rule.
    pub verdict: Verdict,
    /// Whether it is another one than recorded, or the row cannot be computed.
    pub moved: bool,
    /// Number behind the reason.
    pub cause: Option<Computed>,
    /// Why that number cannot be computed.
    pub cause_failure: Option<String>,
    /// Points of its sources left out because the belt slips grossly there.
    pub left_out: usize,
    /// Points that count although they lie outside the validity of a model.
    pub outside: usize,
}

impl Judged {
    /// Distance from the mean of its fleet, with its sign, in standard deviations of one more car.
    #[must_use]
    pub fn z(&self) -> Option<f64> {
        match (self.row.printed?, self.computed.as_ref()?) {
            (Printed::Fleet(fleet), Computed::Number(x)) => Some(fleet.distance(*x)),
            _ => None,
        }
    }

    /// The fleet it is held against.
    #[must_use]
    pub fn fleet(&self) -> Option<Fleet> {
        match self.row.printed? {
            Printed::Fleet(fleet) => Some(fleet),
            _ => None,
        }
    }

    /// Distance from the printed range, in widths of its tolerance.
    #[must_use]
    pub fn off(&self) -> Option<f64> {
        let (row, computed) = (&self.row, self.computed.as_ref()?);
        off(computed, row.printed?, row.tolerance_widths)
    }
}

/// Result of the rows to which no parameter was fitted.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct HeldOut {
    /// Rows.
    pub rows: usize,
    /// Those that agree.
    pub agree: usize,
    /// Rows with a number and a tolerance.
    pub numbers: usize,
    /// Median of their distances in widths of their tolerances; none without numbers.
    pub median_off: Option<f64>,
    /// Numbers within one width, thus agreeing.
    pub numbers_agree: usize,
}

/// All rows.
#[derive(Clone, Debug)]
pub struct Report {
    /// The vehicle that was validated.
    pub candidate: CandidateVehicle,
    /// Rows in order.
    pub rows: Vec<Judged>,
    /// Evaluations that the rows took, of at most [`MAX_EVALUATIONS`].
    pub evaluations: u64,
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

    /// Groups that have rows, in order.
    #[must_use]
    pub fn groups(&self) -> Vec<Group> {
        let has = |group: &Group| self.rows.iter().any(|row| row.group == *group);
        Group::ALL.into_iter().filter(has).collect()
    }

    /// Rows of a group.
    pub fn of_group(&self, group: Group) -> impl Iterator<Item = &Judged> + Clone {
        self.rows.iter().filter(move |row| row.group == group)
    }

    /// Result of the rows of a group to which no parameter was fitted.
    #[must_use]
    pub fn held_out(&self, group: Group) -> HeldOut {
        let rows: Vec<&Judged> = self
            .of_group(group)
            .filter(|row| row.row.is_held_out())
            .collect();
        let agrees = |row: &&&Judged| row.verdict == Verdict::Agrees;
        let numbers = || rows.iter().filter(|row| row.off().is_some());
        let mut off: Vec<f64> = numbers().filter_map(|row| row.off()).collect();
        off.sort_by(f64::total_cmp);
        let (low, high) = (
            off.get(off.len().saturating_sub(1) / 2),
            off.get(off.len() / 2),
        );
        HeldOut {
            rows: rows.len(),
            agree: rows.iter().filter(agrees).count(),
            numbers: off.len(),
            median_off: low.zip(high).map(|(low, high)| f64::midpoint(*low, *high)),
            numbers_agree: numbers().filter(agrees).count(),
        }
    }

    /// Rows whose verdict is another one than recorded.
    pub fn moved(&self) -> impl Iterator<Item = &Judged> {
        self.rows.iter().filter(|row| row.moved)
    }
}

/// Judges the rows of some files for which `wanted` is true.
///
/// # Errors
/// Sources whose vehicle cannot be loaded; more than [`MAX_EVALUATIONS`] evaluations.
///
/// ```
/// use cvtcycle_config::setup::NamedBy;
/// use cvtcycle_validate::{CandidateVehicle, COMMON, Verdict, judge, read};
/// let row = "[[row]]\nid = \"own.1\"\nchapter = \"own\"\nwhat = \"pump displacement\"\n\
///     printed = \"8.57\"\nunit = \"cc/rev\"\nvalue = 8.57\ntolerance = \"rounding\"\n\
///     compute = \"key(transmission.cvt.pump.displacement_cc_rev)\"\n";
/// let files = read(COMMON, &[("own.toml".to_owned(), row.to_owned())])?;
/// let candidate = CandidateVehicle {
///     vehicle: "rover_216_cvt".to_owned(),
///     lubricant: None,
///     engine_oil: None,
///     set: Vec::new(),
///     named_by: NamedBy::Caller,
/// };
/// let report = judge(&files, &candidate, |_| true)?;
/// assert!(report.rows[0].computed.is_some());
/// # Ok::<(), cvtcycle_config::Problems>(())
/// ```
pub fn judge(
    files: &[RowFile],
    candidate: &CandidateVehicle,
    wanted: impl Fn(&ValidationRow) -> bool,
) -> Result<Report, Problems> {
    let cars = FromFiles {
        candidate,
        setups: RefCell::default(),
    };
    // Once for all: a problem of the candidate is no problem of a file.
    load(&candidate.vehicle, &candidate.options(None))?;
    cars.conditions(None)?;
    let mut problems = Problems::new();
    for source in files.iter().flat_map(|file| &file.sources) {
        for problem in cars.problems(source) {
            if !problems.contains(&problem) {
                problems.push(problem);
            }
        }
    }
    if !problems.is_empty() {
        return Err(problems);
    }
    let (rows, evaluations) = judge_rows(files, &cars, wanted)?;
    let candidate = candidate.clone();
    Ok(Report {
        candidate,
        rows,
        evaluations,
    })
}

/// The rows for which `wanted` is true, and the evaluations that they took.
///
/// # Errors
/// More than [`MAX_EVALUATIONS`] evaluations.
pub(super) fn judge_rows(
    files: &[RowFile],
    cars: &dyn Cars,
    wanted: impl Fn(&ValidationRow) -> bool,
) -> Result<(Vec<Judged>, u64), Problem> {
    let store = Store::new(cars);
    let mut rows = Vec::new();
    let views = files
        .iter()
        .map(|file| (file, View::new(&store, &file.sources)));
    let views: Vec<_> = views.collect();
    let all = views
        .iter()
        .flat_map(|(file, view)| file.rows.iter().map(move |row| (file, view, row)));
    for (file, view, row) in all.filter(|(.., row)| wanted(row)) {
        let judged = judged(view, file, row);
        if store.evaluations().is_none() {
            // The rows after it have none left either.
            return Err(exhausted(&judged));
        }
        rows.push(judged);
    }
    Ok((rows, store.evaluations().unwrap_or(MAX_EVALUATIONS)))
}

/// The problem of the row in which the evaluations ran out.
fn exhausted(judged: &Judged) -> Problem {
    let (what, why) = match (&judged.failure, &judged.cause_failure) {
        (Some(why), _) => ("compute", why.as_str()),
        (None, why) => ("cause.compute", why.as_deref().unwrap_or_default()),
    };
    let row = &judged.row;
    let id = &row.id;
    Problem::failed(format!("row {id}: `{what}` cannot be computed: {why}"))
        .kind(ProblemKind::TooLarge)
        .allowed(format!(
            "up to {MAX_EVALUATIONS} evaluations of all rows together"
        ))
        .at(row.place.clone())
        .key(what)
        .names_key()
        .value(row.compute_text.clone())
}

/// A car, or the problems of its files.
type Loaded = Result<Rc<Setup>, Problems>;

/// Cars from their files, each read once.
struct FromFiles<'a> {
    candidate: &'a CandidateVehicle,
    setups: RefCell<HashMap<String, Loaded>>,
}

impl FromFiles<'_> {
    /// Problems of the car and the rig of a source.
    fn problems(&self, source: &Source) -> Problems {
        let rig = || self.conditions(Some(source));
        let loaded = self.setup(Some(source)).and_then(|_| rig());
        loaded.err().unwrap_or_default().map(|problem| {
            let context = format!("source `{}`: ", source.name);
            let placed = problem.place.line > 0;
            let problem = problem.with_context(&context);
            if placed {
                problem
            } else {
                problem.at(source.place.clone())
            }
        })
    }
}

impl Cars for FromFiles<'_> {
    fn setup(&self, source: Option<&Source>) -> Result<Rc<Setup>, Problems> {
        let vehicle = self.candidate.vehicle_of(source);
        let options = self.candidate.options(source);
        let key = format!("{vehicle} {options:?}");
        once(&self.setups, key, || load(vehicle, &options).map(Rc::new))
    }

    fn conditions(&self, source: Option<&Source>) -> Result<(Conditions, Vec<KeyInfo>), Problems> {
        self.candidate.conditions(source)
    }
}

/// A number, or why it cannot be computed.
fn computed(expr: Option<&Expr>, view: &View) -> (Option<Computed>, Option<String>) {
    match expr.map(|expr| compute(expr, view)) {
        Some(Ok(number)) => (Some(number), None),
        Some(Err(why)) => (None, Some(why)),
        None => (None, None),
    }
}

fn judged(view: &View, file: &RowFile, row: &ValidationRow) -> Judged {
    view.begin();
    let (number, failure) = computed(row.compute.as_ref(), view);
    let (left_out, outside) = view.noted();
    let (cause, cause_failure) = computed(row.cause.as_ref().map(|cause| &cause.compute), view);
    let fitted = !row.fitted_to.is_empty();
    let verdict = match (&number, row.printed) {
        _ if failure.is_some() => Verdict::NotComputed,
        (Some(number), Some(printed)) => verdict(number, printed, row.tolerance_widths, fitted),
        _ => Verdict::NotComparable,
    };
    let verdict = match (verdict, row.recorded) {
        (Verdict::Agrees, Some(Verdict::Identity)) => Verdict::Identity,
        (other, _) => other,
    };
    let expected = row.recorded.unwrap_or(verdict);
    Judged {
        row: row.clone(),
        file: file.name.clone(),
        group: file.group,
        computed: number,
        moved: expected != verdict || failure.is_some(),
        failure,
        verdict,
        cause,
        cause_failure,
        left_out,
        outside,
    }
}

/// Vehicle of all sources that name none, with its fluids and overrides.
#[derive(Clone, Debug, Default)]
pub struct CandidateVehicle {
    /// Name or path.
    pub vehicle: String,
    /// Transmission oil in place of its own.
    pub lubricant: Option<String>,
    /// Engine oil in place of its own.
    pub engine_oil: Option<String>,
    /// Overrides.
    pub set: Vec<Override>,
    /// What gives the names of vehicle and fluids.
    pub named_by: NamedBy,
}

impl CandidateVehicle {
    /// Name or path of the vehicle of a source.
    #[must_use]
    pub fn vehicle_of<'a>(&'a self, source: Option<&'a Source>) -> &'a str {
        let own = source.and_then(|source| source.vehicle.as_deref());
        own.unwrap_or(&self.vehicle)
    }

    /// Options of the vehicle of a source.
    #[must_use]
    pub fn options(&self, source: Option<&Source>) -> Options {
        let own = source.is_none_or(|source| source.vehicle.is_none());
        let mut set = self.overrides(source);
        set.drain(..if own { 0 } else { self.set.len() });
        set.retain(|by| by.target() != Target::Rig);
        let lubricant = source.and_then(|source| source.lubricant.clone());
        Options {
            lubricant: lubricant.or_else(|| self.lubricant.clone().filter(|_| own)),
            engine_oil: self.engine_oil.clone().filter(|_| own),
            set,
            formulation: source.map(|source| source.formulation).unwrap_or_default(),
            named_by: if own { self.named_by } else { NamedBy::File },
        }
    }

    /// Overrides of the candidate, then those of a source.
    #[must_use]
    pub fn overrides(&self, source: Option<&Source>) -> Vec<Override> {
        let own = source.map_or(&[][..], |source| &source.set);
        self.set.iter().chain(own).cloned().collect()
    }

    /// Settings of the transmission rig for a source.
    ///
    /// # Errors
    /// The problems of its values.
    pub fn conditions(
        &self,
        source: Option<&Source>,
    ) -> Result<(Conditions, Vec<KeyInfo>), Problems> {
        rig::load(&self.overrides(source))
    }
}
