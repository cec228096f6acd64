//! Cars as units of a co-simulation: the contents of an FMU without its C interface.
//!
//! | module | contents |
//! |---|---|
//! | `variables` | variables of each kind of unit in one table, from which values, modelDescription.xml and the docs are generated |
//! | `unit` | an instantiated unit: inputs, steps, outputs, saved states |
//! | `state` | saved states as bytes: the steps since the start, repeated on reading |
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

/// Resource file of an FMU with the kind of unit and the token of its description.
pub const UNIT_FILE: &str = "unit.txt";
