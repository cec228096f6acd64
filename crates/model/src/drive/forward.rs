//! A CVT that is driven by a torque: the step of a drive, with the torque at the flywheel known and the power at the wheels sought.
//!
//! | label | statement | status |
//! |---|---|---|
//! | FO-1 | T = T_f(P) + J (w_1(P)2 - w_0 2)/(2 w(P) dt), w_0 and w_1 at the ends of the step, P the power at the wheels at which T is the torque that is given; T_f, w, losses, pressure by the step of the box at P (CV-1 to CV-6, LC-1 or TC-1) | derived: one power balance, solved for its other end |
//! | FO-2 | a T that no P has: the nearest that one has | derived: between least torque (CV-3) and full load (CV-4) at the ends of P; idle speed is held (LC-1) |
//! | FO-3 | wheels that turn slower than 0.02 rad/s count as turning so fast | ASSUMED: 6 mm/s; the box at rest passes on creep torque alone, whatever the engine gives (LC-2) |
//!
//! Nothing here is a second model: a torque that a drive has found at some power gives that power again. The clutch is the one of the
//! drive: it is pressed so that its engine has the speed of LC-1 for the torque that it carries, within what its inertia allows. Engine, flywheel and primary are
//! one inertia, as there. The engine of the file is behind idle speed, drag, full load and the throttle that the clamp law sees.

use super::step::advance;
use super::{Car, State, loss_heat_w};
use crate::math::{larger, smaller};
use crate::road::WheelDemand;
use crate::thermal::{COOLANT, ENGINE_OIL, SUMP, speed_power};
use crate::transmission::cvt::Hold;
use crate::transmission::{StepInput, StepOutput, TransmissionState};

/// Slowest wheels, rad/s (FO-3).
pub const MIN_WHEEL_RAD_S: f64 = 0.02;
/// Torque up to which a step is solved, Nm. ASSUMED, numerical: a millionth of what is measured on a rig; less is rounding of the box's own solve.
const NEAR_NM: f64 = 1e-7;
/// Tries for a power; a step that needs them all takes the nearest.
const MAX_TRIES: usize = 100;
/// Power at the wheels beyond what any box passes on, over the rated power. ASSUMED, numerical: an engine gives its rated power at most and its drag takes
/// less, so that any number well above 1 leaves both ends where they are.
const BEYOND: f64 = 4.0;
/// How far beyond an end of the power a demand begins to come near it, over the rated power, ... ASSUMED, numerical: near enough that the clamp law
/// gives the pressure of the end; a fifth of it with each try.
const MARGIN: f64 = 0.05;
/// ... and how near, W. ASSUMED, numerical: some millionth of a rated power.
const NEAR_W: f64 = 0.1;

/// Input of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Given {
    /// Torque at the flywheel, that of inertia included, Nm.
    pub engine_nm: f64,
    /// Speed of the wheels at its beginning and end, rad/s.
    pub wheel_rad_s: [f64; 2],
    /// Belt ratio that is asked for (RC-15).
    pub ratio: f64,
    /// Transmission oil in the sump, K.
    pub sump_k: f64,
    /// Coolant and engine oil, K.
    pub engine_k: [f64; 2],
    /// Length, s.
    pub dt_s: f64,
}

/// Result of a step.
#[derive(Clone, Copy, Debug)]
pub struct Turned {
    /// The driveline.
    pub output: StepOutput,
    /// Torque taken at the flywheel, that of inertia included, Nm: the one given, or the nearest (FO-2).
    pub taken_nm: f64,
    /// Power into rotating energy of engine and primary, W.
    pub kinetic_w: f64,
    /// Mean speed of the wheels, rad/s.
    pub wheel_rad_s: f64,
}

impl Turned {
    /// Torque at the wheels, Nm.
    pub fn wheel_nm(&self) -> f64 {
        self.output.output_w / self.wheel_rad_s
    }
}

/// A CVT on its way, driven by a torque.
#[derive(Clone, Debug)]
pub struct Forward<'a> {
    car: &'a Car,
    state: State,
}

/// A power at the wheels that was tried.
#[derive(Clone, Copy)]
struct Tried {
    turned: Turned,
    after: TransmissionState,
    power_w: f64,
}

impl Tried {
    /// How much more torque it takes than is given, Nm.
    fn over_nm(&self, given: &Given) -> f64 {
        self.turned.taken_nm - given.engine_nm
    }
}

impl<'a> Forward<'a> {
    /// A car in a state; none with a manual box.
    pub fn new(car: &'a Car, state: State) -> Option<Self> {
        car.transmission.is_cvt().then_some(Forward { car, state })
    }

    /// The state after the last step.
    pub fn state(&self) -> State {
        self.state
    }

    /// One step.
    pub fn step(&mut self, given: &Given) -> Turned {
        let node_k = &mut self.state.heat.node_k;
        node_k[SUMP] = given.sump_k;
        [node_k[COOLANT], node_k[ENGINE_OIL]] = given.engine_k;
        self.state.running = self.state.running.started(given.engine_k[0]);
        let found = self.solve(given);
        let Turned {
            output, kinetic_w, ..
        } = found.turned;
        let wheel = self.demand(given, found.power_w);
        let running = self.state.running;
        let power_w = loss_heat_w(self.car, &output.loss_w);
        self.with_input(given, &wheel, |car, heat, input| {
            *heat = advance(car, power_w, &output, input, speed_power(wheel.speed_m_s)).heat;
        });
        self.state.transmission = Some(found.after);
        self.state.kinetic_j += kinetic_w * given.dt_s;
        self.state.running = running.after(false, given.dt_s, output.end_rad_s);
        found.turned
    }

