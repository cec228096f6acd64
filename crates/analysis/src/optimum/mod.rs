//! The least fuel that a car with a CVT can burn on a cycle: ratio and clamping pressure by dynamic programming, with the model's own losses
//! and temperatures; and the operating line that comes near it.
//!
//! | module | contents | labels |
//! |---|---|---|
//! | `place` | a place between two nodes, and the value there | |
//! | `program` | the dynamic program, without physics | DP-1, DP-3, DP-6 |
//! | `scene` | a car on the steps of a trace | |
//! | `node` | the numbers of a step at one ratio | |
//! | `nodes` | what engine and box do in a step at a ratio | DP-4, DP-13, DP-14 |
//! | `stage` | which ratios a step may have: all in a table, and what the limits leave | DP-5 |
//! | `stages` | the car on its trace as stages of the program | DP-2, DP-5 |
//! | `reference` | a drive with its states, and the worth of heat | DP-7, DP-8 |
//! | `line` | curves of engine speed over demand and road speed, improved by driving | DP-12 |
//! | `limits` | what each limit costs, and which one cannot be held | |
//! | `file` | the line as a vehicle file | |
//! | `question` | what is asked, and the answer in numbers | |
//! | `answer` | all of it for a car, its clamp laws and a cycle | |
//!
//! | label | statement | status |
//! |---|---|---|
//! | DP-9 | J = V_0 + sum of worth_i P_i dt of the reference: least fuel, temperatures to first order | derived: linear terms of the heat that differs from the reference's |
//! | DP-10 | D: fuel of the path, driven with its ratios and clamp law held (RC-12) | derived: what a controller that knows the cycle burns in the model |
//! | DP-11 | tolerance = \|J - J of half the grid\| + \|J - J of the temperatures before\| = tau_0, + 2 max(0, J - tau_0 - D); bound = J - tolerance | derived: no credit for the order of convergence |
//!
//! Every controller of ratio, pressure and clutch within the limits drives one of the paths, but for the way of the ratio within a step (RC-17),
//! which moves the fuel by 0.1 % at most; the rest that is left out (DP-2) lowers it or is in the tolerance: no such controller burns less than the
//! bound by more than that. Temperatures follow the path: the program is solved in those of a drive, its path is driven, and
//! so on until the fuel settles; what another controller's heat would save later is in the worth of heat.

mod answer;
mod file;
mod limits;
mod line;
mod node;
mod nodes;
mod place;
mod program;
mod question;
mod reference;
mod scene;
mod stage;
mod stages;

pub use answer::{TIGHT, answer};
pub use file::ReadFrom;
pub use limits::{Infeasible, LimitName, Unheld};
pub use line::{Line, LineFit, fit_line};
pub use question::{
    Answer, Elsewhere, LawBound, LawCar, LimitPrice, LineAnswer, LockFloor, NoAnswer, Question,
};

use cvtcycle_model::cycle::{Step, Trace};
use cvtcycle_model::drive::{Car, Row, State};
use cvtcycle_model::thermal::NODES;
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::cvt::{Cvt, Hold};
use rayon::prelude::*;

use self::node::Mode;
use self::program::{Controls, Path, least};
use self::reference::Reference;
use self::scene::Scene;
use self::stage::Table;
use self::stages::Problem;

/// Largest change of the driven fuel between two sets of temperatures that is taken for settled.
const SETTLED: f64 = 2e-4;
/// Most sets of temperatures.
const MAX_TEMPERATURES: usize = 6;
/// Part of what the best path, driven, burns less than the least fuel less the other tolerances that is in the tolerance. ASSUMED: once for that path, and as much again for
/// others, which have the same launches and changes down in overrun.
const LAG: f64 = 2.0;
/// Strides of the coarser grids, coarsest first.
const STRIDES: [usize; 2] = [4, 2];

/// Limits within which the least fuel is sought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Least engine speed with the clutch locked, rad/s.
    pub least_rad_s: f64,
    /// Share of full load that is kept.
    pub reserve: f64,
    /// Rate of ln I towards high, 1/s.
    pub up_per_s: f64,
    /// Rate of ln I towards low, 1/s.
    pub down_per_s: f64,
}

/// Control of the clamping pressure of the belt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Clamp {
    /// The car's law.
    Law,
    /// Any pressure with a safety factor of at least this, and a slip of at most that.
    Free {
        /// Least capacity over torque.
        safety: f64,
        /// Largest slip.
        slip: f64,
    },
}

/// Drives to be optimized.
#[derive(Clone, Copy, Debug)]
pub struct Task<'a> {
    /// The car.
    pub car: &'a Car,
    /// CVT of the car.
    pub cvt: &'a Cvt,
    /// The steps of the trace.
    pub steps: &'a [Step],
    /// The trace, with rows where start-stop may stop the engine.
    pub trace: &'a Trace,
    /// State before the first step.
    pub start: State,
    /// True if each drive is warmed up by itself: it begins in the state in which the same drive from `start` ends.
    pub warm: bool,
    /// Control of the clamping pressure.
    pub clamp: Clamp,
    /// Limits.
    pub limits: Limits,
    /// Ratios of the grid: four times a number, and one.
    pub grid: usize,
    /// Other least engine speeds, rad/s.
    pub least_speeds_rad_s: &'a [f64],
    /// Limits whose price is wanted.
    pub prices: &'a [LimitName],
}

