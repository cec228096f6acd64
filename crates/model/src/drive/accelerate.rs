//! A car at full throttle: the speed that each step ends with is sought, everything else is the step of a drive.
//!
//! | label | statement | status |
//! |---|---|---|
//! | AC-1 | v_1 of a step: the largest for which the engine gives the demand at the wheels and what its own inertia takes, 0 = deficit = J w2/2 - E_k after SI-1 and SI-2, and turns no faster than its highest speed | derived: power balance of the step, solved for its other end |
//! | AC-2 | CVT: belt ratio towards w_P/w_sec, w_P of RC-8, within RC-4 and RC-5; low until the clutch has locked (RC-6) | derived: the box's own control at full pedal |
//! | AC-3 | F_x = P_w/v <= mu N, N = m (g (share cos a -+ h/L sin a) -+ h/L dv/dt), - for a driven front axle, + for a rear one; m g cos a for both; lift and aerodynamic moment left out | derived: moments about the other axle's contact; mu, share and h/L ASSUMED: 0.7 to 1.1, 0.55 to 0.65, 0.18 to 0.25 |
//! | AC-4 | manual: gear k to k+1 where full load gives more torque at the wheels there, at the highest speed at the latest; t_s with an open clutch between | derived; t_s ASSUMED, 0.2 to 1.0 s |
//! | AC-5 | a time is that at which the speed, linear within the step, passes the end of its span; error of the step: difference to half the step | derived |
//! | AC-6 | begin at rest: engine at idle, box in gear, brakes off and pedal down at t = 0; begin at speed: after driving it steadily for 20 s, a manual in the lowest gear below the speed of AC-4 | ASSUMED |
//!
//! Heat, losses, couplings, clamp and engine are those of any other drive (SI-1 to SI-4). Throttle and intake have no dynamics, a turbocharger has no lag, and a launch control or a driver
//! who lets the engine speed up before the start is not modelled: times are those of a driver who pushes the pedal down at idle. Tyres slip by nothing up to the limit.

use super::{Car, Drive, Row, State};
use crate::cycle::{GearCommand, Motion, Step, is_standstill};
use crate::engine::Running;
use crate::flags::Flags;
use crate::math::{Curve, larger, smaller};
use crate::road::GRAVITY_M_S2;
use crate::thermal::Heat;
use crate::transmission::Transmission;
use crate::transmission::cvt::Hold;

/// The driven wheels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Driven {
    /// Front axle.
    Front,
    /// Rear axle.
    Rear,
    /// Both, shared as their load is.
    All,
}

/// Grip of the driven wheels (AC-3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grip {
    /// Coefficient of friction between tyre and road.
    pub mu: f64,
    /// The driven wheels.
    pub driven: Driven,
    /// Share of the weight on the driven axle at rest on a level road.
    pub axle_share: f64,
    /// Height of the centre of mass over the wheelbase.
    pub height_over_base: f64,
}

impl Default for Grip {
    fn default() -> Self {
        Grip {
            mu: 0.9,
            driven: Driven::Front,
            axle_share: 0.6,
            height_over_base: 0.21,
        }
    }
}

impl Grip {
    /// Largest force at the driven wheels, N, of a car of a mass at an acceleration on a slope, rise over run.
    pub fn limit_n(&self, mass_kg: f64, accel_m_s2: f64, grade: f64) -> f64 {
        let along = (1.0 + grade * grade).sqrt();
        let (cos, sin) = (1.0 / along, grade / along);
        let transfer = self.height_over_base * (accel_m_s2 + GRAVITY_M_S2 * sin);
        let own = self.axle_share * GRAVITY_M_S2 * cos;
        let load = match self.driven {
            Driven::Front => own - transfer,
            Driven::Rear => own + transfer,
            Driven::All => GRAVITY_M_S2 * cos,
        };
        self.mu * mass_kg * larger(load, 0.0) // AC-3
    }
}

