//! Band tension and segment compression from clamping force, belt speed and torque.
//!
//! | label | statement | status |
//! |---|---|---|
//! | TE-1 | F_p = F_s beta_p / beta_s, or F_s times a thrust ratio table | source: App. C (Fujii measured an effect of speed: table) |
//! | TE-2 | Q_i = 2 F_i tan th + m beta_i v2 + \|C_x\| beta_i / 2 | source: thesis eq. 38, App. C |
//! | TE-3 | dT = -s mu_b Q_p, s = -1 in low, +1 in high | source: thesis eq. 46, App. C |
//! | TE-4 | C_x = T/R_s - dT | source: thesis eq. 42 |
//! | TE-5 | TE-2 to TE-4 solved: A = 2 F_p tan th + m beta_p v2, Z = T/R_s + s mu_b A, c = mu_b beta_p / 2, C_x = Z/(1 - s c) for Z >= 0, Z/(1 + s c) below | derived |
//! | TE-7 | one force on both pulleys: dT = -s (mu_1 beta Tm + F_v), mu_1 = k mu_b (1 - u_1), k that of a coating of the shoulders (BT-8), beta the smaller wrap, F_v the film's force (FI-1), Tm = A + \|C_x\|/2, A = F_p tan th/beta_p + F_s tan th/beta_s + m v2; C_x as TE-5 with mu_1 beta A + F_v and c = mu_1 beta/2 | derived: the belt has two strands, so its tension steps by the same force over both pulleys, and the smaller wrap limits it |
//! | TE-8 | `smooth`: m is that of the segments, and the mean tension of the bands is Q/beta + m_b v2, m_b theirs | derived: free body of a segment, 2 F tan th + m_s beta v2 + \|C_x\| beta/2 = Q, and of a band element, T = Q/beta + m_b v2; the thesis and the printed forms have the whole belt press |
//! | TE-6 | s = -tanh(ln I / eps) | ASSUMED smoothing: the printed switch at I = 1 is a jump |
//!
//! Symbols: F clamping force N, th half wedge angle, m belt mass per length kg/m, v belt speed m/s, mu_b band friction.
//! C_x is continuous in T with a bend at C_x = 0. TE-3 and TE-5 are those of the printed forms, TE-7 that of `smooth`. TE-5 needs mu_b beta_p / 2 < 1,
//! true for mu_b < 0.53; TE-7 mu_b beta / 2 < 1, true for mu_b < 0.64.

use super::{Belt, BeltAtRatio, BeltLoad, Geometry};
use crate::math::{Mask, Real, physics};

/// Band pack and segment forces at one operating point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tension<R: Real = f64> {
    /// Axial clamping force, primary, N.
    pub primary_clamp_n: R,
    /// Axial clamping force, secondary, N.
    pub secondary_clamp_n: R,
    /// Total shoulder normal force, primary (Q-hat), N.
    pub primary_shoulder_n: R,
    /// Total shoulder normal force, secondary, N.
    pub secondary_shoulder_n: R,
    /// Segment compression C_x, N; negative when it acts in the opposite strut.
    pub compression_n: R,
    /// Step of band tension dT, N.
    pub step_n: R,
    /// Tension that the bands' own mass takes up, N (TE-8).
    pub ring_n: R,
}

/// Compression C_x for the step that it has without one, Z, and the rise of the step with it, s c (TE-5, TE-7).
#[physics]
fn compression_n<R: Real>(z: R, sc: R) -> R {
    // The divisors are known before the torque is: nothing waits for a division.
    z * z.ge(0.0).select(1.0 / (1.0 - sc), 1.0 / (1.0 + sc))
}

/// Clamping forces of primary and secondary (TE-1), and the flows of momentum m v2 of what presses and of bands that carry themselves (TE-8), N.
#[physics]
fn forces_n<R: Real>(belt: &Belt<R>, at: &BeltAtRatio<R>, load: &BeltLoad<R>) -> ([R; 2], [R; 2]) {
    let v = load.primary_speed_rad_s * at.geometry.primary_radius_m;
    let clamp_n = [
        load.secondary_clamp_n * at.thrust_ratio,
        load.secondary_clamp_n,
    ]; // TE-1
    let [pressing, bands] = belt.masses_kg_m();
    (clamp_n, [pressing * v * v, bands * v * v])
}

/// Shoulder force per angle of wrap without compression, A, N (TE-7).
#[physics]
fn bare_mean_n<R: Real>(
    belt: &Belt<R>,
    at: &BeltAtRatio<R>,
    load: &BeltLoad<R>,
    centrifugal_n: R,
) -> R {
    belt.tan_wedge * load.secondary_clamp_n * at.prepared.clamps_per_wrap + centrifugal_n
}

