//! Plan of a study, read from a TOML file and checked.
//!
//! | file | contents |
//! |---|---|
//! | `keys` | every key of a plan: unit, range, options, default, meaning |
//! | `read` | the head of a plan, and all its parts together |
//! | `write` | a plan as TOML |
//! | `form` | one `[[form]]`, and the factors that act in its draws alone |
//! | `factor`, `values` | one `[[factor]]` and its list, range or distribution |
//! | `options` | what the run options allow, as factors and at the head |
//! | `design` | the design's own keys, and what concerns all factors at once |
//! | `distribution` | equations of the distributions |

mod design;
mod distribution;
mod factor;
mod form;
mod keys;
mod options;
mod places;
mod read;
mod values;
mod write;

pub use cvtcycle_config::Acts;
pub use cvtcycle_config::embedded::plans as embedded_plans;
use cvtcycle_config::setup::{Kind, NamedBy, text_of};
pub use design::{MAX_SOBOL_DIMENSIONS, MAX_SOBOL_SAMPLES};
pub(crate) use factor::unit;
pub(crate) use keys::STUDY;
pub use keys::{MAX_SAMPLES, PLAN};
pub use keys::{STATUSES, lubricants};
pub use places::Places;
pub use write::Axis;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use cvtcycle_config::{Override, Place, Problems};
use cvtcycle_model::transmission::cvt::variator::Formulation;

/// A whole plan.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Name of the file, as problems cite it.
    pub file: String,
    /// Text of the file, byte for byte.
    pub text: String,
    /// Name for people.
    pub title: String,
    /// The question that the study is to answer, in words; may be empty.
    pub question: String,
    /// Inputs of the runs where no factor says otherwise.
    pub base: Base,
    /// Inputs that are varied.
    pub factors: Vec<Factor>,
    /// Forms of a law, of which each draw has one; empty where there is one form only.
    pub forms: Vec<Form>,
    /// Combinations that are driven.
    pub design: Design,
    /// Data kept of each run in addition to its summary.
    pub keep: Keep,
    /// Columns of the summary that are analysed, in their order; the fuel columns if there are none.
    pub analyse: Vec<String>,
    /// Number of runs above which the user must agree.
    pub most_runs: u64,
    /// A factor does not act on a car that does not have its key; else the study does not begin.
    pub skip_missing: bool,
    /// True clamps a number outside the range of its key to that range; else the study does not begin.
    pub clip: bool,
    /// Cars of the subject's factors by the kind of box: `Some(true)` every car with a CVT, `Some(false)` every manual one; the factors
    /// of the baselines act on all others. `None`: subject and baselines by their roles.
    pub by_box: Option<bool>,
    /// Places of the keys of `[study]`; `design` is the place of the design's table.
    pub places: Places,
}

/// Cars and conditions of all runs; paths are relative to the plan's folder.
#[derive(Clone, Debug)]
pub struct Base {
    /// Subject, name or path.
    pub vehicle: String,
    /// Baselines, names or paths; those of the vehicle's file if none are given.
    pub baselines: Option<Vec<String>>,
    /// Cycle, name or path.
    pub cycle: String,
    /// Ambient temperature, degC.
    pub ambient_degc: f64,
    /// `soak`, `warm` or a temperature in degC.
    pub start: String,
    /// Transmission oil of the subject.
    pub lubricant: Option<String>,
    /// Engine oil of all cars.
    pub engine_oil: Option<String>,
    /// Overrides of the subject, `KEY=VALUE`.
    pub set: Vec<Override>,
    /// Overrides of all cars, `KEY=VALUE`.
    pub set_all: Vec<Override>,
    /// Largest step, s.
    pub dt_s: f64,
    /// Reading of the belt model.
    pub formulation: Formulation,
}

/// One of several forms of a law: the factors that name it act in its draws alone.
#[derive(Clone, Debug)]
pub struct Form {
    /// Name by which factors belong to it.
    pub name: String,
    /// Name for people.
    pub title: String,
    /// Weight against the other forms.
    pub weight: f64,
    /// Data that it was fitted to, and how well.
    pub source: String,
    /// Part of the draws that have it, from 0 to 1 (DE-10).
    pub span: Span,
    /// Place of its name.
    pub place: Place,
}

/// Part of all draws: from the first share, up to but without the second.
pub type Span = [f64; 2];

/// The form that a factor belongs to.
#[derive(Clone, Debug, PartialEq)]
pub struct OfForm {
    /// Name of the form.
    pub name: String,
    /// Its part of the draws.
    pub span: Span,
}