/// Question of a full-throttle drive.
#[derive(Clone, Debug, PartialEq)]
pub struct FullThrottle {
    /// Speed at the begin, m/s; a standing start below [`STANDSTILL_M_S`](crate::cycle::STANDSTILL_M_S).
    pub from_m_s: f64,
    /// Speed at which it ends, m/s.
    pub to_m_s: f64,
    /// Distance at which it ends at the latest, if it has one, m; it goes on until both are reached.
    pub distance_m: f64,
    /// Slope of the road, rise over run.
    pub grade: f64,
    /// Grip; none without a limit.
    pub grip: Option<Grip>,
    /// Time of a change of gear, s (AC-4).
    pub shift_s: f64,
    /// Gear of a manual box that is kept, from 1.
    pub gear: Option<u8>,
    /// Temperatures at the begin, and of the tyres, K.
    pub heat: (Heat, f64),
    /// Step, s.
    pub dt_s: f64,
}

/// A step of a full-throttle drive.
#[derive(Clone, Copy, Debug)]
pub struct Instant {
    /// Time at its end, s.
    pub time_s: f64,
    /// Speed at its end, m/s.
    pub speed_m_s: f64,
    /// Distance at its end, m.
    pub distance_m: f64,
    /// True where the grip is the limit.
    pub grip_limited: bool,
    /// Everything else about the step.
    pub row: Row,
}

/// A full-throttle drive.
#[derive(Clone, Debug)]
pub struct Accelerated {
    /// Speed at the begin, m/s.
    pub from_m_s: f64,
    /// The steps.
    pub steps: Vec<Instant>,
    /// Times at which a manual box begins to change, s, with the new gear.
    pub shifts: Vec<(f64, u8)>,
    /// True if speed and distance were reached.
    pub reached: bool,
}

/// Longest drive, s. ASSUMED, numerical: ten times what a slow car takes to 100 km/h.
const LONGEST_S: f64 = 200.0;
/// Change of speed in a second below which a car is at its top speed, m/s. ASSUMED, numerical.
const STEADY_M_S: f64 = 0.02;
/// Relative change of engine speed in a second below which it is there. ASSUMED, numerical.
const STEADY_SHARE: f64 = 0.01;
/// Steady driving before a begin at speed, s (AC-6).
const BEFORE_S: f64 = 20.0;
/// Bounds of the acceleration, m/s2: no road car is outside.
const ACCEL_M_S2: [f64; 2] = [-6.0, 15.0];
/// Halvings of these bounds: to 1e-11 of them.
const HALVINGS: usize = 36;
/// Share of the rotating energy that may be missing: rounding (AC-1).
const ROUNDING: f64 = 1e-9;

impl Accelerated {
    /// Time at which a speed is reached, s; none if it is not (AC-5).
    pub fn time_to_speed_s(&self, speed_m_s: f64) -> Option<f64> {
        if speed_m_s <= self.from_m_s {
            return Some(0.0);
        }
        let mut before = (0.0, self.from_m_s);
        for step in &self.steps {
            if step.speed_m_s >= speed_m_s {
                let share = (speed_m_s - before.1) / (step.speed_m_s - before.1);
                return Some(before.0 + share * (step.time_s - before.0)); // AC-5
            }
            before = (step.time_s, step.speed_m_s);
        }
        None
    }

    /// Time at which a distance is reached, s, and the speed there, m/s; none if it is not.
    pub fn at_distance(&self, distance_m: f64) -> Option<(f64, f64)> {
        let (mut time_s, mut speed_m_s, mut at_m) = (0.0, self.from_m_s, 0.0);
        for step in &self.steps {
            if step.distance_m >= distance_m {
                // Speed is linear in the step: v t + a t2/2 = rest.
                let (rest_m, dt_s) = (distance_m - at_m, step.time_s - time_s);
                let accel = (step.speed_m_s - speed_m_s) / dt_s;
                let root = larger(speed_m_s * speed_m_s + 2.0 * accel * rest_m, 0.0).sqrt();
                let t = 2.0 * rest_m / larger(speed_m_s + root, f64::MIN_POSITIVE);
                return Some((time_s + t, speed_m_s + accel * t));
            }
            (time_s, speed_m_s, at_m) = (step.time_s, step.speed_m_s, step.distance_m);
        }
        None
    }

    /// Time with the grip as the limit, s.
    pub fn grip_limited_s(&self) -> f64 {
        let limited = self.steps.iter().filter(|step| step.grip_limited);
        limited.map(|step| step.row.dt_s).sum()
    }

