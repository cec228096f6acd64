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
//! | TE-9 | force of the primary that holds the ratio: C_x >= 0: F_h = F_s beta_p/beta_s + beta_p C_x (1 - a_p)/(4 tan th); C_x < 0: the same with a_s; a_i = \|C_x\| cos th/(2 mu_seg F_i), at most 1, the share of its wrap over which the loading pulley loads the segments; F_p in a_p is F_s beta_p/beta_s + beta_p C_x/(8 tan th); C_x here is T/R_s | derived: free body of a segment with the tension over its wrap, F_i 2 tan th/beta_i = T - m v2 - mean compression; that is a_i C_x/2 on the loading pulley (its idle arc has none) and C_x/2 on the other one, as SL-4 and SL-6 have them |
//! | TE-6 | s = -tanh(ln I / eps) | ASSUMED smoothing: the printed switch at I = 1 is a jump |
//!
//! Symbols: F clamping force N, th half wedge angle, m belt mass per length kg/m, v belt speed m/s, mu_b band friction.
//! C_x is continuous in T with a bend at C_x = 0. TE-3 and TE-5 are those of the printed forms, TE-7 that of `smooth`. TE-5 needs mu_b beta_p / 2 < 1,
//! true for mu_b < 0.53; TE-7 mu_b beta / 2 < 1, true for mu_b < 0.64.
//!
//! TE-9 at a torque of 0.77 of the capacity (mu 0.09 in macro, 0.125 in micro slip) gives F_h/F_s 0.89 in a ratio of 2.4, 1.32 at 1 and 1.89 at
//! 0.41, and 0.70, 1 and 1.43 without torque. Measured ratios of other belts are about 1.1, 1.3 and 1.75 (from memory; torque not known). The force in
//! a_p is the middle of what it can be: within 2 % of the F_p that solves TE-9 with its own, and defined where no force does. The pressures
//! of the cylinders have F_h. Capacity, clamp laws, slip, wedging and penetration keep TE-1, with which their constants were found (thesis 8.6): with F_h in SL-4 the rig's slip of 3 % at
//! 139 Nm and 15 bar in low is not reached with a friction of 0.125: it would have to fall as F_h rises over TE-1, by a fifth (estimate). The step of tension, which adds to C_x or takes from it, is left
//! out of TE-9: without torque the force is that of TE-1.

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
    /// Step of band tension dT, or pull of a chain (KC-2), N.
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

/// Force without grip, N (ASSUMED, negligible): a share of it is defined.
const LEAST_N: f64 = 1e-6;

/// Share of a wrap over which a pulley loads segments to a compression, N, under its clamping force, N, for the force c = \|C_x\| cos th/(2 mu)
/// (TE-9).
#[physics]
fn loaded_share<R: Real>(needed_n: R, clamp_n: R) -> R {
    (needed_n / clamp_n.max(LEAST_N)).min(1.0)
}

/// Clamping force at which a compression, N, takes up the whole wrap (TE-9).
#[physics]
fn whole_wrap_n<R: Real>(belt: &Belt<R>, compression_n: R, mu_segment: R) -> R {
    compression_n.abs() * belt.cos_wedge / (2.0 * mu_segment)
}

/// Force that a compression, N, adds to the primary's where its loading pulley has no active arc (TE-9).
#[physics]
fn added_n<R: Real>(belt: &Belt<R>, at: &BeltAtRatio<R>, compression_n: R) -> R {
    at.geometry.primary_wrap_rad * compression_n / (4.0 * belt.tan_wedge)
}

/// Clamping force of the primary that holds a ratio for that of the secondary, `idle_n` its part without torque, and a compression, N (TE-9).
#[physics]
fn holding_n<R: Real>(
    belt: &Belt<R>,
    at: &BeltAtRatio<R>,
    (secondary_n, idle_n): (R, R),
    compression_n: R,
    mu_segment: R,
) -> R {
    let whole_n = whole_wrap_n(belt, compression_n, mu_segment);
    let added_n = added_n(belt, at, compression_n);
    let drives = compression_n.ge(0.0);
    let loading_n = drives.select(idle_n + 0.5 * added_n, secondary_n);
    let holds_n = idle_n + added_n * (1.0 - loaded_share(whole_n, loading_n));
    holds_n.max(0.0) // TE-9
}

#[physics]
impl<R: Real> Tension<R> {
    /// The belt's tension by its formulation, with the smoothed direction of the step (TE-6).
    pub fn driving(belt: &Belt<R>, at: &BeltAtRatio<R>, load: &BeltLoad<R>) -> Self {
        if belt.chain.is_some() {
            Tension::of_chain(belt, at, load)
        } else if belt.formulation.by_statics() {
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

    /// Force of the primary that holds the ratio under an output torque, Nm (TE-9, KC-2), N; in the printed forms, and by a table of thrust ratios, its
    /// clamping force.
    pub fn holding_n(&self, belt: &Belt<R>, at: &BeltAtRatio<R>, output_nm: R, mu_segment: R) -> R {
        if !belt.formulation.by_statics() || belt.thrust_ratio.is_some() {
            return self.primary_clamp_n;
        }
        if belt.chain.is_some() {
            let holds_n = self.primary_shoulder_n / belt.tan_wedge - self.primary_clamp_n; // KC-2
            return holds_n.max(0.0);
        }
        let clamps = (self.secondary_clamp_n, self.primary_clamp_n);
        let compression_n = output_nm * at.prepared.inv_secondary_radius;
        holding_n(belt, at, clamps, compression_n, mu_segment)
    }

    /// Mean band tension (T1 + T2)/2, N (thesis eq. 39).
    #[inline]
    pub fn mean_tension_n(&self, g: &Geometry<R>) -> R {
        self.primary_shoulder_n / g.primary_wrap_rad + self.ring_n // TE-8
    }
}
