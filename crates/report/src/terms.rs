//! The terms into which the energy of the fuel goes.

use crate::charts::figures::Term;

/// Terms of the power ledger with their names and what they are.
pub(crate) const TERMS: [(&str, &str, Term); 7] = [
    ("wheels", "rolling and air, net", Term::Wheels),
    ("brake", "brakes", Term::Brake),
    ("losses", "transmission", Term::Transmission),
    ("accessories", "accessories", Term::Accessories),
    ("kinetic", "rotating parts", Term::Kinetic),
    ("engine_heat", "heat to the engine", Term::EngineHeat),
    ("exhaust", "exhaust", Term::Exhaust),
];