    /// Highest speed, m/s.
    pub fn highest_m_s(&self) -> f64 {
        let speeds = self.steps.iter().map(|step| step.speed_m_s);
        speeds.fold(self.from_m_s, |a, b| larger(b, a))
    }

    /// True if a flag stood in a step.
    pub fn has(&self, flag: Flags) -> bool {
        self.steps.iter().any(|step| step.row.flags.contains(flag))
    }
}

/// Drives a car at full throttle.
///
/// ```
/// use cvtcycle_config::setup::{Options, load};
/// use cvtcycle_model::drive::{FullThrottle, Grip, accelerate};
/// use cvtcycle_model::thermal::Heat;
///
/// let car = load("rover_216_cvt", &Options::default()).expect("a shipped car").car(298.15);
/// let asked = FullThrottle {
///     from_m_s: 0.0,
///     to_m_s: 100.0 / 3.6,
///     distance_m: 0.0,
///     grade: 0.0,
///     grip: Some(Grip::default()),
///     shift_s: 0.5,
///     gear: None,
///     heat: (Heat::uniform(358.15), 298.15),
///     dt_s: 0.1,
/// };
/// let time_s = accelerate(&car, &asked).time_to_speed_s(100.0 / 3.6).expect("it gets there");
/// assert!((7.0..16.0).contains(&time_s), "{time_s} s");
/// ```
pub fn accelerate(car: &Car, asked: &FullThrottle) -> Accelerated {
    let mut car = car.clone();
    car.engine.start_stop = None; // the engine runs
    let asked = &FullThrottle {
        from_m_s: match is_standstill(asked.from_m_s) {
            true => 0.0,
            false => asked.from_m_s,
        },
        ..asked.clone()
    };
    let mut pedal = Pedal::new(&car, asked);
    let mut found = Accelerated {
        from_m_s: asked.from_m_s,
        steps: Vec::new(),
        shifts: Vec::new(),
        reached: false,
    };
    let (mut speed_m_s, mut distance_m, mut number) = (asked.from_m_s, 0.0, 0_u32);
    let mut engine_rad_s = pedal.engine_rad_s();
    let mut second = (0.0, speed_m_s, engine_rad_s);
    loop {
        let time_s = f64::from(number) * asked.dt_s;
        if speed_m_s >= asked.to_m_s && distance_m >= asked.distance_m {
            found.reached = true;
            break;
        }
        if time_s >= LONGEST_S {
            break;
        }
        // At the top speed only the distance is waited for.
        if time_s >= second.0 + 1.0 {
            // A box that goes to a lower ratio gives the engine what the wheels lack.
            let revs = (engine_rad_s / second.2 - 1.0).abs() < STEADY_SHARE;
            let steady = speed_m_s - second.1 < STEADY_M_S && revs && !pedal.is_shifting(time_s);
            if steady && speed_m_s < asked.to_m_s && distance_m >= asked.distance_m {
                break;
            }
            second = (time_s, speed_m_s, engine_rad_s);
        }
        found.shifts.extend(pedal.change(time_s, speed_m_s));
        number += 1;
        let (row, grip_limited) = pedal.step(time_s, speed_m_s);
        let end_m_s = larger(2.0 * row.speed_m_s - speed_m_s, 0.0);
        distance_m += row.distance_m;
        speed_m_s = end_m_s;
        engine_rad_s = row.engine_end_rad_s;
        found.steps.push(Instant {
            time_s: f64::from(number) * asked.dt_s,
            speed_m_s,
            distance_m,
            grip_limited,
            row,
        });
    }
    found
}

/// A car with its pedal down.
struct Pedal<'a> {
    car: &'a Car,
    asked: &'a FullThrottle,
    state: State,
    /// Gear of a manual box, and the time until which the clutch is open for it.
    gear: u8,
    open_until_s: f64,
    /// Road speeds of the changes up, m/s (AC-4).
    up_m_s: Vec<f64>,
}

