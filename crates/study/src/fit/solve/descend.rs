//! One start: down, to a bound or off it, down again.
//!
//! | label | statement | known from |
//! |---|---|---|
//! | CA-8 | after a descent: a value within 1e-3 of its range of a bound towards which the cost falls goes onto it if the cost does not rise; one within 1e-6 of a bound away from which it falls is moved inside by 0.01 of the range; then down again, at most 4 times | ASSUMED |
//!
//! Where the model fails, the step counts as one of enormous residuals: refused, and the next a tenth as long.

use std::cell::RefCell;

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt, TerminationReason};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn};

use super::ask::{Ask, Refusal};
use super::point::{Point, prior_residuals};
use super::{End, Options, Parameter, Start, bounded, slope};

/// Residual in place of each where the model fails.
const REFUSED: f64 = 1e100;
/// Length of the first step by the length of the variables (MINPACK's `factor`).
const FIRST_STEP: f64 = 0.5;
/// Least tolerance: some dozens of roundings.
const LEAST_TOLERANCE: f64 = 1e-14;
/// Descents of a start (CA-8).
const DESCENTS: usize = 4;
/// Share of the range within which a bound is tried (CA-8).
const NEAR: f64 = 1e-3;
/// Share of the range within which a value counts as being on its bound.
pub(super) const ON_BOUND: f64 = 1e-6;
/// Share of the range by which a value is moved off its bound (CA-8).
const OFF: f64 = 0.01;

/// The best of a start, with the Jacobian there if it happens to be known.
pub(super) struct Descent {
    pub start: Start,
    pub best: Option<(Point, Option<DMatrix<f64>>)>,
}

/// What happened on the way, seen by the solver's callbacks.
struct Seen {
    best: Point,
    /// Answer at the variables that are set; `None` where not asked or refused.
    here: Option<Point>,
    jacobian: Option<(Vec<f64>, DMatrix<f64>)>,
    halt: Option<End>,
    /// Why the model had no answer at the last step.
    refused: Option<String>,
}

struct Problem<'a> {
    ask: &'a Ask<'a>,
    parameters: &'a [Parameter],
    most_evaluations: usize,
    u: DVector<f64>,
    seen: RefCell<Seen>,
}

impl Problem<'_> {
    fn values(&self) -> Vec<f64> {
        self.parameters
            .iter()
            .zip(&self.u)
            .map(|(p, u)| bounded::outer(p, *u))
            .collect()
    }

    /// Rows of the data, of the priors, and zeros up to one for each parameter.
    fn height(&self) -> usize {
        let priors = self.parameters.iter().filter(|p| p.prior.is_some()).count();
        (self.ask.model.count() + priors).max(self.parameters.len())
    }

    fn stacked(&self, point: &Point) -> DVector<f64> {
        let rows = point
            .rows
            .iter()
            .copied()
            .chain(prior_residuals(self.parameters, &point.values))
            .chain(std::iter::repeat(0.0));
        DVector::from_iterator(self.height(), rows.take(self.height()))
    }

    fn halted(&self, refusal: Refusal) {
        let mut seen = self.seen.borrow_mut();
        match refusal {
            Refusal::Stopped => seen.halt = Some(End::Stopped),
            Refusal::Model(why) => (seen.halt, seen.refused) = (Some(End::NoProgress), Some(why)),
        }
    }

    /// Is there nothing left to spend?
    fn spent(&self) -> bool {
        let spent = self.ask.evaluations() >= self.most_evaluations;
        if spent {
            self.seen.borrow_mut().halt = Some(End::OutOfEvaluations);
        }
        spent
    }
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Problem<'_> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, u: &DVector<f64>) {
        self.u.copy_from(u);
        self.seen.borrow_mut().here = None;
    }

    fn params(&self) -> DVector<f64> {
        self.u.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        let known = self
            .seen
            .borrow()
            .here
            .as_ref()
            .map(|point| self.stacked(point));
        if known.is_some() {
            return known;
        }
        if self.spent() {
            return None;
        }
        let values = self.values();
        let point = self
            .ask
            .at(&values)
            .map(|rows| Point::new(self.parameters, values, rows));
        match point {
            Ok(point) if point.cost.is_finite() => {
                let stacked = self.stacked(&point);
                let mut seen = self.seen.borrow_mut();
                if point.cost < seen.best.cost {
                    seen.best = point.clone();
                }
                (seen.here, seen.refused) = (Some(point), None);
                Some(stacked)
            }
            Err(Refusal::Stopped) => {
                self.halted(Refusal::Stopped);
                None
            }
            refused => {
                let why = if let Err(Refusal::Model(why)) = refused {
                    why
                } else {
                    "the sum of squares is not finite".into()
                };
                self.seen.borrow_mut().refused = Some(why);
                Some(DVector::from_element(self.height(), REFUSED))
            }
        }
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let point = self.seen.borrow().here.clone()?;
        if self.ask.evaluations() + 2 * self.parameters.len() > self.most_evaluations {
            self.seen.borrow_mut().halt = Some(End::OutOfEvaluations);
            return None;
        }
        let data = match slope::matrix(
            slope::columns(self.ask, self.parameters, &point.values, &point.rows),
            point.rows.len(),
        ) {
            Ok(data) => data,
            Err(refusal) => {
                self.halted(refusal);
                return None;
            }
        };
        let mut stacked = DMatrix::zeros(self.height(), self.parameters.len());
        stacked.rows_mut(0, data.nrows()).copy_from(&data);
        let mut row = data.nrows();
        for (k, (p, u)) in self.parameters.iter().zip(&self.u).enumerate() {
            if let Some(prior) = p.prior {
                stacked[(row, k)] = 1.0 / prior.sd;
                row += 1;
            }
            stacked
                .column_mut(k)
                .scale_mut(bounded::slope(p, *u, point.values[k]));
        }
        self.seen.borrow_mut().jacobian = Some((point.values, data));
        Some(stacked)
    }
}

