//! Files of results, which may have an untrusted origin.

use cvtcycle::config::bounded::json;
use cvtcycle::config::{Problem, Problems, render};
use cvtcycle::report::results::{parse_record, parse_summary};
use cvtcycle::study::StudyManifest;
use cvtcycle::study::plan::embedded_plans;
use cvtcycle::study::store::Checksums;

use super::within_memory;

/// Asserts that a refusal can be rendered.
pub(super) fn checked<T>(answer: Result<T, Problem>) -> Option<T> {
    answer
        .map_err(|problem| {
            assert!(!problem.message.is_empty(), "refused without a word");
            assert!(!render(&Problems::from(problem), false).is_empty());
        })
        .ok()
}

pub fn summary(data: &[u8]) {
    within_memory(data.len(), || checked(parse_summary("summary.json", data)));
}

pub fn inputs(data: &[u8]) {
    within_memory(data.len(), || checked(parse_record("inputs.json", data)));
}

/// Manifest of a study, after a byte that selects its plan.
pub fn study_manifest(data: &[u8]) {
    let Some((which, rest)) = data.split_first() else {
        return;
    };
    let plans = embedded_plans();
    let (_, plan) = plans[usize::from(*which) % plans.len()];
    within_memory(rest.len(), || {
        let Some(value) = checked(json(rest)) else {
            return;
        };
        if let Err(words) = StudyManifest::read(&value, "plan.toml", plan) {
            assert!(!words.is_empty(), "refused without a word");
        }
    });
}

/// A valid list has a single representation.
pub fn checksums(data: &[u8]) {
    within_memory(data.len(), || {
        if let Some(list) = Checksums::parse(data) {
            assert_eq!(list.text().as_bytes(), data, "another list");
        }
    });
}
