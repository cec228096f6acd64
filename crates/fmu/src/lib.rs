//! Cars as units of a co-simulation: what an FMU is, without the C functions by which it is called.
//!
//! | module | contents |
//! |---|---|
//! | `variables` | the variables of each kind of unit: one table, from which values, modelDescription.xml and the docs come |
//! | `unit` | a unit that is instantiated: inputs in, steps, outputs, saved states |
//! | `state` | a saved state as bytes: the steps since the start, driven again when it is read |
//! | `description`, `package` | modelDescription.xml and the FMU file (feature `package`) |

#[cfg(feature = "package")]
pub mod description;
#[cfg(feature = "package")]
pub mod package;
mod state;
pub mod unit;
pub mod variables;

pub use cvtcycle_config::ProblemKind;
pub use unit::{Refusal, Unit};
pub use variables::{Causality, Kind, Variable};

/// Name of the file, among the resources of an FMU, that says of which kind it is and which description belongs to it.
pub const UNIT_FILE: &str = "unit.txt";