impl<'a> Pedal<'a> {
    fn new(car: &'a Car, asked: &'a FullThrottle) -> Self {
        let (heat, tyre_k) = asked.heat;
        let state = State {
            heat,
            tyre_k,
            running: Running::LONG,
            ..State::at(car.ambient_k)
        };
        let up_m_s = up_speeds_m_s(car);
        let lowest = up_m_s.iter().take_while(|up| **up <= asked.from_m_s);
        let gear = asked.gear.unwrap_or(1 + lowest.count() as u8);
        let mut pedal = Pedal {
            car,
            asked,
            state,
            gear,
            open_until_s: f64::NEG_INFINITY,
            up_m_s,
        };
        pedal.begin();
        pedal
    }

    /// A second at rest in gear, or the steady drive before a begin at speed (AC-6). Temperatures stay those that were asked for.
    fn begin(&mut self) {
        let (speed_m_s, heat) = (self.asked.from_m_s, (self.state.heat, self.state.tyre_k));
        let rests = speed_m_s <= 0.0;
        let command = match rests {
            true => GearCommand::Neutral,
            false => GearCommand::InGear(self.gear),
        };
        for second in 0..if rests { 1 } else { BEFORE_S as usize } {
            let mut step = self.step_to((second as f64, 1.0), speed_m_s, speed_m_s);
            step.grade = 0.0;
            let gears = [command];
            let mut drive = self.drive(&gears, self.state);
            drive.step(&step); // AC-6
            self.state = drive.state();
            (self.state.heat, self.state.tyre_k) = heat;
        }
        if let Some(own) = self.state.transmission.as_mut().filter(|_| rests) {
            own.driveline.gear = self.gear;
        }
    }

    /// A change of gear that begins now, with the time at which it does (AC-4).
    fn change(&mut self, time_s: f64, speed_m_s: f64) -> Option<(f64, u8)> {
        if self.asked.gear.is_some() || self.is_shifting(time_s) {
            return None;
        }
        let up_m_s = *self.up_m_s.get(usize::from(self.gear) - 1)?;
        (speed_m_s >= up_m_s).then(|| {
            self.gear += 1;
            self.open_until_s = time_s + self.asked.shift_s; // AC-4
            (time_s, self.gear)
        })
    }

    /// Engine speed after the begin, rad/s.
    fn engine_rad_s(&self) -> f64 {
        let own = self.state.transmission.as_ref();
        own.map_or(f64::NAN, |own| own.driveline.engine_rad_s)
    }

    fn is_shifting(&self, time_s: f64) -> bool {
        time_s < self.open_until_s - 1e-9
    }

    fn drive<'b>(&'b self, gears: &'b [GearCommand], state: State) -> Drive<'b> {
        let own = matches!(self.car.transmission, Transmission::Manual(_));
        Drive::in_gears(self.car, own.then_some(gears), state)
    }

    fn step_to(&self, (time_s, dt_s): (f64, f64), from_m_s: f64, to_m_s: f64) -> Step {
        Step {
            time_s: time_s + dt_s,
            dt_s,
            start_speed_m_s: from_m_s,
            end_speed_m_s: to_m_s,
            motion: Motion::between(from_m_s, to_m_s, dt_s),
            phase: 0,
            grade: self.asked.grade,
            engine_off: false,
            interval: 0,
        }
    }

