//! The car on the road or on the dynamometer: what the wheels must deliver.
//!
//! | label | statement | status |
//! |---|---|---|
//! | RL-1 | F = f0 + f1 v + f2 v2 + m_e a + m g sin(atan(grade)), m_e = m (1 + rotating) | source: UN R83; payload adds to m |
//! | RL-2 | road: f2 scales with air density, f0 with 1 + k (20 degC - T) | source: gas law; k 0.00864/K UN R83 coast-down correction |
//! | RL-3 | body form: f0 = m g c_r, f2 = rho/2 c_d A | source: mechanics |
//! | RL-4 | p/p_0 = (1 - 2.25577e-5 h)^5.25588 | source: ISO standard atmosphere |
//! | RL-9 | f = f_target - f_driveline for each of f0, f1, f2, where the target of a coast-down in neutral has the no-load drag of the box in it | derived; `new` takes the model's own drag (NC-18); check: CVT over manual of the same car in US lists, 23 pairs, +30 (sd 23) +16 (21) +11 (25) +16 (31) N at 20 50 80 110 km/h |
//! | RL-8 | f0, f1, f2 times a factor, the inertia as it is | source: US cold test (-6.7 degC, 10 % more road load) |
//! | RL-5 | work of a step: integral of F v dt, speed linear, split where F changes sign | derived: polynomial |
//!
//! On a dynamometer the coefficients are fixed, whatever the ambient; air resistance and rolling belong to the rollers. SI throughout.

mod keys;
mod tyre;

pub use keys::{ROAD_LOAD, RoadLoadKeys};
pub use tyre::Tyre;

use crate::cycle::{Step, mean_powers};
use crate::math::{Gather, Mask, Operand, Real, exp, larger, ln, physics};

/// Gravity, m/s2.
pub const GRAVITY_M_S2: f64 = 9.80665;
/// Ambient at which road-load coefficients hold, K (20 degC).
pub const REFERENCE_K: f64 = 293.15;
/// Ambient at which full-load lines hold, K (25 degC: SAE J1349, ISO 1585).
const CHARGE_REFERENCE_K: f64 = 298.15;

/// The checked road load, coefficients in force for one ambient.
#[derive(Clone, Copy, Debug, Gather, PartialEq)]
pub struct RoadLoad<R: Real = f64> {
    /// f0, N.
    pub f0_n: R,
    /// f1, N s/m.
    pub f1_n_per_m_s: R,
    /// f2, N s2/m2.
    pub f2_n_per_m_s2: R,
    /// Mass with payload, kg.
    pub mass_kg: R,
    /// Mass with rotating parts, kg.
    pub inertia_kg: R,
    /// Dynamic tyre radius, m.
    pub wheel_radius_m: R,
}

/// How the coefficients depend on ambient.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surface {
    /// Fixed coefficients.
    Dynamometer,
    /// Air density and rolling resistance follow ambient.
    Road,
}

/// Ambient air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ambient {
    /// Temperature, K.
    pub temp_k: f64,
    /// Altitude, m.
    pub altitude_m: f64,
}

impl Ambient {
    /// Pressure over sea level's (RL-4).
    pub fn pressure_ratio(&self) -> f64 {
        exp(5.25588 * ln(1.0 - 2.25577e-5 * self.altitude_m)) // RL-4
    }

    /// Air density over that at 20 degC and sea level.
    pub fn density_ratio(&self) -> f64 {
        self.pressure_ratio() * REFERENCE_K / self.temp_k
    }
}

/// Demand at the wheels in one step: means over the step, works over the step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WheelDemand<R: Real = f64> {
    /// Mean speed, m/s.
    pub speed_m_s: f64,
    /// Acceleration, m/s2.
    pub accel_m_s2: f64,
    /// Mean wheel speed, rad/s.
    pub wheel_rad_s: R,
    /// Mean power, W.
    pub power_w: R,
    /// Rise of the power from the beginning of the step to its end, W; 0 where it is not known.
    pub rise_w: R,
    /// Work in the drive parts, J.
    pub positive_j: R,
    /// Work in the braking parts, J, negative.
    pub negative_j: R,
}