/// Boundary friction of the innermost interface per mean tension: of the part that is not on a film, on the smaller wrap (TE-7).
#[physics]
fn grip<R: Real>(at: &BeltAtRatio<R>, load: &BeltLoad<R>) -> R {
    let dry = 1.0 - load.band.film_share[0];
    load.band.mu * dry * at.prepared.shoulder_rad
}

#[physics]
impl<R: Real> Tension<R> {
    /// The belt's tension by its formulation, with the smoothed direction of the step (TE-6).
    pub fn driving(belt: &Belt<R>, at: &BeltAtRatio<R>, load: &BeltLoad<R>) -> Self {
        if belt.formulation.by_statics() {
            Tension::one_force(belt, at, load)
        } else {
            Tension::new(belt, at, load, at.direction)
        }
    }

    /// Solves tension and compression with one force between bands and segments on both pulleys (TE-7).
    pub fn one_force(belt: &Belt<R>, at: &BeltAtRatio<R>, load: &BeltLoad<R>) -> Self {
        let (g, s) = (&at.geometry, at.direction);
        let (clamp_n, [centrifugal_n, ring_n]) = forces_n(belt, at, load);
        let wraps = [g.primary_wrap_rad, g.secondary_wrap_rad];
        let mean = bare_mean_n(belt, at, load, centrifugal_n);
        let (grip, film_n) = (grip(at, load), load.film_n[0]);
        let z =
            load.output_torque_nm * at.prepared.inv_secondary_radius + s * (grip * mean + film_n);
        let cx = compression_n(z, s * (0.5 * grip)); // TE-7
        let tension = mean + 0.5 * cx.abs();
        Tension {
            primary_clamp_n: clamp_n[0],
            secondary_clamp_n: clamp_n[1],
            primary_shoulder_n: tension * wraps[0],
            secondary_shoulder_n: tension * wraps[1],
            compression_n: cx,
            step_n: -s * (grip * tension + film_n), // TE-7
            ring_n,
        }
    }

    /// Step of tension without compression, N: the torque at which compression changes sign gives it (TE-5, TE-7 with Z = 0).
    #[inline]
    pub fn bare_step_n(belt: &Belt<R>, at: &BeltAtRatio<R>, load: &BeltLoad<R>) -> R {
        let (clamp_n, [centrifugal_n, _]) = forces_n(belt, at, load);
        let g = &at.geometry;
        let force_n = if belt.formulation.by_statics() {
            grip(at, load) * bare_mean_n(belt, at, load, centrifugal_n) + load.film_n[0]
        } else {
            load.band.mu * (2.0 * clamp_n[0] * belt.tan_wedge + g.primary_wrap_rad * centrifugal_n)
        };
        -at.direction * force_n
    }

    /// Solves tension and compression for a direction s of the tension step, -1 in low, +1 in high (TE-2 to TE-5).
    pub fn new(belt: &Belt<R>, at: &BeltAtRatio<R>, load: &BeltLoad<R>, s: R) -> Self {
        let (g, mu, bp) = (&at.geometry, load.band.mu, at.geometry.primary_wrap_rad);
        let (clamp_n, [centrifugal_n, ring_n]) = forces_n(belt, at, load);
        let a = 2.0 * clamp_n[0] * belt.tan_wedge + bp * centrifugal_n;
        let z = load.output_torque_nm * at.prepared.inv_secondary_radius + s * mu * a;
        let c = mu * bp / 2.0;
        let cx = compression_n(z, s * c); // TE-5
        let q_p = a + cx.abs() * bp / 2.0; // TE-2
        let bs = g.secondary_wrap_rad;
        Tension {
            primary_clamp_n: clamp_n[0],
            secondary_clamp_n: clamp_n[1],
            primary_shoulder_n: q_p,
            secondary_shoulder_n: 2.0 * clamp_n[1] * belt.tan_wedge
                + bs * centrifugal_n
                + cx.abs() * bs / 2.0, // TE-2
            compression_n: cx,
            step_n: -s * mu * q_p, // TE-3
            ring_n,
        }
    }

    /// Mean band tension (T1 + T2)/2, N (thesis eq. 39).
    #[inline]
    pub fn mean_tension_n(&self, g: &Geometry<R>) -> R {
        self.primary_shoulder_n / g.primary_wrap_rad + self.ring_n // TE-8
    }
}