    /// One step to the largest speed that it can end with (AC-1), and whether the grip is what limits it.
    fn step(&mut self, time_s: f64, from_m_s: f64) -> (Row, bool) {
        let dt_s = self.asked.dt_s;
        let [least, most] = ACCEL_M_S2.map(|accel| larger(from_m_s + accel * dt_s, 0.0));
        let opens = self.is_shifting(time_s);
        let gears = [match opens {
            true => GearCommand::Declutched(self.gear),
            false => GearCommand::InGear(self.gear),
        }];
        let tried = |to_m_s: f64| {
            self.tried(
                &gears,
                opens,
                self.step_to((time_s, dt_s), from_m_s, to_m_s),
            )
        };
        let (mut low, mut high) = (least, most);
        let mut best = tried(least);
        let mut grip_limited = false;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            let now = tried(middle);
            match now.limit {
                None => (low, best) = (middle, now),
                Some(limit) => {
                    high = middle;
                    grip_limited = limit == Limit::Grip;
                }
            }
        }
        self.state = best.state;
        (best.row, grip_limited)
    }

    /// A step to some speed, and what forbids it.
    fn tried(&self, gears: &[GearCommand], opens: bool, step: Step) -> Tried {
        let mut drive = self.drive(gears, self.state);
        let (row, _) = match self.ratio(&step) {
            Some(ratio) => drive.step_held(
                &step,
                &Hold {
                    ratio,
                    clamp: None,
                    end: None,
                    paced: true,
                },
            ),
            None => drive.step(&step),
        };
        let state = drive.state();
        let w = row.engine_speed_rad_s;
        let end = row.engine_end_rad_s;
        let wanted_j = 0.5 * self.car.engine.inertia_kg_m2 * end * end;
        let slow = state.kinetic_j < wanted_j * (1.0 - ROUNDING) && !opens;
        let rises = step.end_speed_m_s > step.start_speed_m_s;
        let fast = rises && w > self.car.engine.highest_rad_s;
        // A manual box takes a lower gear where the one in force lacks torque, and one where the clutch is open (MB-5): not here.
        let manual = matches!(self.car.transmission, Transmission::Manual(_));
        let moves = !step.motion.rests();
        let closes = opens && !row.flags.contains(Flags::CLUTCH_OPEN);
        let other_gear = manual && moves && (closes || row.gear != self.gear);
        let short = row.deficit_w > ROUNDING * self.car.engine.rated_w || other_gear;
        let limit = if self.slides(&row, &step) {
            Some(Limit::Grip)
        } else {
            (slow || fast || short).then_some(Limit::Engine) // AC-1
        };
        Tried { row, state, limit }
    }

    /// True where the force at the driven wheels is beyond their grip (AC-3).
    fn slides(&self, row: &Row, step: &Step) -> bool {
        let Some(grip) = &self.asked.grip else {
            return false;
        };
        let motion = &step.motion;
        let limit_n = grip.limit_n(self.car.road_load.mass_kg, motion.accel_m_s2, step.grade);
        row.wheel_power_w > limit_n * motion.speed_m_s
    }

    /// Belt ratio that a step demands (AC-2); none for a manual box.
    fn ratio(&self, step: &Step) -> Option<f64> {
        let Transmission::Cvt(cvt) = &self.car.transmission else {
            return None;
        };
        let own = self.state.transmission.as_ref()?;
        let control = &cvt.ratio;
        if !own.driveline.coupled && !self.car.transmission.coupling().by_command() {
            return Some(control.low); // RC-6
        }
        let wheel_rad_s = step.motion.speed_m_s / self.car.road_load.wheel_radius_m;
        let range = own.cvt.map_or(1.0, |cvt| cvt.shifting.range.ratio);
        let behind_rad_s = cvt.final_drive.ratio * wheel_rad_s;
        let secondary_rad_s = larger(range * behind_rad_s, f64::MIN_POSITIVE);
        let wanted = control.highest_rad_s / secondary_rad_s; // AC-2
        Some(larger(smaller(wanted, control.low), control.high))
    }
}

/// Limit that forbids a speed.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Limit {
    Engine,
    Grip,
}

/// A step that was tried.
struct Tried {
    row: Row,
    state: State,
    limit: Option<Limit>,
}

/// Road speeds at which a manual box changes up at full load, m/s (AC-4).
fn up_speeds_m_s(car: &Car) -> Vec<f64> {
    let Transmission::Manual(manual) = &car.transmission else {
        return Vec::new();
    };
    let engine = &car.engine;
    let radius_m = car.road_load.wheel_radius_m;
    let change = |pair: &[f64]| {
        let [here, above] = [pair[0], pair[1]];
        change_rad_s(&engine.full_load, engine.highest_rad_s, above / here) / here * radius_m
    };
    manual.overall.windows(2).map(change).collect()
}

/// Engine speed from which a gear with a ratio less by a factor has more torque at the wheels, rad/s; the highest where it has not.
fn change_rad_s(full_load: &Curve, highest_rad_s: f64, factor: f64) -> f64 {
    const PARTS: u32 = 1000;
    let more = |part: &u32| {
        let w = highest_rad_s * f64::from(*part) / f64::from(PARTS);
        factor * full_load.at(factor * w) >= full_load.at(w)
    };
    let later = (1..=PARTS).rev().take_while(more).last();
    later.map_or(highest_rad_s, |part| {
        highest_rad_s * f64::from(part) / f64::from(PARTS)
    })
}
