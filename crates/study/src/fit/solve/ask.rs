//! The model, asked: evaluations are counted, answers checked, and a stop is obeyed.
//!
//! | label | statement | known from |
//! |---|---|---|
//! | CA-1 | an answer with another number of residuals, or a residual that is not finite, is no answer | ASSUMED |

use std::sync::atomic::{AtomicUsize, Ordering};

use super::Residuals;
use crate::progress::Progress;

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Refusal {
    Stopped,
    Model(String),
}

pub(super) struct Ask<'a> {
    pub model: &'a dyn Residuals,
    progress: &'a dyn Progress,
    count: AtomicUsize,
}

impl<'a> Ask<'a> {
    pub fn new(model: &'a dyn Residuals, progress: &'a dyn Progress) -> Ask<'a> {
        Ask {
            model,
            progress,
            count: AtomicUsize::new(0),
        }
    }

    pub fn evaluations(&self) -> usize {
        self.count.load(Ordering::Relaxed)
    }

    pub fn at(&self, values: &[f64]) -> Result<Vec<f64>, Refusal> {
        if self.progress.stopped() {
            return Err(Refusal::Stopped);
        }
        self.count.fetch_add(1, Ordering::Relaxed);
        let answer = self.model.at(values);
        self.progress.advance(1);
        let rows = answer.map_err(Refusal::Model)?;
        // CA-1
        if rows.len() != self.model.count() {
            return Err(Refusal::Model(format!(
                "the model gives {} residuals in place of {}",
                rows.len(),
                self.model.count()
            )));
        }
        match rows.iter().position(|r| !r.is_finite()) {
            Some(i) => Err(Refusal::Model(format!("residual {} is {}", i + 1, rows[i]))),
            None => Ok(rows),
        }
    }
}
