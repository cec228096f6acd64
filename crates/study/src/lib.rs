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
//! | `family` | one car with other numbers, as a function of them |
//! | `equations` | the labelled equations of model and statistics |

pub mod answer;
pub mod design;
pub mod equations;
pub mod execute;
pub mod family;
pub mod plan;
pub mod statistics;
pub mod store;

pub use answer::{Answer, StudyTable, TableSource, answer};
pub use execute::{End, PartWriter, Study, StudyCar, StudyManifest};
