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

/// The equations of some labels.
pub fn of_labels(labels: &[&str]) -> impl Iterator<Item = Equation> {
    labels.iter().filter_map(|label| by_label(label))
}
