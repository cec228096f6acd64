//! The plan of a calibration, read from a TOML file and checked.
//!
//! | file | content |
//! |---|---|
//! | `keys` | the keys of a plan |
//! | `read` | the head of a plan, all its parts together, and what is wrong between them |
//! | `parameter` | one `[[parameter]]` |
//! | `group`, `files` | one `[[data]]` to observations |

mod files;
mod group;
pub mod keys;
mod parameter;
mod read;

pub(super) use read::stem;
pub use read::{gather, load, read};

use std::sync::Arc;

use crate::solve::{Options, Prior};
use cvtcycle_config::{Place, Problem, ProblemKind};
use cvtcycle_model::rig::BenchPoint;
use cvtcycle_validate::CandidateVehicle;
use cvtcycle_validate::checks::FileNames;
use cvtcycle_validate::expr::Expr;
use cvtcycle_validate::rows::RowFile;
use cvtcycle_validate::source::Source;

/// A parameter that is fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeParameter {
    /// Dotted key, as `--set` has it.
    pub key: String,
    /// Other keys that the number sets, in each vehicle that has them.
    pub also: Vec<String>,
    /// Vehicles that have the number in common, by name or path; none for the plan's own.
    pub vehicles: Vec<String>,
    /// Least value, in the unit of the key.
    pub low: f64,
    /// Largest value.
    pub high: f64,
    /// First value; that of the file for none.
    pub start: Option<f64>,
    /// Knowledge of it without the data.
    pub prior: Option<Prior>,
    /// How the prior is known; empty without one.
    pub status: &'static str,
    /// Reason or reference for bounds and prior.
    pub source: String,
    /// Place of its key.
    pub place: Place,
    /// Place of its other keys.
    pub also_place: Place,
    /// Places of its bounds.
    pub bounds: [Place; 2],
}

impl FreeParameter {
    /// All keys that the number sets: its own first.
    pub fn keys(&self) -> impl Iterator<Item = &str> {
        std::iter::once(&self.key)
            .chain(&self.also)
            .map(String::as_str)
    }

    /// True if a vehicle has this number.
    #[must_use]
    pub fn is_of(&self, vehicle: &str, plan: &CalibrationPlan) -> bool {
        match self.vehicles.is_empty() {
            true => vehicle == plan.car.vehicle,
            false => self.vehicles.iter().any(|own| own == vehicle),
        }
    }

    /// Name among the parameters of a plan: the key, with the vehicles where they are not the plan's own.
    #[must_use]
    pub fn name(&self, plan: &CalibrationPlan) -> String {
        if self.is_of(&plan.car.vehicle, plan) {
            return self.key.clone();
        }
        let names: Vec<String> = self.vehicles.iter().map(|word| stem(word)).collect();
        format!("{} of {}", self.key, names.join(", "))
    }
}

/// A group of data: one `[[data]]`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Group {
    /// Name, unique within the plan.
    pub name: String,
    /// Where the data come from.
    pub from: String,
    /// Standard deviation of an error that all its observations have in common, in their unit.
    pub common_sd: Option<f64>,
    /// Place of the group.
    pub place: Place,
}

/// Measured value, or range of values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measured {
    /// A number.
    Value(f64),
    /// Somewhere from one number to another; an end may be infinite.
    Within(f64, f64),
}

impl Measured {
    /// A number, or a range if the ends differ.
    #[must_use]
    pub fn between(low: f64, high: f64) -> Self {
        if low < high {
            Measured::Within(low, high)
        } else {
            Measured::Value(low)
        }
    }

    /// The number, the middle of a range, or the finite end of an open one.
    #[must_use]
    pub fn size(self) -> f64 {
        match self {
            Measured::Within(low, high) if low.is_finite() && high.is_finite() => {
                f64::midpoint(low, high)
            }
            Measured::Within(low, high) if !low.is_finite() => high,
            Measured::Value(x) | Measured::Within(x, _) => x,
        }
    }

    /// Distance of a computed number, positive above what was measured; 0 within a range.
    #[must_use]
    pub fn distance(self, computed: f64) -> f64 {
        match self {
            Measured::Value(x) => computed - x,
            Measured::Within(low, _) if computed < low => computed - low,
            Measured::Within(_, high) if computed > high => computed - high,
            Measured::Within(..) if computed.is_nan() => f64::NAN,
            Measured::Within(..) => 0.0,
        }
    }
}