/// The least fuel of a task.
#[derive(Clone, Debug)]
pub struct Bound {
    /// Least fuel J, kg (DP-9).
    pub fuel_kg: f64,
    /// Tolerance, kg (DP-11).
    pub tolerance_kg: f64,
    /// Fuel of the path as driven, kg (DP-10).
    pub driven_kg: f64,
    /// Least fuel on coarser grids, coarsest first: ratios, kg.
    pub coarser: Vec<(usize, f64)>,
    /// Least fuel in each set of temperatures, kg.
    pub temperatures: Vec<f64>,
    /// Least fuel for other least engine speeds: rad/s, kg.
    pub least_speeds: Vec<(f64, Option<f64>)>,
    /// Least fuel without one of the limits, kg.
    pub without: Vec<(LimitName, f64)>,
    /// Rows of the path as driven.
    pub rows: Vec<Row>,
    /// Controls of each step.
    pub holds: Vec<Hold>,
    /// Steps in which a ratio is chosen and the limits of speed and reserve count while the coupling is locked.
    pub chosen: Vec<bool>,
    /// Speed below which the coupling does not stay locked there, rad/s.
    pub floor_rad_s: Vec<Option<f64>>,
}

impl Bound {
    /// Lower bound of the fuel of any controller within the limits, kg.
    pub fn least_kg(&self) -> f64 {
        self.fuel_kg - self.tolerance_kg
    }

    /// Fuel of the driven path above the bound, as a share.
    pub fn gap(&self) -> f64 {
        self.driven_kg / self.least_kg() - 1.0
    }
}

/// The CVT of a car.
pub fn cvt(car: &Car) -> Option<&Cvt> {
    match &car.transmission {
        Transmission::Cvt(cvt) => Some(cvt),
        Transmission::Manual(_) => None,
    }
}

/// A solved program in the temperatures of a reference.
struct Solved {
    reference: Reference,
    worth: Vec<[f64; NODES]>,
    table: Table,
    /// Least fuel J, kg.
    fuel_kg: f64,
    /// Worth of the heat of the reference, kg.
    worth_kg: f64,
    holds: Vec<Hold>,
    /// Mode of the coupling where a ratio is chosen.
    modes: Vec<Option<Mode>>,
    limited: Vec<bool>,
}

/// The least fuel of a task.
///
/// # Errors
/// The limits cannot be held.
///
/// ```
/// use cvtcycle_config::cycle::Cycle;
/// use cvtcycle_config::setup::{Options, load};
/// use cvtcycle_model::cycle::Interval;
/// use cvtcycle_model::drive::State;
/// use cvtcycle_model::keys::rad_s;
/// use cvtcycle_analysis::optimum::{Clamp, Limits, Task, bound, cvt};
/// let car = load("rover_216_cvt", &Options::default())?.car(298.15);
/// // From 12 m/s, 0.3 m/s faster each second.
/// let interval = |k: u32| Interval {
///     start_s: k.into(),
///     end_s: (k + 1).into(),
///     start_speed_m_s: 12.0 + 0.3 * f64::from(k),
///     end_speed_m_s: 12.0 + 0.3 * f64::from(k + 1),
///     phase: 0,
///     grade: 0.0,
///     engine_off: false,
/// };
/// let cycle = Cycle::from_intervals("gentle", (0..6).map(interval).collect()).expect("rising");
/// let trace = cycle.trace_for(true);
/// let steps: Vec<_> = trace.steps(1.0).collect();
/// let cvt = cvt(&car).expect("a CVT");
/// let limits = Limits {
///     least_rad_s: rad_s(1100.0),
///     reserve: 0.1,
///     up_per_s: cvt.ratio.up_per_s,
///     down_per_s: cvt.ratio.down_per_s,
/// };
/// let task = Task {
///     car: &car,
///     cvt,
///     steps: &steps,
///     trace,
///     start: State::at(363.15),
///     warm: false,
///     clamp: Clamp::Law,
///     limits,
///     grid: 25,
///     least_speeds_rad_s: &[],
///     prices: &[],
/// };
/// let bound = bound(&task).expect("the limits can be held");
/// assert!(bound.least_kg() <= bound.driven_kg);
/// # Ok::<(), cvtcycle_config::Problems>(())
/// ```
pub fn bound(task: &Task) -> Result<Bound, Box<Infeasible>> {
    let scene = Scene::new(task);
    let (reference, temperatures) = settled(&scene, task)?;
    let solved = Solved::new(&scene, task, reference, task.grid)?;
    let driven = solved.drive(&scene, task);
    let coarser = STRIDES.into_par_iter().map(|stride| {
        let table = solved.table.coarser(stride);
        let fuel_kg = solved.least_kg(&scene, &table, task.limits);
        (table.grid.len(), fuel_kg.unwrap_or(f64::INFINITY))
    });
    let coarser: Vec<(usize, f64)> = coarser.collect();
    let grid_kg = coarser.last().map_or(0.0, |c| (c.1 - solved.fuel_kg).abs());
    let settled_kg = (change(&temperatures) - 1.0).abs() * solved.fuel_kg;
    let locked_kg = solved
        .warmer_kg(&scene, task)
        .map_or(0.0, |kg| solved.fuel_kg - kg); // DP-14
    let known_kg = grid_kg + settled_kg + locked_kg.max(0.0);
    let lag_kg = LAG * (solved.fuel_kg - known_kg - driven.fuel_kg()).max(0.0);
    let at = |least_rad_s: &f64| {
        let limits = Limits {
            least_rad_s: *least_rad_s,
            ..task.limits
        };
        (*least_rad_s, solved.least_kg(&scene, &solved.table, limits))
    };
    let without = |name: &LimitName| {
        let limits = name.dropped(task.limits);
        Some((*name, solved.least_kg(&scene, &solved.table, limits)?))
    };
    Ok(Bound {
        fuel_kg: solved.fuel_kg,
        tolerance_kg: known_kg + lag_kg, // DP-11
        driven_kg: driven.fuel_kg(),     // DP-10
        least_speeds: task.least_speeds_rad_s.par_iter().map(at).collect(),
        without: task.prices.par_iter().filter_map(without).collect(),
        coarser,
        temperatures,
        rows: driven.rows,
        holds: driven.holds,
        floor_rad_s: solved.table.floors_rad_s(&solved.limited),
        chosen: solved.limited,
    })
}

