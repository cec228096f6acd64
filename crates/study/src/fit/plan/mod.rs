//! The plan of a calibration, read from a TOML file and checked.
//!
//! | file | content |
//! |---|---|
//! | `keys` | the keys of a plan |
//! | `types` | the content of a plan |
//! | `read` | the head of a plan, and all its parts together |
//! | `clashes` | what is wrong between the parts |
//! | `parameter` | one `[[parameter]]` |
//! | `group`, `files` | one `[[data]]` to observations |

mod clashes;
mod files;
mod group;
pub mod keys;
mod parameter;
mod read;
mod types;

pub(super) use read::stem;
pub use read::{gather, load, read};
pub(super) use types::problem;
pub use types::{
    BenchPoints, CalibrationPlan, FreeParameter, Group, Measured, Observable, Observation,
};