    /// The power at which the torque is the one given (FO-1), or the nearest (FO-2).
    fn solve(&mut self, given: &Given) -> Tried {
        let [mut low, mut high] = [-1.0, 1.0].map(|side| self.end(given, side));
        let (mut low_nm, mut high_nm) = (low.over_nm(given), high.over_nm(given));
        if low_nm >= 0.0 {
            return low;
        }
        if high_nm <= 0.0 {
            return high;
        }
        let mut best = if -low_nm < high_nm { low } else { high };
        let mut below_before = None;
        for _ in 0..MAX_TRIES {
            // Regula falsi; the torque of an end that stays again is halved.
            let share = low_nm / (low_nm - high_nm);
            let power_w = low.power_w + share * (high.power_w - low.power_w);
            let inside = low.power_w < power_w && power_w < high.power_w;
            if !inside {
                break;
            }
            let tried = self.at(given, power_w);
            let over_nm = tried.over_nm(given);
            if over_nm.abs() < best.over_nm(given).abs() {
                best = tried;
            }
            if over_nm.abs() <= NEAR_NM {
                break;
            }
            let below = over_nm < 0.0;
            let again = if below_before == Some(below) {
                0.5
            } else {
                1.0
            };
            if below {
                (low, low_nm, high_nm) = (tried, over_nm, again * high_nm);
            } else {
                (high, high_nm, low_nm) = (tried, over_nm, again * low_nm);
            }
            below_before = Some(below);
        }
        best
    }

    /// The last power on a side at which torque still follows the demand: there the engine is the limit (FO-2). What is demanded beyond it changes
    /// no torque but the friction of the final drive's teeth (GM-2), so the demand comes near.
    fn end(&mut self, given: &Given, side: f64) -> Tried {
        let rated_w = self.car.engine.rated_w;
        let mut end = self.at(given, side * BEYOND * rated_w);
        let mut margin_w = MARGIN * rated_w;
        while margin_w > NEAR_W {
            let tried = self.at(given, end.turned.output.output_w + side * margin_w);
            let output = &tried.turned.output;
            if output.brake_w + output.deficit_w > 0.0 {
                end = tried;
            }
            margin_w *= 0.2;
        }
        end
    }

    /// The step of the box at a power at the wheels.
    fn at(&mut self, given: &Given, power_w: f64) -> Tried {
        let wheel = self.demand(given, power_w);
        let hold = Hold {
            ratio: given.ratio,
            clamp: None,
            end: None,
            paced: true,
        };
        let (before, inertia) = (self.state.transmission, self.car.engine.inertia_kg_m2);
        let kinetic_j = self.state.kinetic_j;
        let (after, output, begun_j) = self.with_input(given, &wheel, |car, _, input| {
            let mut after = before.unwrap_or_else(|| car.transmission.start(input));
            if let Some(own) = &mut after.cvt {
                own.hold = Some(hold);
            }
            let idling = after.driveline.engine_rad_s;
            let begun_j = match kinetic_j.is_nan() {
                true => 0.5 * inertia * idling * idling,
                false => kinetic_j,
            };
            let output = car.transmission.solve(input, &mut after);
            (after, output, begun_j)
        });
        self.state.kinetic_j = begun_j;
        let (w, end) = (output.engine_rad_s, output.end_rad_s);
        let kinetic_w = (0.5 * inertia * end * end - begun_j) / given.dt_s;
        let taken_nm = output.shaft_nm + kinetic_w / w; // FO-1
        Tried {
            turned: Turned {
                output,
                taken_nm,
                kinetic_w,
                wheel_rad_s: wheel.wheel_rad_s,
            },
            after,
            power_w,
        }
    }

    /// The demand of wheels that turn as they do.
    fn demand(&self, given: &Given, power_w: f64) -> WheelDemand {
        let [from, to] = given.wheel_rad_s;
        let wheel_rad_s = larger(0.5 * (from + to), MIN_WHEEL_RAD_S); // FO-3
        let radius_m = self.car.road_load.wheel_radius_m;
        WheelDemand {
            speed_m_s: wheel_rad_s * radius_m,
            accel_m_s2: (to - from) / given.dt_s * radius_m,
            wheel_rad_s,
            power_w,
            rise_w: 0.0,
            positive_j: larger(power_w, 0.0) * given.dt_s,
            negative_j: smaller(power_w, 0.0) * given.dt_s,
        }
    }

    /// Hands on what the driveline receives in a step, and the heat before it.
    fn with_input<R>(
        &mut self,
        given: &Given,
        wheel: &WheelDemand,
        f: impl FnOnce(&Car, &mut crate::thermal::Heat, &super::row::Input) -> R,
    ) -> R {
        let (car, running) = (self.car, &self.state.running);
        let [coolant_k, oil_k] = given.engine_k;
        let engine = car.engine.in_step(
            coolant_k,
            oil_k,
            &car.engine_oil,
            car.charge,
            running,
            given.dt_s,
        );
        let before = self.state.heat;
        let input = StepInput {
            wheel,
            engine: &engine,
            oil: &car.oil,
            heat: &before,
            gear: None,
            dt_s: given.dt_s,
            engine_off: false,
            neutral_share: 0.0,
            kinetic_j: self.state.kinetic_j,
        };
        f(car, &mut self.state.heat, &input)
    }
}