/// Speeds at both ends of a step with a mean speed, m/s, and an acceleration, m/s2; never below 0.
fn end_speeds_m_s(mean_m_s: f64, accel_m_s2: f64, dt_s: f64) -> [f64; 2] {
    let half_m_s = 0.5 * accel_m_s2 * dt_s;
    [mean_m_s - half_m_s, mean_m_s + half_m_s].map(|v| larger(v, 0.0))
}

/// Two speeds over their mean; 1 at rest.
fn over_mean(speeds_m_s: [f64; 2], mean_m_s: f64) -> [f64; 2] {
    match mean_m_s > 0.0 {
        true => speeds_m_s.map(|speed| speed / mean_m_s),
        false => [1.0; 2],
    }
}

impl<R: Real> WheelDemand<R> {
    /// Speeds at the beginning and at the end of a step of `dt_s`, m/s.
    pub fn end_speeds_m_s(&self, dt_s: f64) -> [f64; 2] {
        end_speeds_m_s(self.speed_m_s, self.accel_m_s2, dt_s)
    }

    /// The same over the mean speed; 1 at rest.
    pub fn ends_over_mean(&self, dt_s: f64) -> [f64; 2] {
        over_mean(self.end_speeds_m_s(dt_s), self.speed_m_s)
    }
}

impl RoadLoad {
    /// Coefficients for an ambient (RL-2).
    pub fn for_ambient(mut self, surface: Surface, ambient: &Ambient, rolling_per_k: f64) -> Self {
        if surface == Surface::Road {
            self.f0_n *= 1.0 + rolling_per_k * (REFERENCE_K - ambient.temp_k);
            self.f2_n_per_m_s2 *= ambient.density_ratio();
        }
        self
    }
}

/// Length of the road over its length on the map.
fn along_the_road(grade: f64) -> f64 {
    (1.0 + grade * grade).sqrt()
}

#[physics]
impl<R: Real> RoadLoad<R> {
    /// Mean power, W, with a constant part of force `c` and the means of speed, its square and its cube.
    fn power_w(&self, c: R, [speed, square, cube]: [impl Operand<R>; 3]) -> R {
        let [speed, square, cube] = [speed.broadcast(c), square.broadcast(c), cube.broadcast(c)];
        c * speed + self.f1_n_per_m_s * square + self.f2_n_per_m_s2 * cube // RL-5
    }

    /// Speeds at which the force is zero, m/s, the lower first; NaN where there is none. Only a negative f1 has two.
    fn zero_force_speeds(&self, c: R) -> [R; 2] {
        let (f1, f2) = (self.f1_n_per_m_s, self.f2_n_per_m_s2);
        let (straight, falls) = (f2.le(0.0), f1.lt(0.0));
        let root = (f1 * f1 - 4.0 * f2 * c).sqrt();
        let lower = (falls & !straight).select(2.0 * c / (root - f1), c.splat(f64::NAN));
        let upper = falls.select((root - f1) / (2.0 * f2), -2.0 * c / (f1 + root));
        [lower, straight.select(-c / f1, upper)]
    }

    /// Computes the demand of a step at the wheels, with a force that is no part of the coefficients, N (RL-1, RL-5).
    pub fn wheel(&self, step: &Step, extra_n: R) -> WheelDemand<R> {
        let motion = &step.motion;
        if motion.rests() {
            let zero = extra_n.splat(0.0);
            return WheelDemand {
                speed_m_s: 0.0,
                accel_m_s2: 0.0,
                wheel_rad_s: zero,
                power_w: zero,
                rise_w: zero,
                positive_j: zero,
                negative_j: zero,
            };
        }
        let mut c = self.f0_n + extra_n + self.inertia_kg * motion.accel_m_s2;
        if step.grade.abs() > 0.0 {
            c = c + self.mass_kg * GRAVITY_M_S2 * step.grade / along_the_road(step.grade); // RL-1
        }
        let powers = [motion.speed_m_s, motion.square_m2_s2, motion.cube_m3_s3];
        let power_w = self.power_w(c, powers);
        let (positive_j, negative_j) = self.split_j(c, step, power_w * step.dt_s);
        WheelDemand {
            speed_m_s: motion.speed_m_s,
            accel_m_s2: motion.accel_m_s2,
            wheel_rad_s: motion.speed_m_s / self.wheel_radius_m,
            power_w,
            rise_w: self.rise_w(c, step),
            positive_j,
            negative_j,
        }
    }

