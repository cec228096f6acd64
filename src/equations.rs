//! The labelled equations of all crates.

pub use cvtcycle_model::equations::Equation;

/// All equations: those of the model, then those of the statistics of studies, of the analyses and of calibration.
pub fn equations() -> impl Iterator<Item = Equation> {
    let lists = [
        cvtcycle_model::equations::EQUATIONS,
        cvtcycle_study::equations::EQUATIONS,
        cvtcycle_analysis::equations::EQUATIONS,
        cvtcycle_calibrate::equations::EQUATIONS,
    ];
    lists.into_iter().flatten().copied()
}

/// The equation of a label.
pub fn by_label(label: &str) -> Option<Equation> {
    equations().find(|equation| equation.label.eq_ignore_ascii_case(label))
}

/// The equations of some labels.
pub fn of_labels(labels: &[&str]) -> impl Iterator<Item = Equation> {
    labels.iter().filter_map(|label| by_label(label))
}