/// The best path's drive in its own temperatures, and the least fuel in each set of temperatures on the way; on half of the grid.
fn settled(scene: &Scene, task: &Task) -> Result<(Reference, Vec<f64>), Box<Infeasible>> {
    let half = task.grid / 2 + 1;
    let mut driven = Reference::drive(task, |_, _| None);
    let (mut least, mut fuel_kg) = (Vec::new(), f64::INFINITY);
    loop {
        let solved = Solved::new(scene, task, driven, half)?;
        driven = solved.drive(scene, task);
        least.push(solved.fuel_kg);
        let moved = [driven.fuel_kg() / fuel_kg, change(&least)];
        fuel_kg = driven.fuel_kg();
        let settled = moved.iter().all(|ratio| (ratio - 1.0).abs() < SETTLED);
        if settled || least.len() >= MAX_TEMPERATURES {
            return Ok((driven, least));
        }
    }
}

/// The last of a list over the one before it; infinite for a single one.
fn change(list: &[f64]) -> f64 {
    match list {
        [.., before, now] => now / before,
        _ => f64::INFINITY,
    }
}

impl Solved {
    fn new(
        scene: &Scene,
        task: &Task,
        reference: Reference,
        grid: usize,
    ) -> Result<Self, Box<Infeasible>> {
        let worth = reference.worth_kg_j(task);
        let table = Table::new(scene, &reference, grid);
        let problem = Problem::new(scene, &table, &reference, &worth, task.limits);
        let Ok(path) = least_path(&problem) else {
            return Err(Box::new(limits::infeasible(
                scene, &table, &reference, &worth, task,
            )));
        };
        let worth_kg = scene.worth_kg(&reference, &worth);
        let fuel_kg = path.total() + worth_kg; // DP-9
        let holds = problem.holds(&path);
        let modes = problem.modes(&path);
        let limited = (0..task.steps.len()).map(|k| problem.limited(k)).collect();
        drop(problem);
        Ok(Solved {
            worth,
            table,
            fuel_kg,
            worth_kg,
            holds,
            modes,
            limited,
            reference,
        })
    }

    /// The path, driven in its own temperatures.
    fn drive(&self, scene: &Scene, task: &Task) -> Reference {
        Reference::drive(task, |k, state| {
            let hold = self.holds[k];
            Some(match self.modes[k] {
                Some(mode) => scene.within(k, state, (hold, mode), &task.limits),
                None => hold,
            })
        })
    }

    /// Least fuel, kg, with oil that is warmer where it locks the coupling; none where no temperature does.
    fn warmer_kg(&self, scene: &Scene, task: &Task) -> Option<f64> {
        let scene = scene.warmer(&self.reference)?;
        let table = Table::new(&scene, &self.reference, task.grid);
        self.least_kg(&scene, &table, task.limits)
    }

    /// Least fuel under other limits, kg, in the same temperatures but for the worth of what heat differs (DP-9); none where they cannot be held.
    fn least_kg(&self, scene: &Scene, table: &Table, limits: Limits) -> Option<f64> {
        let problem = Problem::new(scene, table, &self.reference, &self.worth, limits);
        let path = least_path(&problem).ok()?;
        Some(path.total() + self.worth_kg) // DP-9
    }
}

/// The path with the least fuel; or the step that cannot be driven.
fn least_path(problem: &Problem) -> Result<Path, usize> {
    least(problem, Controls::WithEnds)
}
