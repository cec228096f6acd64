//! Loss of a gear mesh under load.
//!
//! | label | statement | status |
//! |---|---|---|
//! | GM-1 | tooth loss factor H_V = pi (u + 1)/(z_1 u cos beta_b) (1 - e_a + e_1^2 + e_2^2) | source: ISO/TR 14179-2 (Ohlendorf), in an open program of TU Munich |
//! | GM-2 | mu_m = 0.048 ((F_bt/b)/(v_S rho_C))^0.2 eta^-0.05 Ra^0.25 X_L, at most 0.15 | source: ISO/TR 14179-2 (Schlenk), the same program; bounds ASSUMED |
//! | GM-3 | lost share of the power through the mesh: mu_m H_V | source: ISO/TR 14179-2 |
//!
//! u >= 1 the ratio of wheel to pinion, z_1 teeth of the pinion, e the contact ratios from centre distance, module and helix without profile
//! shift, normal angle 20 degrees, addendum one module. F_bt/b in N/mm, at least 150; v_S = 2 v sin alpha_wt in m/s with v at least 0.5;
//! rho_C in mm, eta in mPa s, Ra in um; X_L 1 for mineral oil. The force is that of the power that is demanded, so that the share is known
//! before the torques are.

use crate::math::{Gather, Real, cos, exp, larger, ln, physics, tan};
use std::f64::consts::PI;

/// Normal pressure angle, rad.
const PRESSURE_ANGLE_RAD: f64 = PI / 9.0;
/// Least load of the teeth for which GM-2 holds, N/mm.
const MIN_LINE_LOAD_N_MM: f64 = 150.0;
/// Least speed of the pitch circles for which GM-2 holds, m/s.
const MIN_PITCH_M_S: f64 = 0.5;
/// Largest friction of the teeth.
const MAX_FRICTION: f64 = 0.15;

/// A pair of helical wheels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stage {
    /// Centre distance, m.
    pub centre_m: f64,
    /// Normal module, m.
    pub module_m: f64,
    /// Face width, m.
    pub face_m: f64,
    /// Helix angle, rad.
    pub helix_rad: f64,
}

/// Surface and oil of the teeth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Teeth {
    /// Roughness, m.
    pub roughness_m: f64,
    /// Factor of the kind of oil, X_L.
    pub oil_factor: f64,
}

/// A mesh at its ratio, in a train.
#[derive(Clone, Copy, Debug, Gather, PartialEq)]
pub struct Mesh<R: Real = f64> {
    /// H_V (GM-1).
    pub loss_factor: R,
    /// Speed of the pinion over that of the train's first shaft.
    pinion_turns: R,
    /// Pitch radius of the pinion, m.
    pitch_radius_m: R,
    /// Load of the teeth for a torque at the train's first shaft, N/mm per Nm.
    line_load_per_nm: R,
    /// Factor of GM-2 from the wheels and the oil's kind.
    friction_factor: R,
}

impl Stage {
    /// Ratio of wheel to pinion: an overdrive turned round.
    fn wheel_over_pinion(ratio: f64) -> f64 {
        larger(ratio, 1.0 / ratio)
    }

    /// Pitch radius of the smaller wheel, m.
    pub fn pinion_radius_m(&self, ratio: f64) -> f64 {
        self.centre_m / (1.0 + Self::wheel_over_pinion(ratio))
    }

    /// Teeth of the smaller wheel.
    pub fn pinion_teeth(&self, ratio: f64) -> f64 {
        2.0 * self.pinion_radius_m(ratio) * cos(self.helix_rad) / self.module_m
    }

