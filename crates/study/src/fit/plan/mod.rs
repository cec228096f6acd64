//! The plan of a calibration, read from a TOML file and checked.
//!
//! | file | content |
//! |---|---|
//! | `types` | the content of a plan |
//! | `read` | the head of a plan, and all its parts together |
//! | `parameter` | one `[[parameter]]` |
//! | `group`, `files` | one `[[data]]` to observations |

mod files;
mod found;
mod group;
mod parameter;
mod read;
mod types;

pub use read::{gather, load, read};
pub(super) use types::problem;
pub use types::{
    BenchPoints, CalibrationPlan, FreeParameter, Group, Measured, Observable, Observation, Search,
};
