//! The dynamic program itself: stages with nodes, a cost from a place to a place, and the least sum. No physics.
//!
//! Nodes may lie in two layers, one number each and a mode that is one of two: a mode that a law of its own decides, so that a cost is infinite
//! where the law does not lead from one layer to the other.
//!
//! | label | statement | status |
//! |---|---|---|
//! | DP-1 | V_t(x) = min over u of c_t(x, u) + V_{t+1}(u), V_N = 0; u from x within reach | source: Bellman 1957 |
//! | DP-3 | u: every node within reach, both ends of reach, and x itself; V linear between nodes | derived: nodes alone leave an error of first order in their distance |
//! | DP-6 | between a node from which the end cannot be reached and another, V is infinite; at the other it is its own | derived: an infinite value is no number to go between |

use super::place::{NEAR, Place};

/// A problem in stages. The state between two stages is one number, known at the nodes of the stage before.
pub trait Stages: Sync {
    /// What a stage knows of the place that it is left from.
    type From;

    /// How many stages there are.
    fn count(&self) -> usize;

    /// Places in which a stage may end, ascending in each layer.
    fn nodes(&self, stage: usize) -> &[f64];

    /// Where the second layer begins among them; their number where there is but one.
    fn second_layer(&self, stage: usize) -> usize {
        self.nodes(stage).len()
    }

    /// Place in which the first stage begins.
    fn start(&self) -> f64;

    /// Places between which a stage can end that begins at `x`.
    fn reach(&self, stage: usize, x: f64) -> (f64, f64);

    /// A beginning at `x`, which is at a place of the stage before; none for the first stage.
    fn from(&self, stage: usize, x: f64, place: Option<Place>) -> Self::From;

    /// Cost of a stage to one of its places; infinite where it is not allowed.
    fn cost(&self, stage: usize, from: &Self::From, to: Place) -> f64;
}

/// Which controls are tried besides the nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Controls {
    /// None: for a comparison with all paths over the nodes.
    #[cfg(test)]
    Nodes,
    /// Both ends of reach, and staying (DP-3).
    WithEnds,
}

/// Least cost of what is left, after each stage at its nodes.
struct Values(Vec<Vec<f64>>);

/// A path with the least cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// Where each stage ends.
    pub x: Vec<f64>,
    /// The same among the nodes of its stage.
    pub places: Vec<Place>,
    /// Cost of each stage.
    pub cost: Vec<f64>,
}

impl Path {
    /// Cost of the whole path.
    pub fn total(&self) -> f64 {
        self.cost.iter().sum()
    }
}

/// Least cost of what is left (DP-1), from the last stage to the first; or the last stage that no place before it can do, if there is one.
///
/// # Errors
/// The stage.
fn solve(of: &impl Stages, controls: Controls) -> Result<Values, usize> {
    let last = of.count() - 1;
    let mut left = vec![Vec::new(); last + 1];
    left[last] = vec![0.0; of.nodes(last).len()];
    for stage in (1..=last).rev() {
        let begins = of.nodes(stage - 1);
        let values: Vec<f64> = (0..begins.len())
            .map(|k| {
                let from = of.from(stage, begins[k], Some(Place::at(k)));
                best(of, stage, begins[k], &from, (controls, &left[stage]))
                    .map_or(f64::INFINITY, |best| best.whole)
            })
            .collect();
        if values.iter().all(|value| value.is_infinite()) {
            return Err(stage);
        }
        left[stage - 1] = values;
    }
    Ok(Values(left))
}

/// The best path from the start; or the stage that it cannot go on in.
///
/// # Errors
/// The stage.
fn follow(of: &impl Stages, controls: Controls, values: &Values) -> Result<Path, usize> {
    let mut path = Path {
        x: Vec::new(),
        places: Vec::new(),
        cost: Vec::new(),
    };
    let (mut x, mut place) = (of.start(), None);
    for (stage, left) in values.0.iter().enumerate() {
        let from = of.from(stage, x, place);
        let best = best(of, stage, x, &from, (controls, left)).ok_or(stage)?;
        (x, place) = (best.x, Some(best.place));
        path.x.push(best.x);
        path.places.push(best.place);
        path.cost.push(best.cost);
    }
    Ok(path)
}

