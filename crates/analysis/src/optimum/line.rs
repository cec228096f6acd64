//! The operating line: engine speed over demand while driving, over road speed in overrun.
//!
//! | label | statement | status |
//! |---|---|---|
//! | DP-12 | nodes of n_d(P/P_rated) and n_o(v) that burn least when driven by RC-13: from the means of the best path, each node moved up and down by 320, 160 ... 5 rpm while that burns less; n_d nowhere below 0.96 of itself at less demand | derived: search by the model's own drive, one node at a time |
//!
//! A controller that looks at demand and speed knows nothing of what comes: what its best line burns more than the bound is the worth of looking ahead.

use cvtcycle_model::drive::{Car, Row};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::keys::{Quantity, rpm};
use cvtcycle_model::math::Curve;
use cvtcycle_model::prime_mover::PrimeMover;
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::cvt::controller::{ColdRise, OperatingLine};

use super::reference::follow;
use super::{Bound, Task};

/// Nodes of the drive line, per cent of rated power. ASSUMED: nearer to each other where cycles have most of their time, below a fifth of rated power.
const SHARES_PERCENT: [f64; 12] = [
    0.0, 2.0, 4.0, 6.0, 9.0, 12.0, 16.0, 22.0, 30.0, 45.0, 70.0, 100.0,
];
/// Nodes of the overrun line, km/h. ASSUMED: from the speed at which low gives the least speeds to beyond the cycles.
const SPEEDS_KMH: [f64; 9] = [0.0, 15.0, 25.0, 35.0, 50.0, 70.0, 90.0, 120.0, 160.0];
/// Steps of the search, rpm. ASSUMED: the first crosses a hump of the fuel cut's ramp, the last moves the fuel by less than it is printed with.
const STEPS_RPM: [f64; 7] = [320.0, 160.0, 80.0, 40.0, 20.0, 10.0, 5.0];
/// Most passes over the nodes with one step. ASSUMED: a fifth one moves the fuel of ECE15+EUDC by less than 0.01 %.
const PASSES: usize = 4;
/// Part of the speed at less demand that a node of the drive line may be below it. ASSUMED: slip, 0.5 to 3 % in drive, makes the engine faster than
/// its target, and more of it with more demand.
const BELOW: f64 = 0.96;
/// Fuel that a joule missing at the wheels counts for, kg/J. ASSUMED: five times what an engine of 30 % needs for it, 1/(0.3 43 MJ/kg).
const MISSED_KG_J: f64 = 4e-7;
/// Fuel that a second counts for, kg, times the share of the least speed or of full load by which a limit is not kept. ASSUMED: 2 g are more than an
/// engine burns in a second of a cycle, so that no limit is traded for fuel.
const OUTSIDE_KG_S: f64 = 2e-3;
/// Share of the least speed or of full load by which a limit is not kept. ASSUMED: above the slip in overrun, which makes the engine slower than its target.
pub const OUTSIDE: f64 = 0.01;
/// Efficiency with which the route over the engine's best points is begun where the cycle demands no such power. As RC-3 reckons; ASSUMED.
const ROUTE_EFFICIENCY: f64 = 0.85;

/// Engine speeds among which the best point of a power is looked for: 25 rpm from each other. ASSUMED: what is begun with is searched on.
const SPEEDS: u32 = 200;

/// A drive line and an overrun line, in the units of a vehicle file.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Share of rated power, per cent; engine speed, rpm.
    pub drive: Vec<(f64, f64)>,
    /// Road speed, km/h; engine speed, rpm.
    pub overrun: Vec<(f64, f64)>,
}

/// A line and how well it does.
#[derive(Clone, Debug)]
pub struct LineFit {
    /// The line.
    pub line: Line,
    /// Fuel of the car driven by it, kg.
    pub fuel_kg: f64,
    /// Fuel by the means of the best path, before the search, kg.
    pub first_kg: f64,
    /// Drives that the search took.
    pub drives: usize,
    /// Slowest engine in a step that leaves a choice, rad/s.
    pub slowest_rad_s: f64,
}

