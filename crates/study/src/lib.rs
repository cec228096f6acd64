//! Many runs: plans, designs, execution on all cores, tables in whole parts, and the statistics that answer the question.
//!
//! A *point* of a design fixes the value of every factor. At a point the subject and all baselines drive, with the same draw: one *run*
//! each, one row of the table each. What a point is follows from the plan, the seed and its index alone, so that points can be computed in
//! any order, on any number of threads, and again after an interruption.
//!
//! | module | contents |
//! |---|---|
//! | `plan` | a TOML file to a plan: cars, factors, design |
//! | `design` | from the index of a point to a level of each factor |
//! | `execute` | a plan to a study with its cars loaded and every value tried; its points on all cores, in whole parts |
//! | `store` | tables of columns; parts and results on disk, whole or absent; reading and exporting them |
//! | `statistics` | pure functions: description, Sobol indices, tornado, ranks |
//! | `answer` | what the study says, from its table by car and point |
//! | `words` | results in sentences, with what is known of how sure they are and which published number they contradict |
//! | `attribute` | what each loss costs: the car driven again without it |
//! | `optimum` | the least fuel that any controller of ratio and clamp can burn, and the operating line near it |
//! | `levers` | changes of a design, each next to the car as it is, with the same draws |
//! | `label` | figures of a fuel label, from the car's own tests |
//! | `run` | the summary of a run with all that is said of it |
//! | `family` | one car with other numbers, as a function of them |
//! | `explain` | what a key, a column, a flag or an equation means |
//! | `sensitivity` | every value of a car changed by itself |
//! | `points` | the belt at points of a table |
//! | `check` | comparison with published values |
//! | `fit` | parameters fitted to measurements |
//! | `equations` | the labelled equations of model and statistics |

pub mod answer;
pub mod attribute;
pub mod check;
pub mod fit;
pub mod label;
pub mod optimum;
pub mod levers;
pub mod points;
pub mod run;
pub mod sensitivity;
pub mod design;
pub mod equations;
pub mod execute;
pub mod explain;
pub mod family;
pub mod plan;
pub mod statistics;
pub mod store;
pub mod words;

pub use answer::{Answer, StudyTable, TableSource, answer};
pub use execute::{End, PartWriter, Study, StudyCar, StudyManifest};

/// Receives progress from several threads at once.
pub trait Progress: Sync {
    /// Counts finished units of work: runs of a study, evaluations of a fit.
    fn advance(&self, count: u64);

    /// True if the computation is to stop now. What is finished is kept.
    fn stopped(&self) -> bool;
}

/// Ignores progress and never stops.
#[derive(Clone, Copy, Debug)]
pub struct NoProgress;

impl Progress for NoProgress {
    fn advance(&self, _: u64) {}

    fn stopped(&self) -> bool {
        false
    }
}
