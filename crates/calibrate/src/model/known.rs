//! Predictions that have been made: a common error of a group moves no car, and all folds begin at the same values.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::Prediction;

/// Most computed numbers that are kept, 16 bytes each; beyond them all are forgotten.
const MAX_NUMBERS: usize = 2_000_000;

/// A prediction, or why there is none.
type Made = Result<Prediction, String>;
/// One that may still be under way in another thread.
type Slot = Arc<OnceLock<Made>>;

/// Predictions by the bits of the values of the cars.
#[derive(Default)]
pub(super) struct Known {
    slots: Mutex<HashMap<Vec<u64>, Slot>>,
}

impl Known {
    /// The prediction at these values of the cars, made once, of `count` observations. A thread that wants one which another thread makes
    /// waits for it: `make` must not wait for other threads.
    pub fn once(&self, cars: &[f64], count: usize, make: impl FnOnce() -> Made) -> Made {
        let bits: Vec<u64> = cars.iter().map(|x| x.to_bits()).collect();
        let slot = {
            let mut slots = self.slots.lock().unwrap_or_else(PoisonError::into_inner);
            if slots.len() * count.max(1) >= MAX_NUMBERS {
                slots.clear();
            }
            Arc::clone(slots.entry(bits).or_default())
        };
        slot.get_or_init(make).clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From the definition: made once for each set of values, by their bits, and again once all are forgotten.
    #[test]
    fn each_is_made_once() {
        let known = Known::default();
        let mut made = 0;
        let mut ask = |cars: &[f64], count: usize| {
            let answer = known.once(cars, count, || {
                made += 1;
                Err(format!("{cars:?}"))
            });
            assert_eq!(answer, Err(format!("{cars:?}")));
            made
        };
        assert_eq!(ask(&[1.0, 2.0], 1), 1);
        assert_eq!(ask(&[1.0, 2.0], 1), 1);
        assert_eq!(ask(&[1.0, 2.0_f64.next_up()], 1), 2);
        assert_eq!(ask(&[0.0], 1), 3);
        assert_eq!(ask(&[-0.0], 1), 4);
        assert_eq!(ask(&[1.0, 2.0], MAX_NUMBERS), 5);
    }
}
