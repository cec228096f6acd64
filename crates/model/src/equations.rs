//! The equations at the heads of the modules, with label, statement and status.
//!
//! `build.rs` reads the heads, so that `explain` and the book of assumptions show what the source has.

/// One line of the head of a module.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Equation {
    /// Label, such as `SL-3`.
    pub label: &'static str,
    /// Statement.
    pub statement: &'static str,
    /// `source …`, `derived …`, `fitted …` or `ASSUMED …`.
    pub status: &'static str,
    /// Crate and module, such as `model::thermal`.
    pub module: &'static str,
}

/// The equations of the model.
pub const EQUATIONS: &[Equation] = include!(concat!(env!("OUT_DIR"), "/equations.rs"));