/// One thing that is varied.
#[derive(Clone, Debug)]
pub struct Factor {
    /// A run option ([`RUN_OPTIONS`]) or a dotted key of the vehicle, `lubricant.` or `engine_oil.`.
    pub key: String,
    /// Short name for tables and plots; the key unless given.
    pub name: String,
    /// Unit of its numbers: the key's, `-` where they multiply, `K` where they are added to a temperature. Empty for words: either all
    /// values of a factor are numbers and there is a unit, or all are words.
    pub unit: String,
    /// Cars that the value acts on.
    pub cars: Cars,
    /// Action of a number on the value of the car's file.
    pub acts: Acts,
    /// The values.
    pub values: FactorValues,
    /// The form in whose draws alone it acts; none for a factor of all draws.
    pub form: Option<OfForm>,
    /// `source`, `derived`, `fitted` or `assumed`: how the values are known; empty if not said, which no distribution leaves.
    pub status: String,
    /// Reason or reference for them.
    pub source: String,
    /// The test that would tell the value, in words; may be empty.
    pub test: String,
    /// Place of its key in the plan.
    pub place: Place,
    /// Places of its values: `values` and its items, `range`, `distribution` and `distribution.low` or the like.
    pub places: Places,
}

/// Factors that are no keys of a file. They are of all cars, but for the lubricant.
pub const RUN_OPTIONS: [&str; 7] = [
    "ambient_degc",
    "start",
    "cycle",
    "lubricant",
    "engine_oil",
    "dt_s",
    "formulation",
];

/// The cars that a factor changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Cars {
    /// The subject alone, as `--set`.
    Subject,
    /// The baselines alone.
    Baselines,
    /// All cars with the same draw, as `--set-all`.
    All,
}

/// A value of a factor, in the unit of its key.
#[derive(Clone, Debug, PartialEq)]
pub enum FactorValue {
    /// A number.
    Number(f64),
    /// A word, or any other TOML value as written.
    Word(Arc<str>),
}

/// The values that a factor takes.
#[derive(Clone, Debug, PartialEq)]
pub enum FactorValues {
    /// These, equally likely where they are drawn.
    List(Vec<FactorValue>),
    /// Numbers of a distribution.
    Distribution(Distribution),
}

/// A distribution of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Distribution {
    /// Normal.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation.
        sd: f64,
    },
    /// Normal, cut off at both ends and raised to probability 1 between them.
    TruncatedNormal {
        /// Mean before the cut.
        mean: f64,
        /// Standard deviation before the cut.
        sd: f64,
        /// Least value.
        low: f64,
        /// Largest value.
        high: f64,
    },
    /// Uniform.
    Uniform {
        /// Least value.
        low: f64,
        /// Largest value.
        high: f64,
    },
    /// Triangular.
    Triangular {
        /// Least value.
        low: f64,
        /// Most likely value.
        mode: f64,
        /// Largest value.
        high: f64,
    },
    /// Lognormal.
    Lognormal {
        /// Median.
        median: f64,
        /// Geometric standard deviation: 68 % lie between median / g and median g.
        geometric_sd: f64,
    },
}

impl Plan {
    /// Reads and checks a plan; `file` is the name under which problems cite it. Names of cars, fluids and cycles that the program carries
    /// are checked; files that the plan names are not opened, and keys of cars and names of result columns are not known here.
    ///
    /// ```
    /// use cvtcycle_study::plan::Plan;
    /// let text = "study.design = \"grid\"\n[[factor]]\nkey = \"ambient_degc\"\nvalues = [-10, 25]\n";
    /// let plan = Plan::read("plan.toml", text)?;
    /// assert_eq!((plan.design.points(&plan.factors), plan.span(0)), (Some(2), Some((-10.0, 25.0))));
    /// # Ok::<(), cvtcycle_config::Problems>(())
    /// ```
    ///
    /// # Errors
    /// All problems with their places.
    pub fn read(file: &str, text: &str) -> Result<Plan, Problems> {
        read::plan(file, text)
    }

    /// The plan of that name or path.
    ///
    /// # Errors
    /// Unknown name, unreadable file, or all problems of the plan.
    pub fn open(word: &str) -> Result<Plan, Problems> {
        let (file, text, _) = text_of(word, Kind::Plan, NamedBy::Caller)?;
        Plan::read(&file, &text)
    }

