//! The equations of the model and of the statistics of studies.

pub use cvtcycle_model::equations::Equation;

/// The equations of this crate.
const EQUATIONS: &[Equation] = include!(concat!(env!("OUT_DIR"), "/equations.rs"));

/// All equations: those of the model, then those of this crate.
pub fn equations() -> impl Iterator<Item = Equation> {
    cvtcycle_model::equations::EQUATIONS
        .iter()
        .chain(EQUATIONS)
        .copied()
}

/// The equation of a label.
pub fn by_label(label: &str) -> Option<Equation> {
    equations().find(|equation| equation.label.eq_ignore_ascii_case(label))
}

/// The equations whose labels a text names in brackets, as in "displacement (PU-1, PU-4)".
pub fn cited(text: &str) -> Vec<Equation> {
    let words = text.split(|c: char| !(c.is_ascii_alphanumeric() || c == '-'));
    words
        .filter(|word| word.bytes().all(|b| !b.is_ascii_lowercase()))
        .filter_map(by_label)
        .collect()
}
