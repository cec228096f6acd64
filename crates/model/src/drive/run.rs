//! One car through one cycle: start state, drive, totals, rows on request.

use std::borrow::Cow;

use crate::cycle::{Cycle, Trace};
use crate::drive::{Car, CarTrace, Recorder, State, Vehicle, simulate};
use crate::drive::{EnergyTerms, Row, Totals};
use crate::engine::StartStop;
use crate::math::larger;
use crate::prime_mover::PrimeMover;
use crate::thermal::{Heat, StartTemperatures};
use crate::transmission::Transmission;

/// Temperatures at the start of a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Start {
    /// Everything at ambient.
    Soak,
    /// The same cycle has just been driven from a soak, without a pause; it is not counted.
    Warm,
    /// All nodes at a temperature, K.
    At(f64),
    /// Nodes at temperatures of their own (TH-10).
    Nodes(StartTemperatures),
}

/// Output wanted of a run.
#[derive(Clone, Copy, Debug)]
pub struct Conditions {
    /// Ambient temperature, K.
    pub ambient_k: f64,
    /// Start.
    pub start: Start,
    /// Largest step, s.
    pub max_dt_s: f64,
    /// True to keep every row.
    pub keep_rows: bool,
}

/// Result of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Sums.
    pub totals: Totals,
    /// Rows, empty unless asked for.
    pub rows: Vec<Row>,
    /// Temperatures at the end.
    pub end: Heat,
    /// Gear schedule in force, in words; empty for a CVT.
    pub gear_schedule: &'static str,
}

/// Takes rows, some at a time and in order.
pub type RowSink<'g> = dyn FnMut(&[Row]) + 'g;

/// Rows that are given away at a time: few enough to stay in the processor's cache.
const CHUNK: usize = 32;

/// Keeps totals and gives rows away in lots; for totals alone, [`Totals`] themselves listen, so that no row need exist.
struct ChunkedRecorder<'g> {
    totals: Totals,
    lot: Vec<Row>,
    give: &'g mut RowSink<'g>,
}

impl Recorder for ChunkedRecorder<'_> {
    fn record(&mut self, row: &Row, terms: &EnergyTerms) {
        self.totals.record(row, terms);
        self.lot.push(*row);
        if self.lot.len() == CHUNK {
            (self.give)(&self.lot);
            self.lot.clear();
        }
    }
}

/// Change of the stored energy over the fuel's up to which a drive is balanced (SG-6), ...
const BALANCED: f64 = 1e-3;
/// ... and the most repeats until it is. ASSUMED, numerical.
const MAX_REPEATS: usize = 8;

/// Drops everything.
struct NullRecorder;

impl Recorder for NullRecorder {
    fn record(&mut self, _: &Row, _: &EnergyTerms) {}
}

/// Drives a car through a cycle.
///
/// ```
/// use cvtcycle_config::{cycle::embedded, setup::{Options, load}};
/// use cvtcycle_model::drive::{Conditions, Start, drive, litres_per_100km};
///
/// let car = load("rover_216_cvt", &Options::default()).expect("a shipped car");
/// let cycle = embedded("ece15").expect("a shipped cycle");
/// let conditions = Conditions { ambient_k: 298.15, start: Start::Soak, max_dt_s: 1.0, keep_rows: false };
/// let total = drive(&car, &cycle, &conditions).totals.total();
/// assert!((5.0..15.0).contains(&litres_per_100km(total.fuel_kg, 745.0, total.distance_m)));
/// ```
pub fn drive(vehicle: &Vehicle, cycle: &Cycle, conditions: &Conditions) -> Outcome {
    if !conditions.keep_rows {
        return drive_into(vehicle, cycle, conditions, None);
    }
    let steps = cycle
        .trace_for(vehicle.transmission().is_cvt())
        .step_count(conditions.max_dt_s);
    let mut rows = Vec::with_capacity(steps);
    let outcome = drive_into(
        vehicle,
        cycle,
        conditions,
        Some(&mut |lot| rows.extend_from_slice(lot)),
    );
    Outcome { rows, ..outcome }
}

