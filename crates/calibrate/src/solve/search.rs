//! Search from one start: descent, onto a bound or off it, descent again.
//!
//! | label | statement | known from |
//! |---|---|---|
//! | CA-8 | after a descent: a value within 1e-3 of its range of a bound towards which the cost falls goes onto it if the cost does not rise; one within 1e-6 of a bound away from which it falls is moved inside by 0.01 of the range; then down again, at most 4 times | ASSUMED |

use nalgebra::{DMatrix, DVector};

use super::jacobian::jacobian;
use super::least_squares::{self, Descent};
use super::objective::{EvalError, Objective, Point};
use super::types::{FitEnd, Options, Prior, Start};

/// Descents of a start (CA-8).
const DESCENTS: usize = 4;
/// Share of the range within which a bound is tried (CA-8).
const NEAR: f64 = 1e-3;
/// Share of the range within which a value counts as being on its bound.
pub(super) const ON_BOUND: f64 = 1e-6;
/// Share of the range by which a value is moved off its bound (CA-8).
const OFF: f64 = 0.01;

/// The best of a start, with the Jacobian there if it was computed on the way.
pub(super) struct Search {
    pub start: Start,
    pub best: Option<(Point, Option<DMatrix<f64>>)>,
}

/// Onto bounds and off them (CA-8): the next first point, `None` if no bound calls for one.
fn at_bounds(
    objective: &Objective,
    point: &Point,
    jacobian: &DMatrix<f64>,
) -> Result<Option<Point>, EvalError> {
    let mut found: Option<Point> = None;
    let uphill = jacobian.tr_mul(&DVector::from_column_slice(&point.residuals));
    for (k, p) in objective.parameters.iter().enumerate() {
        let x = point.values[k];
        let of_prior = |prior: Prior| (x - prior.mean) / (prior.sd * prior.sd);
        let uphill = uphill[k] + p.prior.map_or(0.0, of_prior);
        let (bound, inwards) = match x - p.low <= p.high - x {
            true => (p.low, 1.0),
            false => (p.high, -1.0),
        };
        let share = (x - bound).abs() / p.range();
        let onto = uphill * inwards > 0.0 && 0.0 < share && share <= NEAR;
        let off = uphill * inwards < 0.0 && share <= ON_BOUND;
        if !(onto || off) {
            continue;
        }
        let base = found.as_ref().unwrap_or(point);
        let mut values = base.values.clone();
        let inside = bound + inwards * OFF * p.range();
        values[k] = if onto { bound } else { inside }; // CA-8
        match objective.at(values) {
            Ok(moved) if off || moved.cost <= base.cost => found = Some(moved), // CA-8
            Ok(_) | Err(EvalError::Model(_)) => {}
            Err(EvalError::Stopped) => return Err(EvalError::Stopped),
        }
    }
    Ok(found)
}

/// From a start to the best point that it leads to.
pub(super) fn search(objective: &Objective, options: &Options, from: Vec<f64>) -> Search {
    let mut start = Start {
        to: from.clone(),
        from,
        cost: f64::INFINITY,
        end: FitEnd::Stalled,
        evaluations: 0,
        failure: None,
    };
    let best = match objective.at(start.from.clone()) {
        Ok(first) => {
            let (point, jacobian) = rounds(objective, options, first, &mut start);
            (start.to, start.cost) = (point.values.clone(), point.cost);
            Some((point, jacobian))
        }
        Err(EvalError::Stopped) => {
            start.end = FitEnd::Stopped;
            start.failure = Some("stopped before the model gave an answer".into());
            None
        }
        Err(EvalError::Model(why)) => {
            start.failure = Some(why);
            None
        }
    };
    start.evaluations = objective.evaluations();
    Search { start, best }
}

/// Descents, with moves onto bounds and off them between; the end goes into `start`.
fn rounds(
    objective: &Objective,
    options: &Options,
    first: Point,
    start: &mut Start,
) -> (Point, Option<DMatrix<f64>>) {
    let (mut best, mut next) = (first.clone(), first);
    let mut known = None;
    for round in 1.. {
        let Descent {
            best: lower,
            jacobian: last,
            end,
            rejected,
        } = least_squares::descend(objective, options, next);
        if lower.cost <= best.cost {
            best = lower;
            known = last.filter(|(values, _)| *values == best.values);
        }
        start.end = end;
        start.failure = rejected.filter(|_| end == FitEnd::Stalled);
        let spent = objective.evaluations() >= options.max_evaluations;
        if round == DESCENTS || end != FitEnd::Converged || spent {
            break;
        }
        let here = known
            .take()
            .map_or_else(|| jacobian(objective, &best), |(_, here)| Ok(here));
        match here.and_then(|here| Ok((at_bounds(objective, &best, &here)?, here))) {
            Ok((Some(moved), _)) => next = moved,
            Ok((None, here)) => return (best, Some(here)),
            Err(EvalError::Stopped) => {
                (start.end, start.failure) = (FitEnd::Stopped, None);
                break;
            }
            Err(EvalError::Model(_)) => break,
        }
    }
    (best, known.map(|(_, here)| here))
}

#[cfg(test)]
mod tests {
    use super::super::types::{Parameter, Residuals};
    use super::*;
    use cvtcycle_output::progress::NoProgress;

    struct Parabola;

    impl Residuals for Parabola {
        fn count(&self) -> usize {
            1
        }

        fn at(&self, values: &[f64]) -> Result<Vec<f64>, String> {
            Ok(vec![values[0] - 3.0])
        }
    }

    #[test]
    fn off_a_bound_from_which_the_cost_falls() {
        let options = Options {
            starts: 1,
            seed: 0,
            max_evaluations: 200,
            tolerance: 1e-10,
        };
        for on_bound in [0.0, 10.0] {
            let parameters = [Parameter::new("p", on_bound, 0.0, 10.0)];
            let objective = Objective::new(&Parabola, &parameters, &NoProgress);
            let start = search(&objective, &options, vec![on_bound]).start;
            let found = (start.to[0] - 3.0).abs() < 1e-6 && start.end == FitEnd::Converged;
            assert!(found, "{start:?}");
        }
    }
}