/// The path with the least cost; or the stage that cannot be done.
///
/// # Errors
/// The stage.
pub fn least(of: &impl Stages, controls: Controls) -> Result<Path, usize> {
    follow(of, controls, &solve(of, controls)?)
}

/// A control with the least cost of a stage and of what is left after it.
struct Best {
    x: f64,
    place: Place,
    cost: f64,
    whole: f64,
}

fn best<S: Stages>(
    of: &S,
    stage: usize,
    x: f64,
    from: &S::From,
    (controls, left): (Controls, &[f64]),
) -> Option<Best> {
    let (low, high) = of.reach(stage, x);
    let mut best: Option<Best> = None;
    let mut consider = |x: f64, place: Place| {
        let after = place.value(left);
        if after.is_infinite() {
            return;
        }
        let cost = of.cost(stage, from, place);
        let whole = cost + after; // DP-1
        if whole < best.as_ref().map_or(f64::INFINITY, |best| best.whole) {
            best = Some(Best {
                x,
                place,
                cost,
                whole,
            });
        }
    };
    let second = of.second_layer(stage);
    let (one, other) = of.nodes(stage).split_at(second);
    for (begin, nodes) in [(0, one), (second, other)] {
        let first = nodes.partition_point(|node| *node < low - NEAR);
        for (k, node) in nodes.iter().enumerate().skip(first) {
            if *node > high + NEAR {
                break;
            }
            consider(*node, Place::at(begin + k));
        }
        if controls == Controls::WithEnds {
            for x in [low, high, x.clamp(low, high)] {
                if let Some(place) = Place::of(x, nodes).filter(|place| place.share > 0.0) {
                    consider(x, place.later(begin)); // DP-3
                }
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Costs from a formula over nodes of its own in each stage, some forbidden.
    struct Toy {
        nodes: Vec<Vec<f64>>,
        start: f64,
        reach: f64,
        cost: fn(usize, f64, f64) -> f64,
    }

    impl Stages for Toy {
        type From = f64;

        fn count(&self) -> usize {
            self.nodes.len()
        }

        fn nodes(&self, stage: usize) -> &[f64] {
            &self.nodes[stage]
        }

        fn start(&self) -> f64 {
            self.start
        }

        fn reach(&self, _: usize, x: f64) -> (f64, f64) {
            (x - self.reach, x + self.reach)
        }

        fn from(&self, _: usize, x: f64, _: Option<Place>) -> f64 {
            x
        }

        fn cost(&self, stage: usize, from: &f64, to: Place) -> f64 {
            (self.cost)(stage, *from, to.value(&self.nodes[stage]))
        }
    }

    fn grid(count: usize, from: f64, to: f64) -> Vec<f64> {
        let step = (to - from) / (count - 1) as f64;
        (0..count).map(|k| from + step * k as f64).collect()
    }

    /// Every path over the nodes, by counting in the numbers of nodes.
    fn by_brute_force(of: &Toy) -> f64 {
        let paths: usize = of.nodes.iter().map(Vec::len).product();
        let mut least = f64::INFINITY;
        for mut number in 0..paths {
            let (mut x, mut sum) = (of.start, 0.0);
            let mut costs = Vec::new();
            for (stage, nodes) in of.nodes.iter().enumerate() {
                let u = nodes[number % nodes.len()];
                number /= nodes.len();
                let inside = (u - x).abs() <= of.reach + NEAR;
                let cost = if inside {
                    (of.cost)(stage, x, u)
                } else {
                    f64::INFINITY
                };
                costs.push(cost);
                x = u;
            }
            // In the order of the program, so that the sums have the same bits.
            for cost in costs.iter().rev() {
                sum += cost;
            }
            least = least.min(sum);
        }
        least
    }

    fn rough(stage: usize, x: f64, u: f64) -> f64 {
        let wave = (7.0 * u + 1.3 * stage as f64).sin();
        if wave > 0.93 {
            return f64::INFINITY; // a place that this stage does not allow
        }
        1.2 + wave + 3.0 * (u - x) * (u - x)
    }

    /// Truth: all 531 441 paths, one by one.
    #[test]
    fn program_is_brute_force() {
        for reach in [0.3, 0.6, 9.0] {
            let of = Toy {
                nodes: (0..6)
                    .map(|t| grid(9, 0.01 * f64::from(t), 1.0 + 0.02 * f64::from(t)))
                    .collect(),
                start: 0.9,
                reach,
                cost: rough,
            };
            let path = least(&of, Controls::Nodes).expect("a path");
            let whole = path.cost.iter().rev().fold(0.0, |sum, cost| cost + sum);
            let truth = by_brute_force(&of);
            assert!((whole - truth).abs() <= 1e-14, "{whole} {truth}");
        }
    }

    /// Truth: without a cost of change and without a limit on it each stage is by itself.
    #[test]
    fn uncoupled_stages_are_minima_of_their_own() {
        fn cost(stage: usize, _: f64, u: f64) -> f64 {
            (u - 0.1 * stage as f64).powi(2)
        }
        let of = Toy {
            nodes: vec![grid(23, 0.0, 1.0); 8],
            start: 0.0,
            reach: 9.0,
            cost,
        };
        let truth: f64 = (0..8)
            .map(|stage| {
                let nodes = of.nodes[stage].iter().map(|u| cost(stage, 0.0, *u));
                nodes.fold(f64::INFINITY, f64::min)
            })
            .sum();
        let path = least(&of, Controls::Nodes).expect("a path");
        assert!((path.total() - truth).abs() < 1e-14);
    }

    /// Truth: Riccati's recursion for the sum of u2 + 4 (u - x)2 over ten stages.
    #[test]
    fn quadratic_problem_is_riccatis_within_the_grid_in_second_order() {
        fn cost(_: usize, x: f64, u: f64) -> f64 {
            u * u + 4.0 * (u - x) * (u - x)
        }
        // V(x) = p x2: min over u of (1 + p') u2 + 4 (u - x)2 = 4 (1 + p')/(5 + p') x2.
        let p = (0..10).fold(0.0, |p: f64, _| 4.0 * (1.0 + p) / (5.0 + p));
        let error = |count: usize| {
            let of = Toy {
                nodes: vec![grid(count, -0.2, 1.0); 10],
                start: 0.8,
                reach: 9.0,
                cost,
            };
            least(&of, Controls::WithEnds).expect("a path").total() - p * 0.64
        };
        // A stage adds at most p h2/4 by V between nodes and (5 + p) h2/4 by the control that is half a distance off, p below its fixed point.
        let fixed_point = 0.5 * (f64::sqrt(17.0) - 1.0);
        let most = |count: usize| {
            let h = 1.2 / (count - 1) as f64;
            10.0 * (5.0 + 2.0 * fixed_point) * h * h / 4.0
        };
        let counts = [31, 61, 121];
        let errors = counts.map(error);
        for (count, error) in counts.iter().zip(errors) {
            assert!(error >= -1e-12 && error <= most(*count), "{errors:?}");
        }
        assert!(errors.windows(2).all(|e| e[1] < e[0] / 3.0), "{errors:?}");
    }

    /// Truth: the best path goes along the limit of reach, off the nodes, and can be added up by hand.
    #[test]
    fn ends_of_reach_are_controls() {
        fn cost(_: usize, _: f64, u: f64) -> f64 {
            u
        }
        let of = Toy {
            nodes: vec![grid(11, 0.0, 1.0); 5],
            start: 1.0,
            reach: 0.13,
            cost,
        };
        let exact = least(&of, Controls::WithEnds).expect("a path").total();
        assert!((exact - (0.87 + 0.74 + 0.61 + 0.48 + 0.35)).abs() < 1e-12);
        let nodes = least(&of, Controls::Nodes).expect("a path").total();
        assert!((nodes - (0.9 + 0.8 + 0.7 + 0.6 + 0.5)).abs() < 1e-12);
    }

    #[test]
    fn a_stage_that_cannot_be_done_is_named() {
        fn cost(stage: usize, _: f64, _: f64) -> f64 {
            if stage == 3 { f64::INFINITY } else { 1.0 }
        }
        let of = Toy {
            nodes: vec![grid(4, 0.0, 1.0); 6],
            start: 0.0,
            reach: 9.0,
            cost,
        };
        assert_eq!(solve(&of, Controls::WithEnds).err(), Some(3));
    }
}