/// One descent; the best point is never worse than where it began.
fn down(ask: &Ask, parameters: &[Parameter], options: &Options, from: Point) -> (Seen, End) {
    let u = DVector::from_iterator(
        parameters.len(),
        parameters
            .iter()
            .zip(&from.values)
            .map(|(p, x)| bounded::inner(p, *x)),
    );
    let seen = RefCell::new(Seen {
        best: from.clone(),
        here: Some(from),
        jacobian: None,
        halt: None,
        refused: None,
    });
    let problem = Problem {
        ask,
        parameters,
        most_evaluations: options.most_evaluations,
        u,
        seen,
    };
    let tolerance = options.tolerance.max(LEAST_TOLERANCE);
    let solver = LevenbergMarquardt::new()
        .with_ftol(tolerance)
        .with_xtol(tolerance)
        .with_gtol(tolerance)
        .with_stepbound(FIRST_STEP);
    // The limit is kept here, where the evaluations of Jacobians are counted too.
    let patience = options
        .most_evaluations
        .clamp(1, usize::MAX / (parameters.len() + 2));
    let (problem, report) = solver.with_patience(patience).minimize(problem);
    let seen = problem.seen.into_inner();
    let end = seen.halt.unwrap_or(match report.termination {
        // The steps became short because the model failed at the ends of all longer ones.
        TerminationReason::Converged { ftol: false, .. } if seen.refused.is_some() => {
            End::NoProgress
        }
        reason if reason.was_successful() => End::Converged,
        TerminationReason::LostPatience => End::OutOfEvaluations,
        _ => End::NoProgress,
    });
    (seen, end)
}

