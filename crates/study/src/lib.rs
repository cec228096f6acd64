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
//! | `prepare`, `cars`, `check` | a plan to a study: cars loaded once, every value tried |
//! | `point` | one point: cars changed, driven, rows filled |
//! | `traces` | rows of runs to columns, as they are driven |
//! | `execute` | parts of points on all cores, written while the next is computed |
//! | `outputs` | the numbers of a row: one table of names, units, getters |
//! | `table` | columns in memory |
//! | `store`, `disk` | parts and results on disk, whole or absent; reading them again |
//! | `manifest`, `outline` | what a study is, written and read |
//! | `frame` | the table by car and point |
//! | `statistics` | pure functions: description, Sobol indices, tornado, ranks |
//! | `answer`, `ambient` | what the study says |
//! | `export` | all rows as one file |
//! | `equations` | the labelled equations of model and statistics |

pub mod ambient;
pub mod answer;
mod cars;
mod preflight;
pub mod check;
pub mod fit;
pub mod points;
pub mod sensitivity;
pub mod design;
pub mod disk;
pub mod equations;
pub mod execute;
pub mod export;
mod filler;
pub mod manifest;
pub mod outputs;
pub mod plan;
mod point;
pub mod prepare;
pub mod progress;
pub mod statistics;
pub mod store;
mod study_table;
pub mod table;
pub mod tables;
mod traces;

pub use answer::{Answer, answer};
pub use cars::StudyCar;
pub use execute::{End, PartWriter};
pub use manifest::StudyManifest;
pub use prepare::Study;
pub use progress::{NoProgress, Progress};
pub use study_table::{StudyTable, TableSource};
