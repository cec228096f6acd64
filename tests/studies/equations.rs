//! Labels of the equations of model and statistics.

use cvtcycle::study::equations::{cited, equations};

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
