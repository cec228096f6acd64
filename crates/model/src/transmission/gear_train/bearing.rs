//! Friction of the rolling bearings of a gear train.
//!
//! | label | statement | status |
//! |---|---|---|
//! | BR-1 | without load M_0 = c f_0 1e-7 max(nu n, 2000)^(2/3) d_m^3 Nmm, by FH-1; c = 1 without preload; nu mm2/s, n rpm, d_m mm | source: Palmgren, from memory; f_0 ASSUMED, 1 to 8; c fitted to thesis 5.5.1 and the class loss of manual boxes, one for all boxes |
//! | BR-2 | preload M_pre = M (0.04 + 0.08 psi)/0.12, psi = exp(-2.6e-8 (nu n)^1.4 d_m) | source: SKF's weighting of mixed and full film friction, in an open program of TU Munich; M ASSUMED, fitted with c |
//! | BR-3 | lost share of the power through a stage: 1.1 mu_b (d_b1/d_1 + d_b2/(u d_1)) | derived: bearings carry 1.1 times the force of the teeth; mu_b ASSUMED, 0.0008 to 0.0020 |
//!
//! d_m mean and d_b bore diameter of the bearings of a shaft, d_1 pitch diameter of the pinion, u ratio of wheel to pinion. With BR-2 a
//! preloaded bearing loses less torque the faster it turns and the thicker its oil is, down to a third: its rollers lift off. Its power
//! still rises with speed.

use crate::math::{Gather, Real, ln, physics};
use crate::transmission::viscous_self_heating::ViscousSelfHeating;

/// Ends of the mixed friction of a bearing over its boundary friction (BR-2).
const FULL_FILM: f64 = 0.04 / 0.12;
const BOUNDARY: f64 = 0.08 / 0.12;
/// Logarithm of the nu n below which M_0 falls no more, 2000 mm2/s rpm.
const MIN_LOG_NU_N: f64 = 7.600_902_459_542_082;
/// Exponent of nu n in M_0 (BR-1).
const TWO_THIRDS: f64 = 2.0 / 3.0;
/// Load of a shaft's bearings over the tangential force of its wheel.
const LOAD_OF_TEETH: f64 = 1.1;

/// The bearings of one kind on a shaft.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bearing {
    /// Shaft on which they are, from 0.
    pub shaft: usize,
    /// How many.
    pub count: f64,
    /// Mean diameter, m.
    pub mean_m: f64,
    /// Bore, m.
    pub bore_m: f64,
    /// f_0 of BR-1.
    pub f0: f64,
    /// Friction of all of them by their preload, in boundary friction, Nm.
    pub preload_nm: f64,
}

/// Data shared by all bearings of a train.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BearingFactors {
    /// Friction under load (BR-3).
    pub friction: f64,
    /// Factor on M_0 of bearings with preload (BR-1).
    pub unloaded: f64,
    /// Factor on the preload (BR-2).
    pub preload: f64,
    /// Dissipation of one bearing that halves M_0, W (FH-1).
    pub heating_w: f64,
}

impl Bearing {
    /// Torque at its own shaft without load from the teeth, Nm, at a speed of that shaft and with the logarithm of nu n in mm2/s rpm
    /// (BR-1, BR-2).
    pub fn torque_nm(&self, factors: &BearingFactors, shaft_rad_s: f64, log_nu_n: f64) -> f64 {
        let alone = self.in_train(factors, 1.0);
        alone.torque_nm(shaft_rad_s, film_powers(log_nu_n))
    }

    /// The bearings on a shaft that turns so many times as fast as shaft 0 of a train.
    pub fn in_train(&self, factors: &BearingFactors, turns: f64) -> TrainBearing {
        let mean_mm = 1e3 * self.mean_m;
        let cube_mm3 = mean_mm * mean_mm * mean_mm;
        // The factor holds the rolling friction that preload adds.
        let rolling = if self.preload_nm > 0.0 {
            factors.unloaded
        } else {
            1.0
        };
        let per_power_nm = rolling * self.count * self.f0 * 1e-10 * cube_mm3; // BR-1
        let [turns_23, turns_14] = film_powers(ln(turns));
        TrainBearing {
            turns,
            unheated_nm: per_power_nm * turns_23,
            least_nm: per_power_nm * film_powers(MIN_LOG_NU_N)[0],
            heating: ViscousSelfHeating::halving_at_w(Some(self.count * factors.heating_w)),
            preload_nm: factors.preload * self.preload_nm,
            film: -2.6e-8 * mean_mm * turns_14, // BR-2
        }
    }
}

/// The powers (nu n)^(2/3) and (nu n)^1.4 from the logarithm of nu n in mm2/s rpm (BR-1, BR-2).
#[physics]
pub fn film_powers<R: Real>(log_nu_n: R) -> [R; 2] {
    R::exp_array([TWO_THIRDS * log_nu_n, 1.4 * log_nu_n])
}

/// The bearings of one kind in a train: what depends on neither speed nor oil is known. Powers of nu n are those of shaft 0; a shaft with
/// another speed has a constant times them.
#[derive(Clone, Copy, Debug, Gather, PartialEq)]
pub struct TrainBearing<R: Real = f64> {
    /// Speed of the shaft over that of shaft 0.
    turns: R,
    /// M_0 without heating over (nu n)^(2/3), and its least, Nm.
    unheated_nm: R,
    least_nm: R,
    heating: ViscousSelfHeating<R>,
    /// M of BR-2 in boundary friction, Nm.
    preload_nm: R,
    /// Exponent of psi over (nu n)^1.4.
    film: R,
}

#[physics]
impl<R: Real> TrainBearing<R> {
    /// Torque at shaft 0, Nm, at a speed of that shaft and with the powers of its nu n (BR-1, BR-2).
    pub fn torque_nm(&self, first_rad_s: R, [power_23, power_14]: [R; 2]) -> R {
        let unheated_nm = (self.unheated_nm * power_23).max(self.least_nm);
        let boundary = (self.film * power_14).exp();
        let own_nm = self.heating.torque_nm(unheated_nm, self.turns * first_rad_s) // BR-1
            + self.preload_nm * (FULL_FILM + BOUNDARY * boundary); // BR-2
        self.turns * own_nm
    }
}

/// Lost share of the power through a stage in the bearings of its two shafts, whose bores are known (BR-3).
pub fn load_share(
    friction: f64,
    [pinion_bore_m, wheel_bore_m]: [f64; 2],
    pinion_radius_m: f64,
    wheel_over_pinion: f64,
) -> f64 {
    let diameter = 2.0 * pinion_radius_m;
    LOAD_OF_TEETH
        * friction
        * (pinion_bore_m / diameter + wheel_bore_m / (wheel_over_pinion * diameter)) // BR-3
}
