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
#[must_use]
pub fn by_label(label: &str) -> Option<Equation> {
    equations().find(|equation| equation.label.eq_ignore_ascii_case(label))
}

/// The equations whose labels a text names in brackets, as in "displacement (PU-1, PU-4)".
#[must_use]
pub fn cited(text: &str) -> Vec<Equation> {
    let words = text.split(|c: char| !(c.is_ascii_alphanumeric() || c == '-'));
    words
        .filter(|word| word.bytes().all(|b| !b.is_ascii_lowercase()))
        .filter_map(by_label)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::{cited, equations};

    #[test]
    fn labels_are_unique() {
        let mut labels: Vec<&str> = equations().map(|equation| equation.label).collect();
        let count = labels.len();
        labels.sort_unstable();
        labels.dedup();
        assert_eq!(labels.len(), count);
    }

    #[test]
    fn labels_in_a_text_are_cited() {
        assert_eq!(cited("displacement (PU-1, PU-4)").len(), 2);
        assert!(cited("class UN-R83 (none)").is_empty());
    }
}
