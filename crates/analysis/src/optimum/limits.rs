//! What each limit costs, and which one cannot be held.

use cvtcycle_model::drive::Row;
use cvtcycle_model::thermal::NODES;

use super::reference::Reference;
use super::scene::Scene;
use super::stage::Table;
use super::stages::Problem;
use super::{Limits, Task, least_path};

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

/// A limit that no controller holds.
#[derive(Clone, Debug)]
pub struct Unheld {
    /// The limit.
    pub name: LimitName,
    /// Row of the step that cannot be driven, of the car as it is driven.
    pub row: Row,
    /// Largest value that can be held, SI, where the limit is a number.
    pub most: Option<f64>,
}

/// Limits that no controller holds.
#[derive(Clone, Debug)]
pub struct Infeasible {
    /// The fewest limits without which the rest can be held; none where no limit is the cause.
    pub unheld: Vec<Unheld>,
    /// Other limits each of which could go instead of a single one.
    pub instead: Vec<LimitName>,
    /// Row of the step that cannot be driven within all limits.
    pub row: Row,
}

/// Sets of limits, the smallest first.
const SETS: [&[LimitName]; 7] = {
    use LimitName::{LeastSpeed, Reserve, ShiftRate};
    [
        &[LeastSpeed],
        &[Reserve],
        &[ShiftRate],
        &[LeastSpeed, Reserve],
        &[LeastSpeed, ShiftRate],
        &[Reserve, ShiftRate],
        &[LeastSpeed, Reserve, ShiftRate],
    ]
};

/// Halvings of the range in which the largest value of a limit is sought.
const HALVINGS: usize = 10;

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
        least_path(&problem).err()
    };
    let row = |limits: Limits| reference.rows[stage(limits).unwrap_or(0)];
    let without = |names: &[LimitName]| {
        let names = names.iter();
        names.fold(task.limits, |limits, name| name.dropped(limits))
    };
    let can = |set: &&[LimitName]| stage(without(set)).is_none();
    let set = SETS.into_iter().find(can).unwrap_or(&[]);
    let idle_rad_s = task.car.engine.idle_hot_rad_s;
    let unheld = |name: &LimitName| {
        let others: Vec<_> = set.iter().copied().filter(|other| other != name).collect();
        let limits = without(&others);
        let (mut good, mut bad) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (good + bad);
            let held = |(limits, _)| stage(limits).is_none();
            match name.partly(limits, middle, idle_rad_s).is_some_and(held) {
                true => good = middle,
                false => bad = middle,
            }
        }
        Unheld {
            name: *name,
            row: row(limits),
            most: name.partly(limits, good, idle_rad_s).map(|(_, most)| most),
        }
    };
    let single = SETS.into_iter().filter(|_| set.len() == 1);
    let instead = single.filter(|other| other.len() == 1 && *other != set && can(other));
    Infeasible {
        unheld: set.iter().map(unheld).collect(),
        instead: instead.map(|other| other[0]).collect(),
        row: row(task.limits),
    }
}
