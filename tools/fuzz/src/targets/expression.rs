//! Expressions of rows and calibrations, over two small tables.

use std::cell::Cell;
use std::rc::Rc;

use cvtcycle::study::check::expr::{Computed, Names, Table, Tables, compute, parse};

use super::within_memory;

/// Evaluations that an expression may take here.
const EVALUATIONS: u64 = 100_000;

struct Small {
    keys: Vec<String>,
    left: Cell<u64>,
}

impl Names for Small {
    fn sources(&self) -> Vec<&str> {
        vec!["low", "trip"]
    }

    fn columns(&self, source: usize, totals: bool) -> Vec<&'static str> {
        match (source, totals) {
            (0, false) => vec!["x", "g", "y"],
            (1, true) => vec!["fuel"],
            _ => Vec::new(),
        }
    }

    fn keys(&self) -> &[String] {
        &self.keys
    }
}

impl Tables for Small {
    fn table(&self, source: usize, _: bool) -> Result<Rc<Table>, String> {
        let table = if source == 1 {
            Table {
                columns: vec![vec![6.5]],
                weight: vec![1.0],
                ..Table::default()
            }
        } else {
            Table {
                columns: vec![
                    vec![1.0, 2.0, -4.0, 1.0, f64::NAN, 9.0],
                    vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
                    vec![2.0, 1e308, 8.0, 3.0, 5e-324, 99.0],
                ],
                weight: vec![1.0, 1.0, 2.0, 1.0, 1.0, 1.0],
                gross: vec![false, false, false, false, false, true],
                outside: Vec::new(),
            }
        };
        Ok(Rc::new(table))
    }

    fn key(&self, _: Option<usize>, _: &str, item: Option<usize>) -> Result<f64, String> {
        Ok(item.map_or(3.0, |k| k as f64))
    }

    fn spend(&self, evaluations: u64) -> Result<(), String> {
        let left = self.left.get().checked_sub(evaluations);
        self.left.set(left.unwrap_or(0));
        left.map(drop).ok_or_else(|| "none are left".to_owned())
    }

    fn left_out(&self, _: usize) {}

    fn outside(&self, _: usize) {}
}

/// An expression is refused at places within it, or has an answer or a reason why it has none.
pub fn expression(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else {
        return;
    };
    let small = Small {
        keys: vec!["belt.offset_mm".to_owned()],
        left: Cell::new(EVALUATIONS),
    };
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