/// The same, but rows go to `give`, some at a time and in order, whatever `keep_rows` says, and none into the outcome.
pub fn drive_into(
    vehicle: &Vehicle,
    cycle: &Cycle,
    conditions: &Conditions,
    give: Option<&mut RowSink>,
) -> Outcome {
    let car = &vehicle.car(conditions.ambient_k);
    let CarTrace { trace, schedule } = vehicle.trace(cycle);
    let trace = &*own_trace(car, &trace);
    let start = start_state(car, trace, conditions);
    let mut totals = Totals::new(cycle.phases.len());
    let end = match give {
        Some(give) => {
            let mut lots = ChunkedRecorder {
                totals,
                lot: Vec::with_capacity(CHUNK),
                give,
            };
            let end = simulate(car, trace, conditions.max_dt_s, start, &mut lots);
            (lots.give)(&lots.lot);
            totals = lots.totals;
            end
        }
        None => simulate(car, trace, conditions.max_dt_s, start, &mut totals),
    };
    Outcome {
        totals,
        rows: Vec::new(),
        end: end.heat,
        gear_schedule: schedule,
    }
}

/// The state in which a car begins a trace.
pub fn start_state(car: &Car, trace: &Trace, conditions: &Conditions) -> State {
    let start = match conditions.start {
        Start::Soak => State::at(conditions.ambient_k),
        Start::At(temp_k) => State::at(temp_k),
        Start::Nodes(nodes) => {
            let (heat, tyre_k) = nodes.at(conditions.ambient_k);
            State {
                heat,
                tyre_k,
                ..State::at(conditions.ambient_k)
            }
        }
        Start::Warm => simulate(
            car,
            trace,
            conditions.max_dt_s,
            State::at(conditions.ambient_k),
            &mut NullRecorder,
        ),
    };
    // A car at rest begins a new cycle in its own start state; only heat, rotating energy and the running engine carry over.
    let mut state = State {
        transmission: None,
        ..start
    };
    state.start_stop.on_s = 0.0; // a key-on of its own, after a warm-up too (SS-1)
    let machine = car
        .engine
        .start_stop
        .as_ref()
        .and_then(|on| on.machine.as_ref());
    if machine.is_some() {
        state.start_stop.drawn_j = balanced_j(car, trace, conditions.max_dt_s, state);
    }
    state
}

/// Fuel of a drive, J.
#[derive(Default)]
struct FuelRecorder {
    fuel_j: f64,
}

impl Recorder for FuelRecorder {
    fn record(&mut self, row: &Row, _: &EnergyTerms) {
        self.fuel_j += row.fuel_power_w * row.dt_s;
    }
}

/// Energy out of the store, J, with which a drive from a state begins and ends (SG-6).
fn balanced_j(car: &Car, trace: &Trace, max_dt_s: f64, mut state: State) -> f64 {
    for _ in 0..MAX_REPEATS {
        let mut fuel = FuelRecorder::default();
        let end = simulate(car, trace, max_dt_s, state, &mut fuel);
        let before_j = state.start_stop.drawn_j;
        state.start_stop.drawn_j = end.start_stop.drawn_j;
        if (state.start_stop.drawn_j - before_j).abs() < BALANCED * fuel.fuel_j {
            break;
        }
    }
    state.start_stop.drawn_j
}

/// The trace as a car drives it: with rows where its engine may stop and where it starts again, if it has start-stop, and where the driver of a manual
/// box changes gear or opens the clutch by speed (MB-5), or fuel comes back in overrun (EN-11), so that no step has two gears.
pub fn own_trace<'a>(car: &Car, trace: &'a Trace) -> Cow<'a, Trace> {
    let trace = match &car.engine.start_stop {
        Some(on) => Cow::Owned(cut_at_stops(trace, on)),
        None => Cow::Borrowed(trace),
    };
    let Transmission::Manual(manual) = &car.transmission else {
        return trace;
    };
    if trace.gears(manual.overall.len()).is_some() {
        return trace;
    }
    let radius_m = car.road_load.wheel_radius_m;
    let opens = manual.opens_m_s(car.engine.idle_hot_rad_s, radius_m);
    let cut = [car.engine.cut_above_rad_s, car.engine.fuel_back_rad_s];
    let cuts = cut.map(|rad_s| manual.passes_m_s(rad_s, radius_m)).concat();
    let falling = [&manual.shifts.down_m_s[..], &opens, &cuts].concat();
    match trace {
        Cow::Borrowed(trace) => trace.cut_at_speeds(&manual.shifts.up_m_s, &falling),
        Cow::Owned(trace) => {
            let cut = trace.cut_at_speeds(&manual.shifts.up_m_s, &falling);
            Cow::Owned(cut.into_owned())
        }
    }
}

