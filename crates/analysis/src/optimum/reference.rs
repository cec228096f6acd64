//! A drive that the program starts from: its states and rows, and what heat is worth along it.
//!
//! | label | statement | status |
//! |---|---|---|
//! | DP-7 | mu_N = 0, mu_t = A_t' mu_(t+1) + dm_t/dT; A_t = dT_(t+1)/dT_t and dm_t/dT of the held step by differences of 5 K | derived: adjoint of the drive's own steps |
//! | DP-8 | worth of a joule into node i in step t: -(A_t' mu_(t+1))_i/C_i kg of fuel burnt less afterwards | derived: DP-7; heat of a step and heat stored before it act alike |

use cvtcycle_model::drive::{Car, Drive, Row, State};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::thermal::NODES;
use cvtcycle_model::transmission::cvt::Hold;

use super::Task;

/// Rise of a node for the differences of DP-7, K.
const RISE_K: f64 = 5.0;

/// A drive, step by step.
#[derive(Clone, Debug)]
pub struct Reference {
    /// State before each step.
    pub before: Vec<State>,
    /// Row of each step.
    pub rows: Vec<Row>,
    /// Ratio and clamp law of each step.
    pub holds: Vec<Hold>,
}

/// Observer of each step of a drive: its number, the state before it, its controls, and its row.
type Seen<'a> = dyn FnMut(usize, State, Option<Hold>, &Row) + 'a;

/// Drives the steps of a task with a car, each held as `hold` says from its number and the state before it, or by the car's own controller where
/// it says nothing; `see` is given the state before each step, what held it, and its row. A task that begins warm is driven once before that.
pub fn follow(
    task: &Task,
    car: &Car,
    hold: impl Fn(usize, &State) -> Option<Hold>,
    mut see: impl FnMut(usize, State, Option<Hold>, &Row),
) {
    let whole = |start: State, see: &mut Seen| {
        let mut drive = Drive::along(car, task.trace, start);
        for (k, step) in task.steps.iter().enumerate() {
            let state = drive.state();
            let hold = hold(k, &state);
            let (row, _) = match &hold {
                Some(hold) => drive.step_held(step, hold),
                None => drive.step(step),
            };
            see(k, state, hold, &row);
        }
        drive.state()
    };
    let mut start = task.start;
    if task.warm {
        let end = whole(start, &mut |_, _, _, _| ());
        start = State {
            transmission: None,
            ..end
        };
    }
    whole(start, &mut see);
}

impl Reference {
    /// A drive of a task, each step held as `hold` says; by the car's own controller where it says nothing.
    pub fn drive(task: &Task, hold: impl Fn(usize, &State) -> Option<Hold>) -> Self {
        let (mut before, mut rows, mut holds) = (Vec::new(), Vec::new(), Vec::new());
        follow(task, task.car, hold, |_, state, hold, row| {
            before.push(state);
            holds.push(hold.unwrap_or(Hold {
                ratio: row.belt_ratio,
                clamp: None,
                end: None,
                paced: false,
            }));
            rows.push(*row);
        });
        Reference {
            before,
            rows,
            holds,
        }
    }

    /// Fuel of the drive, kg.
    pub fn fuel_kg(&self) -> f64 {
        self.rows.iter().map(|row| row.fuel_kg_s * row.dt_s).sum()
    }

    /// True where the coupling had locked before a step.
    pub fn coupled_before(&self, step: usize) -> bool {
        let state = &self.before[step].transmission;
        state.as_ref().is_some_and(|state| state.driveline.coupled)
    }

    /// Fuel that a joule of heat into each node in a step saves afterwards, kg/J (DP-8), with the same ratios driven in other temperatures.
    pub fn worth_kg_j(&self, task: &Task) -> Vec<[f64; NODES]> {
        let car = task.car;
        let mut worth = vec![[0.0; NODES]; task.steps.len()];
        let mut mu = [0.0; NODES];
        for (k, step) in task.steps.iter().enumerate().rev() {
            // The first step has no transmission yet that could be held.
            if self.before[k].transmission.is_none() {
                continue;
            }
            let one = |state: State| {
                let mut drive = Drive::along(car, task.trace, state);
                let (row, _) = drive.step_held(step, &self.holds[k]);
                let open = row.flags.contains(Flags::LOCKUP_OPEN);
                (drive.state().heat.node_k, row.fuel_kg_s * row.dt_s, open)
            };
            let (end_k, fuel_kg, open) = one(self.before[k]);
            let mut now = [0.0; NODES];
            for node in 0..NODES {
                if car.network.capacity_j_k[node] <= 0.0 {
                    continue;
                }
                let by = |rise_k: f64| {
                    let mut other = self.before[k];
                    other.heat.node_k[node] += rise_k;
                    (one(other), rise_k)
                };
                // Where warmer oil locks the coupling, colder oil does not (DP-14).
                let mut found = by(RISE_K);
                if found.0.2 != open {
                    found = by(-RISE_K);
                }
                let ((other_k, other_kg, _), rise_k) = found;
                let slope = |other: f64, own: f64| (other - own) / rise_k;
                let later: f64 = (0..NODES)
                    .map(|i| slope(other_k[i], end_k[i]) * mu[i])
                    .sum();
                worth[k][node] = -later / car.network.capacity_j_k[node]; // DP-8
                now[node] = later + slope(other_kg, fuel_kg); // DP-7
            }
            mu = now;
        }
        worth
    }
}
