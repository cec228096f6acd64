//! Expressions of rows and calibrations, over two small tables.

use cvtcycle::validate::expr::{Computed, compute, parse};

use super::small_tables::SmallTables;
use super::within_memory;

/// Limit of evaluations of an expression.
const EVALUATIONS: u64 = 100_000;

/// An expression is refused at places within it, or gives a result or the reason for having none.
pub fn expression(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else {
        return;
    };
    let (x, y) = (
        [1.0, 2.0, -4.0, 1.0, f64::NAN, 9.0],
        [2.0, 1e308, 8.0, 3.0, 5e-324, 99.0],
    );
    let small = SmallTables::new(x, y, EVALUATIONS);
    within_memory(data.len(), || {
        small.left.set(EVALUATIONS);
        match parse(text, &small) {
            Err(faults) => {
                let length = text.chars().count();
                assert!(!faults.is_empty(), "refused without a word");
                for fault in faults {
                    assert!(!fault.message.is_empty(), "a fault without words");
                    assert!(fault.at <= length, "a fault at {} of {length}", fault.at);
                }
            }
            Ok(expr) => match compute(&expr, &small) {
                Err(reason) => assert!(!reason.is_empty(), "no answer without a reason"),
                Ok(Computed::Range(low, high)) => {
                    assert!(
                        low.partial_cmp(&high) != Some(std::cmp::Ordering::Greater),
                        "a range from {low} to {high}"
                    );
                }
                Ok(Computed::Number(_) | Computed::Truth(..)) => {}
            },
        }
    });
}