/// The trace with rows where the engine may stop and where it starts again, so that a step is with or without it.
fn cut_at_stops(trace: &Trace, on: &StartStop) -> Trace {
    let ends = |(from_s, to_s): (f64, f64)| {
        let stop_s = from_s + on.delay_s;
        [stop_s, larger(to_s - on.lead_s, stop_s)]
    };
    let rests_s = trace.rests_s();
    let mut at_s: Vec<f64> = rests_s.iter().copied().flat_map(ends).collect();
    let first_s = on.first_stop_after_s;
    let within = |&(from_s, to_s): &(f64, f64)| from_s < first_s && first_s < to_s;
    if rests_s.iter().any(within) {
        let place = at_s.partition_point(|&time_s| time_s < first_s);
        at_s.insert(place, first_s);
    }
    trace.cut(&at_s)
}

/// An engine's fuel map on a grid.
#[derive(Clone, Debug, Default)]
pub struct FuelMap {
    /// Engine speeds, rad/s, ascending.
    pub speed_rad_s: Vec<f64>,
    /// Torques, Nm, ascending.
    pub torque_nm: Vec<f64>,
    /// Brake specific fuel consumption, kg/J: `bsfc_kg_j[i][k]` at `speed_rad_s[i]` and `torque_nm[k]`; NaN above full load.
    pub bsfc_kg_j: Vec<Vec<f64>>,
    /// Full-load torque at each speed, Nm.
    pub full_load_nm: Vec<f64>,
}

/// Hot fuel map of the engine for the operating-point plot, over the flywheel torque.
pub fn fuel_map(vehicle: &Vehicle) -> FuelMap {
    let car = vehicle.car(293.15);
    let hot = car
        .engine
        .at(car.engine.hot_k, car.engine.hot_k, &car.engine_oil, 1.0);
    let (lo, hi) = (car.engine.idle_hot_rad_s, car.engine.highest_rad_s);
    let speed_rad_s: Vec<f64> = (0..=40)
        .map(|i| lo + (hi - lo) * f64::from(i) / 40.0)
        .collect();
    let full_load_nm: Vec<f64> = speed_rad_s.iter().map(|&w| hot.full_load_nm(w)).collect();
    let most = full_load_nm.iter().copied().fold(0.0, |a, b| larger(b, a));
    let torque_nm: Vec<f64> = (1..=40).map(|i| most * f64::from(i) / 40.0).collect();
    let bsfc = |w: f64, t: f64| {
        if t <= hot.full_load_nm(w) + most / 40.0 {
            hot.burn(w, t).fuel_kg_s / (t * w)
        } else {
            f64::NAN
        }
    };
    let bsfc_kg_j = speed_rad_s
        .iter()
        .map(|&w| torque_nm.iter().map(|&t| bsfc(w, t)).collect())
        .collect();
    FuelMap {
        speed_rad_s,
        torque_nm,
        bsfc_kg_j,
        full_load_nm,
    }
}

/// Shortest distance that a consumption over distance is given for, m. ASSUMED, 1 to 100 m: two lengths of a car; over less it is the time at rest that is
/// measured.
pub const SHORTEST_M: f64 = 10.0;
/// Mean speed below which a drive has no consumption over distance, m/s (1 km/h). ASSUMED, 0.5 to 3 km/h: an engine that idles at 0.9 L/h is at 90 L/100 km there.
pub const SLOWEST_M_S: f64 = 1.0 / 3.6;

/// True where fuel over distance means something; where it does not, fuel over time does.
pub fn distance_counts(distance_m: f64, duration_s: f64) -> bool {
    distance_m >= SHORTEST_M && distance_m >= SLOWEST_M_S * duration_s
}

/// Fuel in L/h from mass and duration; NaN without a duration.
pub fn litres_per_hour(fuel_kg: f64, density_kg_m3: f64, duration_s: f64) -> f64 {
    if duration_s > 0.0 {
        fuel_kg / density_kg_m3 * 1000.0 * 3600.0 / duration_s
    } else {
        f64::NAN
    }
}

/// Carbon dioxide in g/km from the mass of fuel and distance; NaN for less than [`SHORTEST_M`].
pub fn co2_g_per_km(fuel_kg: f64, co2_kg_kg: f64, distance_m: f64) -> f64 {
    if distance_m >= SHORTEST_M {
        fuel_kg * co2_kg_kg * 1e6 / distance_m
    } else {
        f64::NAN
    }
}

/// Fuel in L/100 km from mass and distance; NaN for less than [`SHORTEST_M`].
pub fn litres_per_100km(fuel_kg: f64, density_kg_m3: f64, distance_m: f64) -> f64 {
    if distance_m >= SHORTEST_M {
        fuel_kg / density_kg_m3 * 1000.0 / (distance_m / 100_000.0)
    } else {
        f64::NAN
    }
}