impl Line {
    /// The car with this line in place of its own, its demand unfiltered, without hysteresis, and the same in a cold car.
    #[must_use]
    pub fn on(&self, car: &Car) -> Car {
        let curve = |points: &[(f64, f64)], unit: &str| {
            let (x, y) = (Quantity::from_key(unit), Quantity::from_key("speed_rpm"));
            let points: Vec<(f64, f64)> = points
                .iter()
                .map(|(a, b)| (x.to_si(*a), y.to_si(*b)))
                .collect();
            Curve::new(&points).ok()
        };
        let mut car = car.clone();
        if let Transmission::Cvt(cvt) = &mut car.transmission {
            cvt.ratio.hysteresis = 0.0;
            cvt.ratio.filter_s = 0.0;
            cvt.ratio.cold = ColdRise::NONE;
            cvt.ratio.line = Some(Box::new(OperatingLine {
                drive: curve(&self.drive, "power_percent"),
                overrun: curve(&self.overrun, "speed_kmh"),
            }));
        }
        car
    }

    /// The line with a node moved by so many rpm, within limits; other nodes of the drive line go along as far as its order needs it.
    fn moved(&self, k: usize, by: f64, limits: (f64, f64)) -> Line {
        let mut line = self.clone();
        let count = line.drive.len();
        let node = match k < count {
            true => &mut line.drive[k].1,
            false => &mut line.overrun[k - count].1,
        };
        *node = (*node + by).clamp(limits.0, limits.1);
        if k < count {
            order(&mut line.drive, k);
        }
        line
    }
}

/// More demand, no slower an engine, but for slip: nodes after the given one are raised, those before it lowered, as far as that needs it.
fn order(points: &mut [(f64, f64)], k: usize) {
    for j in k + 1..points.len() {
        points[j].1 = points[j].1.max((BELOW * points[j - 1].1).ceil());
    }
    for j in (0..k).rev() {
        points[j].1 = points[j].1.min((points[j + 1].1 / BELOW).floor());
    }
}

/// Fuel of a drive, and what counts as fuel for what is not allowed.
pub struct Burnt {
    /// Fuel, kg.
    pub fuel_kg: f64,
    /// The same with what counts as fuel, kg.
    counted_kg: f64,
    /// Slowest engine in a step that leaves a choice, rad/s.
    pub slowest_rad_s: f64,
    /// Time in such steps outside the limits of speed and reserve, s.
    pub outside_s: f64,
}

/// A car on the steps of a task by its own controller; limits count where a ratio is chosen and the coupling is locked.
pub fn burnt(task: &Task, chosen: &[bool], car: &Car) -> Burnt {
    let mut sum = Burnt {
        fuel_kg: 0.0,
        counted_kg: 0.0,
        slowest_rad_s: f64::INFINITY,
        outside_s: 0.0,
    };
    let mut see = |k: usize, row: &Row| {
        let fuel_kg = row.fuel_kg_s * row.dt_s;
        sum.fuel_kg += fuel_kg;
        sum.counted_kg += fuel_kg + MISSED_KG_J * row.deficit_w * row.dt_s;
        if chosen[k] && !row.flags.contains(Flags::LOCKUP_OPEN) {
            sum.slowest_rad_s = sum.slowest_rad_s.min(row.engine_speed_rad_s);
            let slow = 1.0 - row.engine_speed_rad_s / task.limits.least_rad_s;
            let short = row.throttle - (1.0 - task.limits.reserve);
            let missed = row.deficit_w > 0.0;
            let outside = if missed { slow } else { slow.max(short) };
            sum.counted_kg += OUTSIDE_KG_S * outside.max(0.0) * row.dt_s;
            if outside > OUTSIDE {
                sum.outside_s += row.dt_s;
            }
        }
    };
    follow(task, car, |_, _| None, |k, _, _, row| see(k, row));
    sum
}

/// The line that burns least, beginning at the means of the best path.
pub fn fit_line(task: &Task, bound: &Bound) -> LineFit {
    let mut line = means(task, bound);
    let driven = |line: &Line| burnt(task, &bound.chosen, &line.on(task.car));
    let whole = |line: &Line| driven(line).counted_kg;
    let first_kg = driven(&line).fuel_kg;
    let (mut best, mut drives) = (whole(&line), 1);
    let least_rpm = rpm(task.limits.least_rad_s).ceil();
    let most_rpm = rpm(task.car.engine.highest_rad_s).floor();
    let count = line.drive.len() + line.overrun.len();
    for step in STEPS_RPM {
        for _ in 0..PASSES {
            let before = best;
            for k in 0..count {
                let moved = |by: f64| {
                    let line = line.moved(k, by, (least_rpm, most_rpm));
                    (whole(&line), line)
                };
                let (up, down) = rayon::join(|| moved(step), || moved(-step));
                drives += 2;
                let other = if up.0 < down.0 { up } else { down };
                if other.0 < best {
                    (best, line) = other; // DP-12
                }
            }
            if best >= before {
                break;
            }
        }
    }
    let burnt = driven(&line);
    LineFit {
        line,
        fuel_kg: burnt.fuel_kg,
        first_kg,
        drives,
        slowest_rad_s: burnt.slowest_rad_s,
    }
}