    /// Index of the form of a point; none where nothing is drawn, or in a plan without forms.
    pub fn form_of(&self, point: u64) -> Option<usize> {
        let share = self.design.form_share(point, self.factors.len())?;
        self.forms.iter().position(|form| within(form.span, share))
    }

    /// The forms, where there are several and a factor of them is drawn; else none.
    pub fn forms_drawn(&self) -> &[Form] {
        let is_drawn = self.factors.iter().any(|factor| factor.form.is_some());
        match is_drawn && self.forms.len() > 1 {
            true => &self.forms,
            false => &[],
        }
    }

    /// Least and largest number that a factor takes in this plan; none for words. Exact, but for distributions drawn more than 2^20
    /// times ([`Design::share_span`]).
    pub fn span(&self, factor: usize) -> Option<(f64, f64)> {
        let values = &self.factors.get(factor)?.values;
        match values {
            FactorValues::List(list) => {
                let numbers = list.iter().filter_map(FactorValue::number).map(|x| (x, x));
                numbers.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
            }
            FactorValues::Distribution(distribution) => {
                let (low, high) = self.design.share_span(&self.factors, factor);
                let at = |share| distribution.inverse_cdf(share);
                Some((at(low), at(high)))
            }
        }
    }
}

/// True if a share is part of a span.
pub(crate) fn within([from, to]: Span, share: f64) -> bool {
    from <= share && share < to
}

impl FactorValues {
    /// The entries of a list; none of a distribution.
    pub fn list(&self) -> &[FactorValue] {
        match self {
            FactorValues::List(list) => list,
            FactorValues::Distribution(_) => &[],
        }
    }

    /// The values, all as words where there are numbers and words.
    pub fn unmixed(self) -> Self {
        match self {
            FactorValues::List(list) if !list.iter().all(FactorValue::is_number) => {
                let words = list.iter().map(|value| FactorValue::Word(value.text()));
                FactorValues::List(words.collect())
            }
            other => other,
        }
    }

    /// True if the values are numbers.
    pub fn are_numbers(&self) -> bool {
        self.list().iter().all(FactorValue::is_number)
    }
}

impl Factor {
    /// Number of the entry of its list that is a value, counted from 1; 0 where there is none.
    pub(crate) fn entry_of(&self, value: &FactorValue) -> usize {
        let at = self.values.list().iter().position(|entry| entry == value);
        at.map_or(0, |k| k + 1)
    }

    /// Gives the value where a design puts it; `None` for the value of the car's own file.
    pub fn value(&self, level: Level) -> Option<FactorValue> {
        match (&self.values, level) {
            (_, Level::Base) => None,
            (FactorValues::List(list), Level::Entry(entry)) => list.get(entry).cloned(),
            (FactorValues::List(list), Level::Share(share)) => {
                let entry = (share * list.len() as f64) as usize;
                list.get(entry.min(list.len().saturating_sub(1))).cloned()
            }
            (FactorValues::Distribution(distribution), Level::Share(share)) => {
                Some(FactorValue::Number(distribution.inverse_cdf(share)))
            }
            (FactorValues::Distribution(_), Level::Entry(_)) => None,
        }
    }
}

/// Position of a factor at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Level {
    /// Not varied: the value of the car's file.
    Base,
    /// An entry of its list.
    Entry(usize),
    /// A probability, within 0 and 1, at which its distribution (or list, equally likely) is read.
    Share(f64),
}

/// Combinations of values that are driven.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Design {
    /// Every value of each factor with every value of the others, the last factor fastest.
    Grid,
    /// The base, then each factor by itself: every value of a list, or two quantiles of a distribution.
    OneAtATime {
        /// Lower quantile of distributions; the upper one is 1 minus it.
        quantile: f64,
    },
    /// Latin hypercube.
    LatinHypercube {
        /// Points.
        samples: u64,
        /// Seed.
        seed: u64,
    },
    /// Owen-scrambled Sobol sequence.
    Sobol {
        /// Points.
        samples: u64,
        /// Seed.
        seed: u64,
    },
    /// Independent draws.
    MonteCarlo {
        /// Points.
        samples: u64,
        /// Seed.
        seed: u64,
    },
    /// Saltelli's blocks for Sobol indices: A, B and, for each factor, A with that factor's column from B.
    Saltelli {
        /// Base samples N; N (factors + 2) points.
        samples: u64,
        /// Seed.
        seed: u64,
    },
}

/// Data kept of each run in addition to its row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Keep {
    /// Nothing.
    Summary,
    /// Some columns of the trace, by name.
    Columns(Vec<String>),
    /// Every column of the trace.
    Everything,
}
