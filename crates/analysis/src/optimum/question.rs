//! Question about a car with a CVT, and the answer in numbers.

use super::limits::Infeasible;
use cvtcycle_config::Problems;
use cvtcycle_config::cycle::Cycle;
use cvtcycle_config::setup::Setup;
use cvtcycle_model::drive::{Conditions, Row};
use serde::Serialize;

/// A car under one of its clamp laws.
#[derive(Clone, Copy, Debug)]
pub struct LawCar<'a> {
    /// Name of the law.
    pub law: &'a str,
    /// Input of the car.
    pub setup: &'a Setup,
}

/// Task and limits of the optimization.
#[derive(Clone, Copy, Debug)]
pub struct Question<'a> {
    /// The car with its own clamp law, then with the others.
    pub cars: &'a [LawCar<'a>],
    /// The cycle.
    pub cycle: &'a Cycle,
    /// How it is driven.
    pub conditions: Conditions,
    /// Least engine speed with the clutch locked, rpm.
    pub least_rpm: f64,
    /// Share of full load that is kept.
    pub reserve: f64,
    /// Least safety factor and largest slip of a free clamp; none: no bound for one.
    pub free: Option<(f64, f64)>,
    /// Rates of ln I towards high and low, 1/s; those of the car if there are none.
    pub rates_per_s: Option<(f64, f64)>,
    /// Ratios of the grid.
    pub grid: usize,
    /// True to search for the operating line.
    pub line: bool,
    /// True to compute the worth of a clutch that carries any torque at idle speed.
    pub launch_at_idle: bool,
    /// Other least engine speeds, rpm.
    pub least_speeds_rpm: &'a [f64],
    /// Other cycles on which the line is driven.
    pub elsewhere: &'a [Cycle],
}

/// The bound for one clamp law.
#[derive(Clone, Debug, Serialize)]
pub struct LawBound {
    /// Clamp law, or `free`.
    pub clamp: String,
    /// Speed of the engine over a slipping clutch: by its `law` (LC-1), or `idle` (LC-7).
    pub launch: &'static str,
    /// Fuel of the car with this law and its own ratio control, L/100 km; none for `free`.
    pub own_l_per_100km: Option<f64>,
    /// Time in which that car keeps less engine speed or reserve than the limits want, with the clutch locked, s.
    pub own_outside_s: Option<f64>,
    /// Fuel with this law and the operating line, L/100 km.
    pub line_l_per_100km: Option<f64>,
    /// Time outside the limits with the line, s.
    pub line_outside_s: Option<f64>,
    /// Least fuel (DP-9).
    pub least_l_per_100km: f64,
    /// Tolerance (DP-11).
    pub tolerance_l_per_100km: f64,
    /// The bound: least fuel less its tolerance; of a free clamp no more than that of a law that keeps its limits.
    pub bound_l_per_100km: f64,
    /// Least safety factor on the best path while the coupling is locked.
    pub least_safety: f64,
    /// Largest slip there, per cent.
    pub most_slip_percent: f64,
    /// Fuel of the best path as driven (DP-10).
    pub driven_l_per_100km: f64,
    /// That above the least fuel less the tolerance, per cent.
    pub gap_percent: f64,
    /// Least fuel by ratios of the grid, coarsest first.
    pub grid: Vec<(usize, f64)>,
    /// Least fuel in each set of temperatures, on half of the grid.
    pub temperatures: Vec<f64>,
}

/// Price of a limit.
#[derive(Clone, Debug, Serialize)]
pub struct LimitPrice {
    /// Limit.
    pub limit: &'static str,
    /// Fuel saved without it, per cent.
    pub percent: f64,
}

/// The line on a cycle that it is not made for.
#[derive(Clone, Debug, Serialize)]
pub struct Elsewhere {
    /// Cycle.
    pub cycle: String,
    /// Fuel of the car as it is, L/100 km.
    pub own_l_per_100km: f64,
    /// Fuel with the line, L/100 km.
    pub line_l_per_100km: f64,
    /// Time with the line in which the engine is below its least speed where a lower ratio would have held it, s.
    pub line_below_s: f64,
}

/// Speeds below which the coupling does not stay locked (LC-5, TC-7), where a ratio is chosen.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct LockFloor {
    /// The lowest of them, rpm.
    pub least_rpm: f64,
    /// The highest, rpm.
    pub most_rpm: f64,
    /// Time in which they are above the least engine speed, which then decides nothing, s.
    pub above_s: f64,
}

/// The operating line.
#[derive(Clone, Debug, Serialize)]
pub struct LineAnswer {
    /// Share of rated power, per cent; engine speed, rpm.
    pub drive: Vec<(f64, f64)>,
    /// Road speed, km/h; engine speed, rpm.
    pub overrun: Vec<(f64, f64)>,
    /// Fuel of the car of the vehicle file, read and driven as `run` drives it.
    pub l_per_100km: f64,
    /// That above the least fuel with the same clamp law, per cent: what looking ahead is worth.
    pub above_least_percent: f64,
    /// The same above the least fuel less the tolerance.
    pub above_bound_percent: f64,
    /// True if the car of the file burns as much as the line.
    pub proven: bool,
    /// Slowest engine where there is a choice, rpm.
    pub slowest_rpm: f64,
    /// Drives that the search took.
    pub drives: usize,
    /// Fuel on other cycles.
    pub elsewhere: Vec<Elsewhere>,
    /// Options that must be given again with the file: it has all others.
    pub again: Vec<String>,
    /// The vehicle file.
    #[serde(skip)]
    pub file: String,
}

/// The answer.
#[derive(Clone, Debug, Serialize)]
pub struct Answer {
    /// By clamp law, that of the car first.
    pub bounds: Vec<LawBound>,
    /// Least fuel with the car's law by least engine speed, rpm; none where no ratio holds it.
    pub least_speeds: Vec<(f64, Option<f64>)>,
    /// Price of each limit with the car's law, and that of a clutch which needs its speed to carry a torque.
    pub limits: Vec<LimitPrice>,
    /// Where the coupling's own limit is above the least engine speed; none where no ratio is chosen with it locked.
    pub lock_floor: Option<LockFloor>,
    /// The operating line, if it was sought.
    pub line: Option<LineAnswer>,
    /// Failed checks.
    pub failures: Vec<String>,
    /// Rows of the best path as driven, with the car's law.
    #[serde(skip)]
    pub path: Vec<Row>,
}

/// Why there is no answer.
#[derive(Debug)]
pub enum NoAnswer {
    /// The limits cannot be held.
    Infeasible(Box<Infeasible>),
    /// The line's own file cannot be read.
    Line(Problems),
    /// The car has no CVT.
    NoCvt,
    /// The box has two ranges, which the program does not choose.
    TwoRanges,
}