/// Onto bounds and off them (CA-8): the point from which to go on, `None` where no bound asks for it.
fn at_bounds(
    ask: &Ask,
    parameters: &[Parameter],
    point: &Point,
    jacobian: &DMatrix<f64>,
) -> Result<Option<Point>, Refusal> {
    let mut found: Option<Point> = None;
    let uphill = jacobian.tr_mul(&DVector::from_column_slice(&point.rows));
    for (k, p) in parameters.iter().enumerate() {
        let x = point.values[k];
        let uphill = uphill[k]
            + p.prior
                .map_or(0.0, |prior| (x - prior.mean) / (prior.sd * prior.sd));
        let (bound, inwards) = if x - p.low <= p.high - x {
            (p.low, 1.0)
        } else {
            (p.high, -1.0)
        };
        let share = (x - bound).abs() / p.range();
        let onto = uphill * inwards > 0.0 && 0.0 < share && share <= NEAR;
        let off = uphill * inwards < 0.0 && share <= ON_BOUND;
        if !(onto || off) {
            continue;
        }
        let mut values = found.as_ref().unwrap_or(point).values.clone();
        values[k] = if onto {
            bound
        } else {
            bound + inwards * OFF * p.range()
        }; // CA-8
        match ask.at(&values) {
            Ok(rows) => {
                let moved = Point::new(parameters, values, rows);
                if off || moved.cost <= found.as_ref().unwrap_or(point).cost {
                    found = Some(moved); // CA-8
                }
            }
            Err(Refusal::Stopped) => return Err(Refusal::Stopped),
            Err(Refusal::Model(_)) => {}
        }
    }
    Ok(found)
}

/// From a start to the best point that it leads to.
pub(super) fn descend(
    ask: &Ask,
    parameters: &[Parameter],
    options: &Options,
    from: Vec<f64>,
) -> Descent {
    let nothing = |end, why: String| {
        let evaluations = ask.evaluations();
        let start = Start {
            from: from.clone(),
            to: from.clone(),
            cost: f64::INFINITY,
            end,
            evaluations,
            failure: Some(why),
        };
        Descent { start, best: None }
    };
    let first = match ask.at(&from) {
        Ok(rows) => Point::new(parameters, from.clone(), rows),
        Err(Refusal::Stopped) => {
            return nothing(
                End::Stopped,
                "stopped before the model gave an answer".into(),
            );
        }
        Err(Refusal::Model(why)) => return nothing(End::NoProgress, why),
    };
    if !first.cost.is_finite() {
        return nothing(End::NoProgress, "the sum of squares is not finite".into());
    }
    let (mut best, mut next, mut round) = (first.clone(), first, 0);
    let mut jacobian = None;
    let (end, failure) = loop {
        let (seen, end) = down(ask, parameters, options, next);
        if seen.best.cost <= best.cost {
            best = seen.best;
            jacobian = seen
                .jacobian
                .filter(|(values, _)| *values == best.values)
                .map(|(_, jacobian)| jacobian);
        }
        let failure = seen.refused.filter(|_| end == End::NoProgress);
        round += 1;
        if round == DESCENTS
            || end != End::Converged
            || ask.evaluations() >= options.most_evaluations
        {
            break (end, failure);
        }
        let known = jacobian.take().map_or_else(
            || {
                slope::matrix(
                    slope::columns(ask, parameters, &best.values, &best.rows),
                    best.rows.len(),
                )
            },
            Ok,
        );
        match known.and_then(|known| Ok((at_bounds(ask, parameters, &best, &known)?, known))) {
            Ok((Some(moved), _)) => next = moved,
            Ok((None, known)) => {
                jacobian = Some(known);
                break (end, failure);
            }
            Err(Refusal::Stopped) => break (End::Stopped, None),
            Err(Refusal::Model(_)) => break (end, failure),
        }
    };
    let start = Start {
        from,
        to: best.values.clone(),
        cost: best.cost,
        end,
        evaluations: ask.evaluations(),
        failure,
    };
    Descent {
        start,
        best: Some((best, jacobian)),
    }
}

#[cfg(test)]
mod tests {
    use super::super::Residuals;
    use super::*;
    use crate::NoProgress;

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
            most_evaluations: 200,
            tolerance: 1e-10,
        };
        for on_bound in [0.0, 10.0] {
            let parameters = [Parameter {
                name: "p".into(),
                start: on_bound,
                low: 0.0,
                high: 10.0,
                prior: None,
            }];
            let start = descend(
                &Ask::new(&Parabola, &NoProgress),
                &parameters,
                &options,
                vec![on_bound],
            )
            .start;
            assert!(
                (start.to[0] - 3.0).abs() < 1e-6 && start.end == End::Converged,
                "{start:?}"
            );
        }
    }
}
