//! The equations of this crate, collected from the heads of its modules.

use cvtcycle_model::equations::Equation;

/// The equations in the order of the modules.
pub const EQUATIONS: &[Equation] = include!(concat!(env!("OUT_DIR"), "/equations.rs"));
