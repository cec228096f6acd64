//! What each limit costs, and which one cannot be held.

use cvtcycle_model::drive::Row;
use cvtcycle_model::thermal::NODES;

use super::nodes::Scene;
use super::program::{Controls, follow, solve};
use super::reference::Reference;
use super::stages::{Problem, Table};
use super::{Limits, Task};

/// A limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitName {
    /// Least engine speed.
    LeastSpeed,
    /// Share of full load that is kept.
    Reserve,
    /// Shift rates.
    ShiftRate,
}

impl LimitName {
    /// Every limit.
    pub const ALL: [LimitName; 3] = [
        LimitName::LeastSpeed,
        LimitName::Reserve,
        LimitName::ShiftRate,
    ];

    /// Name as in files.
    pub const fn name(self) -> &'static str {
        match self {
            LimitName::LeastSpeed => "least_rpm",
            LimitName::Reserve => "reserve",
            LimitName::ShiftRate => "shift_rate",
        }
    }

    /// Limits without this one, as far as the car allows.
    pub(super) fn dropped(self, limits: Limits) -> Limits {
        match self {
            LimitName::LeastSpeed => Limits {
                least_rad_s: 0.0,
                ..limits
            },
            LimitName::Reserve => Limits {
                reserve: 0.0,
                ..limits
            },
            LimitName::ShiftRate => Limits {
                up_per_s: f64::INFINITY,
                down_per_s: f64::INFINITY,
                ..limits
            },
        }
    }

    /// Limits with this one a share of the way from dropped to wanted, where it is a number that can be between.
    fn partly(self, limits: Limits, share: f64, least_rad_s: f64) -> Option<(Limits, f64)> {
        match self {
            LimitName::LeastSpeed => {
                let least_rad_s = least_rad_s + share * (limits.least_rad_s - least_rad_s);
                let limits = Limits {
                    least_rad_s,
                    ..limits
                };
                Some((limits, least_rad_s))
            }
            LimitName::Reserve => {
                let reserve = share * limits.reserve;
                Some((Limits { reserve, ..limits }, reserve))
            }
            LimitName::ShiftRate => None,
        }
    }
}

/// Limits that no controller holds.
#[derive(Clone, Debug)]
pub struct Infeasible {
    /// Row of the step that cannot be done, of the car as it is driven.
    pub row: Row,
    /// Limits each of which alone would have to go, with the largest value that can be held, SI.
    pub each: Vec<(LimitName, Option<f64>)>,
    /// Two limits that would have to go together, where no single one is enough.
    pub both: Option<[LimitName; 2]>,
}

/// Which limits make a task infeasible, and where.
pub(super) fn infeasible(
    scene: &Scene,
    table: &Table,
    reference: &Reference,
    worth: &[[f64; NODES]],
    task: &Task,
) -> Infeasible {
    let stage = |limits: Limits| {
        let problem = Problem::new(scene, table, reference, worth, limits);
        match solve(&problem, Controls::WithEnds) {
            Err(stage) => Some(stage),
            Ok(values) if follow(&problem, Controls::WithEnds, &values).is_none() => Some(0),
            Ok(_) => None,
        }
    };
    let can = |limits: Limits| stage(limits).is_none();
    let idle_rad_s = task.car.engine.idle_hot_rad_s;
    let attainable = |name: LimitName| {
        let (mut good, mut bad) = (0.0, 1.0);
        name.partly(task.limits, good, idle_rad_s)?;
        for _ in 0..10 {
            let middle = 0.5 * (good + bad);
            let (limits, _) = name.partly(task.limits, middle, idle_rad_s)?;
            if can(limits) {
                good = middle;
            } else {
                bad = middle;
            }
        }
        name.partly(task.limits, good, idle_rad_s).map(|(_, x)| x)
    };
    let each: Vec<_> = LimitName::ALL
        .into_iter()
        .filter(|name| can(name.dropped(task.limits)))
        .map(|name| (name, attainable(name)))
        .collect();
    let pairs = [(0, 1), (0, 2), (1, 2)].map(|(a, b)| [LimitName::ALL[a], LimitName::ALL[b]]);
    let both = pairs
        .into_iter()
        .filter(|_| each.is_empty())
        .find(|[a, b]| can(b.dropped(a.dropped(task.limits))));
    Infeasible {
        row: reference.rows[stage(task.limits).unwrap_or(0)],
        each,
        both,
    }
}