/// Means of the best path's engine speeds at the nodes, in whole rpm; where the cycle demands no such power, the engine's best points.
fn means(task: &Task, bound: &Bound) -> Line {
    let rated_w = task.car.engine.rated_w;
    let chosen = || {
        let rows = bound.rows.iter().zip(&bound.chosen);
        rows.filter(|(_, chosen)| **chosen).map(|(row, _)| row)
    };
    let final_drive = task.cvt.final_drive.ratio;
    // The target is the speed of the box by its ratio, which over an open converter is not the engine's.
    let target_rpm = |row: &Row| {
        let wheel_rad_s = row.engine_speed_rad_s / row.overall_ratio;
        rpm(row.belt_ratio * final_drive * wheel_rad_s).max(rpm(task.limits.least_rad_s).ceil())
    };
    let drive: Vec<(f64, f64)> = chosen()
        .filter(|row| row.wheel_power_w > 0.0)
        .map(|row| (100.0 * row.wheel_power_w / rated_w, target_rpm(row)))
        .collect();
    let overrun: Vec<(f64, f64)> = chosen()
        .filter(|row| row.wheel_power_w <= 0.0)
        .map(|row| (3.6 * row.speed_m_s, target_rpm(row)))
        .collect();
    let least_rpm = rpm(task.limits.least_rad_s).ceil();
    let route = |percent: f64| best_point_rpm(task, percent / 100.0 * rated_w / ROUTE_EFFICIENCY);
    let mut overrun = at_nodes(&SPEEDS_KMH, &overrun, |_| None);
    if overrun.is_empty() {
        overrun.push((0.0, least_rpm));
    }
    let mut drive = at_nodes(&SHARES_PERCENT, &drive, |percent| Some(route(percent)));
    order(&mut drive, 0);
    Line { drive, overrun }
}

/// Means of points at nodes, each point shared between its two neighbours; `other` where there is none, and no node where that is none.
fn at_nodes(
    nodes: &[f64],
    points: &[(f64, f64)],
    other: impl Fn(f64) -> Option<f64>,
) -> Vec<(f64, f64)> {
    let share = |k: usize, x: f64| {
        let below = k.checked_sub(1).map(|k| nodes[k]);
        let above = nodes.get(k + 1).copied();
        match (x < nodes[k], below, above) {
            (true, Some(below), _) => (x - below) / (nodes[k] - below),
            (false, _, Some(above)) => (above - x) / (above - nodes[k]),
            _ => 1.0,
        }
        .max(0.0)
    };
    let mean = |k: usize| {
        let sums = points.iter().fold((0.0, 0.0), |(sum, weight), (x, y)| {
            let own = share(k, *x);
            (sum + own * y, weight + own)
        });
        match sums.1 > 0.0 {
            true => Some(sums.0 / sums.1),
            false => other(nodes[k]),
        }
    };
    (0..nodes.len())
        .filter_map(|k| Some((nodes[k], mean(k)?.round())))
        .collect()
}

/// Speed at which the warm engine gives a power with the least fuel, within the limits, rpm.
fn best_point_rpm(task: &Task, power_w: f64) -> f64 {
    let engine = &task.car.engine;
    let warm = engine.at(
        engine.hot_k,
        engine.hot_k,
        &task.car.engine_oil,
        task.car.charge,
    );
    let (low, high) = (task.limits.least_rad_s, engine.peak_power_rad_s());
    let speeds = (0..=SPEEDS).map(|k| low + (high - low) * f64::from(k) / f64::from(SPEEDS));
    let burn = |w: f64| {
        let crank_nm = power_w / w + warm.accessories_nm(w);
        let within = crank_nm <= (1.0 - task.limits.reserve) * warm.full_load_nm(w);
        within.then(|| (warm.burn(w, crank_nm).fuel_kg_s, w))
    };
    let best = speeds.filter_map(burn).min_by(|a, b| a.0.total_cmp(&b.0));
    rpm(best.map_or(high, |(_, w)| w)).round()
}