/// How an observation is computed.
#[derive(Clone, Debug, PartialEq)]
pub enum Observable {
    /// An expression over one of the lists of sources.
    Expression {
        /// Index of the list in [`CalibrationPlan::views`].
        view: usize,
        /// The expression; it gives a number.
        expr: Arc<Expr>,
    },
    /// A column of a point on the bench.
    Point {
        /// Index in [`CalibrationPlan::benches`].
        bench: usize,
        /// Row of its points.
        row: usize,
        /// Column of the bench's table.
        column: usize,
    },
    /// A column of a trace at a time, straight between its rows.
    Trace {
        /// Index in [`CalibrationPlan::runs`].
        run: usize,
        /// Column of its table.
        column: usize,
        /// Time, s.
        time_s: f64,
    },
    /// A total of a run.
    Total {
        /// Index in [`CalibrationPlan::runs`].
        run: usize,
        /// Column of its totals.
        column: usize,
    },
}

/// One measured number.
#[derive(Clone, Debug, PartialEq)]
pub struct Observation {
    /// Index of its group.
    pub group: usize,
    /// Index of its fold: the observations that are left out together.
    pub fold: usize,
    /// Short name: identifier of a row, or column and line of a file.
    pub label: String,
    /// Meaning of the observation, in words; may be empty.
    pub what: String,
    /// Name of the measured column; empty for expressions.
    pub column: String,
    /// Unit.
    pub unit: String,
    /// Measured.
    pub measured: Measured,
    /// Standard deviation as given.
    pub sd: f64,
    /// Standard deviation that counts in the fit: larger where neighbours in time say the same thing.
    pub weight_sd: f64,
    /// How it is computed.
    pub observable: Observable,
    /// Place of the measured number.
    pub place: Place,
}

impl Observation {
    /// Without group and fold, words, unit and place.
    pub(super) fn new(label: String, measured: Measured, sd: f64, observable: Observable) -> Self {
        Observation {
            group: 0,
            fold: 0,
            label,
            what: String::new(),
            column: String::new(),
            unit: String::new(),
            measured,
            sd,
            weight_sd: sd,
            observable,
            place: Place::default(),
        }
    }
}

/// Points on the bench of one file.
#[derive(Clone, Debug)]
pub struct BenchPoints {
    /// Car of the points: overrides, fluid, parts.
    pub source: Source,
    /// Points.
    pub points: Vec<BenchPoint>,
}

/// A whole plan.
#[derive(Clone, Debug, Default)]
pub struct CalibrationPlan {
    /// Name of the file as problems cite it.
    pub file: String,
    /// Text of the file.
    pub text: String,
    /// Name for people.
    pub title: String,
    /// Vehicle whose values are fitted, with fluids and overrides that are held during the fit.
    pub car: CandidateVehicle,
    /// How the search is done.
    pub search: Options,
    /// True if each fold is predicted by a fit to the others.
    pub leave_out: bool,
    /// Free parameters.
    pub parameters: Vec<FreeParameter>,
    /// Groups of data.
    pub groups: Vec<Group>,
    /// Names of the folds.
    pub folds: Vec<String>,
    /// Observations in the order of the plan and of its files.
    pub observations: Vec<Observation>,
    /// Lists of sources that expressions count in: the plan's own, then those of each file of validation rows.
    pub views: Vec<Vec<Source>>,
    /// Points on the bench.
    pub benches: Vec<BenchPoints>,
    /// Runs whose traces or totals are observed.
    pub runs: Vec<Source>,
    /// Identifiers of the validation rows that are used.
    pub rows: Vec<String>,
    /// Data files that were read: path as cited, and bytes' SHA-256.
    pub files: Vec<(String, String)>,
    /// Place of the head.
    pub place: Place,
    /// Places of vehicle, transmission oil, engine oil and overrides; the head's where they are absent.
    pub places: [Place; 4],
}

/// Context that the groups of a plan may use.
pub(super) struct Context<'a> {
    /// The plan's own sources, then the common ones.
    pub names: &'a FileNames<'a>,
    /// Validation rows of the program.
    pub rows: &'a [RowFile],
    /// The plan, as problems cite it.
    pub file: &'a str,
    /// Benches and runs of the groups before, from which the indices of the observations go on.
    pub benches: usize,
    pub runs: usize,
}

/// Content of a group.
#[derive(Default)]
pub(super) struct Found {
    pub group: Group,
    /// Fold of each observation by name.
    pub folds: Vec<String>,
    pub observations: Vec<Observation>,
    pub benches: Vec<BenchPoints>,
    pub runs: Vec<Source>,
    /// Identifiers of validation rows.
    pub rows: Vec<String>,
    /// Path and SHA-256 of each file.
    pub files: Vec<(String, String)>,
}

/// A problem of a plan at a place.
pub(super) fn problem(
    kind: ProblemKind,
    place: &Place,
    key: &str,
    allowed: &str,
    message: String,
    hint: &str,
) -> Problem {
    Problem::new(kind, message)
        .at(place.clone())
        .key(key)
        .allowed(allowed)
        .hint(hint)
}