    /// The mesh at a ratio of speeds, its first wheel turning `turns` times as fast as the train's first shaft.
    pub fn mesh(&self, ratio: f64, turns: f64, teeth: Teeth) -> Mesh {
        let u = Self::wheel_over_pinion(ratio);
        let (helix_cos, module) = (cos(self.helix_rad), self.module_m);
        let cos_of_tan = |tan: f64| 1.0 / (1.0 + tan * tan).sqrt();
        let (pressure_tan, helix_tan) = (tan(PRESSURE_ANGLE_RAD), tan(self.helix_rad));
        // The transverse pressure angle.
        let tan = pressure_tan / helix_cos;
        let cos = cos_of_tan(tan);
        let (sin, base_helix_cos) = (tan * cos, cos_of_tan(helix_tan * cos));
        let pinion = 2.0 * self.pinion_radius_m(ratio);
        let base = [pinion * cos, pinion * u * cos];
        let tip = [pinion + 2.0 * module, pinion * u + 2.0 * module];
        let reach = |k: usize| 0.5 * (tip[k] * tip[k] - base[k] * base[k]).sqrt();
        let pitch = PI * module / helix_cos * cos; // on the base circle, transverse
        // Contact ratios of the whole path and of its parts beyond the pitch point.
        let whole = (reach(0) + reach(1) - self.centre_m * sin) / pitch;
        let beyond = (reach(0) - 0.5 * base[0] * tan) / pitch;
        let before = whole - beyond;
        let teeth_1 = self.pinion_teeth(ratio);
        let loss_factor = PI * (u + 1.0) / (teeth_1 * u * base_helix_cos)
            * (1.0 - whole + beyond * beyond + before * before); // GM-1
        let pinion_turns = turns * larger(1.0, 1.0 / ratio);
        let rho_mm = 1e3 * 0.5 * pinion * sin * u / (base_helix_cos * (u + 1.0));
        let power = |x: f64, exponent: f64| exp(exponent * ln(x));
        Mesh {
            loss_factor,
            pinion_turns,
            pitch_radius_m: 0.5 * pinion,
            line_load_per_nm: 1.0 / (pinion_turns * 0.5 * base[0] * 1e3 * self.face_m),
            friction_factor: 0.048
                * power(2.0 * sin * rho_mm, -0.2)
                * power(1e6 * teeth.roughness_m, 0.25)
                * teeth.oil_factor,
        }
    }
}

#[physics]
impl<R: Real> Mesh<R> {
    /// Mean friction of the teeth at a speed of the train's first shaft and a torque there, with the logarithm of the oil's viscosity in mPa s
    /// (GM-2).
    #[inline]
    pub fn friction(&self, first_rad_s: R, torque_nm: R, log_eta: R) -> R {
        Mesh::frictions(
            [self],
            first_rad_s,
            torque_nm,
            [log_eta, log_eta.splat(0.0)],
        )[0]
    }

    /// The same of several meshes of a train, with the logarithm of the fluid's factor, too (FR-7).
    fn frictions<const COUNT: usize>(
        meshes: [&Mesh<R>; COUNT],
        first_rad_s: R,
        torque_nm: R,
        [log_eta, log_oil]: [R; 2],
    ) -> [R; COUNT] {
        let mut logs = [torque_nm; COUNT];
        for (mesh, log) in meshes.iter().zip(&mut logs) {
            let load = torque_nm.abs() * mesh.line_load_per_nm;
            let pitch_m_s = first_rad_s * mesh.pinion_turns * mesh.pitch_radius_m;
            *log = load.max(MIN_LINE_LOAD_N_MM) / pitch_m_s.max(MIN_PITCH_M_S);
        }
        logs = R::ln_array(logs);
        for log in &mut logs {
            *log = 0.2 * *log - 0.05 * log_eta + log_oil; // FR-7
        }
        let mut frictions = R::exp_array(logs);
        for (mesh, friction) in meshes.iter().zip(&mut frictions) {
            *friction = (mesh.friction_factor * *friction).min(MAX_FRICTION); // GM-2
        }
        frictions
    }

    /// Lost shares of the power through several meshes of a train, with the logarithms of the oil's viscosity in mPa s and of its factor (GM-3,
    /// FR-7).
    pub fn shares<const COUNT: usize>(
        meshes: [&Mesh<R>; COUNT],
        first_rad_s: R,
        torque_nm: R,
        logs: [R; 2],
    ) -> [R; COUNT] {
        let mut shares = Mesh::frictions(meshes, first_rad_s, torque_nm, logs);
        for (mesh, share) in meshes.iter().zip(&mut shares) {
            *share = *share * mesh.loss_factor; // GM-3
        }
        shares
    }

    /// Lost share of the power through the mesh (GM-3).
    #[inline]
    pub fn share(&self, first_rad_s: R, torque_nm: R, log_eta: R) -> R {
        Mesh::shares(
            [self],
            first_rad_s,
            torque_nm,
            [log_eta, log_eta.splat(0.0)],
        )[0]
    }
}