    /// Rise of the power F v over a step with a constant part of force `c`, W.
    fn rise_w(&self, c: R, step: &Step) -> R {
        self.power_at_w(c, step.end_speed_m_s) - self.power_at_w(c, step.start_speed_m_s)
    }

    /// Power F v at a speed with a constant part of force `c`, W.
    fn power_at_w(&self, c: R, v: f64) -> R {
        c.splat(v) * (c + (self.f1_n_per_m_s + self.f2_n_per_m_s2 * v) * v)
    }

    /// Work in the drive parts and in the braking parts of a step, of its whole work, J (RL-5).
    fn split_j(&self, c: R, step: &Step, whole_j: R) -> (R, R) {
        let (v0, v1) = (step.start_speed_m_s, step.end_speed_m_s);
        let (mut drive_j, mut brake_j) = (c.splat(0.0), c.splat(0.0));
        let mut rest_j = whole_j;
        // With no part of the force negative there is nothing to split: most steps need no root.
        let splits = c.lt(0.0) | self.f1_n_per_m_s.lt(0.0);
        if splits.any() {
            let [lower, upper] = self.zero_force_speeds(c);
            let rising = v0 < v1;
            let (low, high) = if rising { (v0, v1) } else { (v1, v0) };
            let mut from = c.splat(v0);
            for zero in if rising {
                [lower, upper]
            } else {
                [upper, lower]
            } {
                let inside = splits & zero.gt(low) & zero.lt(high);
                if inside.any() {
                    let time_s = (zero - from) / step.motion.accel_m_s2;
                    let work_j = self.power_w(c, mean_powers(from, zero)) * time_s;
                    let drives = work_j.ge(0.0);
                    drive_j = (inside & drives).select(drive_j + work_j, drive_j);
                    brake_j = (inside & !drives).select(brake_j + work_j, brake_j);
                    rest_j = inside.select(rest_j - work_j, rest_j);
                    from = inside.select(zero, from);
                }
            }
        }
        let drives = rest_j.ge(0.0);
        (
            drives.select(drive_j + rest_j, drive_j),
            drives.select(brake_j, brake_j + rest_j),
        )
    }
}

/// Road load as the file has it, before an ambient is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoadLoadInput {
    /// Coefficients at 20 degC and sea level.
    pub base: RoadLoad,
    /// Dynamometer or road.
    pub surface: Surface,
    /// Rise of rolling resistance per kelvin below 20 degC.
    pub rolling_per_k: f64,
    /// Altitude, m.
    pub altitude_m: f64,
    /// Factor on the coefficients.
    pub load_factor: f64,
    /// The part of the mass that is payload, kg.
    pub payload_kg: f64,
    /// Tyres.
    pub tyre: Tyre,
}

impl RoadLoadInput {
    /// Coefficients in force at an ambient temperature, K.
    pub fn at(&self, ambient_k: f64) -> RoadLoad {
        let ambient = Ambient {
            temp_k: ambient_k,
            altitude_m: self.altitude_m,
        };
        // Tyres that warm up have the ambient in their own temperature.
        let rolling_per_k = if self.tyre.warm_n > 0.0 {
            0.0
        } else {
            self.rolling_per_k
        };
        let load = self.base.for_ambient(self.surface, &ambient, rolling_per_k);
        RoadLoad {
            f0_n: load.f0_n * self.load_factor,
            f1_n_per_m_s: load.f1_n_per_m_s * self.load_factor,
            f2_n_per_m_s2: load.f2_n_per_m_s2 * self.load_factor,
            ..load
        } // RL-8
    }

    /// Charge of a naturally aspirated engine over that at 25 degC and sea level (EN-5). The root: cold air is warmed on its way in.
    pub fn charge(&self, ambient_k: f64) -> f64 {
        let ambient = Ambient {
            temp_k: ambient_k,
            altitude_m: self.altitude_m,
        };
        ambient.pressure_ratio() * (CHARGE_REFERENCE_K / ambient_k).sqrt() // EN-5
    }
}
