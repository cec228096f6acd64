//! Labels of the equations of model and statistics.

use cvtcycle::config::setup::catalogue::known_keys;
use cvtcycle::equations::{by_label, equations};

#[test]
fn labels_are_unique() {
    let mut labels: Vec<&str> = equations().map(|equation| equation.label).collect();
    let count = labels.len();
    labels.sort_unstable();
    labels.dedup();
    assert_eq!(labels.len(), count);
}

/// Property: labels in rows of keys belong to equations.
#[test]
fn labels_of_keys_are_those_of_equations() {
    let labels = known_keys().iter().flat_map(|info| info.labels);
    assert!(labels.clone().count() > 170);
    let unknown: Vec<_> = labels.filter(|label| by_label(label).is_none()).collect();
    assert!(unknown.is_empty(), "{unknown:?}");
}
