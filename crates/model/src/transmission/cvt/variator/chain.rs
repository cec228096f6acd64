//! The pulling chain in place of the pushing belt: rocker joints, pin ends and slip.
//!
//! | label | statement | status |
//! |---|---|---|
//! | KC-1 | x = \|T_s\|/T_cap (VA-4), a = min(x, 1) the share of its wrap over which a pulley changes the tension by C = T_s/R_s, at the exit | derived: Coulomb friction of even pressure, full where the chain creeps and none where it rests on the sheaves |
//! | KC-2 | mean of both strands T_m = 2 F_s tan th/beta_s + m v2 + C (1 - a)/2; force that holds the ratio F_h = F_s beta_p/beta_s + beta_p C (1 - a)/(2 tan th) | derived: free body of a pin, F 2 tan th/beta = mean of T over the wrap - m v2, that of a driving pulley T_1 - a C/2 and of a driven one T_2 + a C/2, \|C\| with the pulleys changed over in overrun |
//! | KC-3 | rocker joints: T_joint = 2 e T_m (1 + 1/I) at the primary | derived: moments about both pulleys with each strand at R + e or R - e from the axis, against the motion where a joint bends and where it straightens; as power, T e p/R for each joint that turns by p/R; e ASSUMED |
//! | KC-4 | pin ends: T_pin = sum 4 mu F p r/(beta cos th R) by pulley, that of the secondary over I | derived: the trailing link turns a held joint by p/R against the sheaves at the entry, and back at the exit, under the friction moment mu N r of each face, N = F p/(R beta cos th); r ASSUMED |
//! | KC-5 | slip s = C/EA + s_0 (1 - (1 - x)^(1/2)) with the sign of T_s, 1 + 20 (x - 1) in place of the bracket above x = 1, at most that of SL-9 on both pulleys; loss s T_s/I | derived: strain of the chain between its strands, and a pin that leans along the sheaves, sticks and then slides under even pressure (brush model); s_0, and the slope above x = 1, ASSUMED |
//! | KC-6 | wedging and penetration as WE-1 to PE-1 | derived: both are forces per length of arc, the pitch cancels |
//!
//! Symbols: T_s torque of the secondary Nm, C pull N, F clamping force N, th half wedge angle, m mass per length kg/m, v speed m/s, p pitch m, e and r levers m, EA stiffness N.
//! Valid for clamping forces from zero on and both signs of torque: KC-3 and KC-4 have no sign of it, and KC-5 has that of T_s, so that no loss is negative. Continuous everywhere; the slope of slip
//! over torque is without bound at x = 1. There are no bands, no film and no segments (BT, FI, SL-1 to SL-8). Left out: the impact of a pin at the entry and the run of the polygon, the pull's part of PB-1, C (1 - a), and
//! slip that differs between the pulleys: half of it is given to each.

use super::deflection::deflection;
use super::{Belt, BeltAtRatio, BeltLoad, Parts, Slip, Tension, capacity_nm};
use crate::keys::{Values, keys};
use crate::math::{Gather, Mask, Real, both, physics};

/// What a chain has in place of bands and segments.
#[derive(Clone, Copy, Debug, Gather, PartialEq)]
pub struct Chain<R: Real = f64> {
    /// Lever of the friction in a joint, m.
    pub joint_m: R,
    /// Lever of the friction on the face of a pin, m.
    pub pin_m: R,
    /// Slip at which the whole wrap slides.
    pub slip: R,
    /// Force over strain, N.
    pub stiffness_n: R,
}

keys! {
    /// Keys of `[transmission.cvt.belt.kind.chain]`.
    CHAIN: ChainKeys = "chain" [] {
        pitch_mm: number(2.0, 20.0), "distance of the joints", ["KC-4"];
        joint_lever_mm: number(0.0, 1.0), "lever of the friction in a rocker joint: 0 rolls without loss", ["KC-3"];
        pin_lever_mm: number(0.0, 3.0), "lever of the friction of a pin's face on a sheave", ["KC-4"];
        slip_percent: number(0.1, 10.0), "slip at which the whole wrap slides", ["KC-5"];
        stiffness_n: number(1e5, 1e8), "force over strain of the chain", ["KC-5"];
    }
}

/// Rise of the bracket of KC-5 above the capacity (ASSUMED): gross slip is flagged there.
const BEYOND: f64 = 20.0;

impl Chain {
    /// A chain and its pitch, m, from the values of its table.
    pub(super) fn from_values<V: Values>(s: &V) -> (Self, f64) {
        let chain = Chain {
            joint_m: s.number(&CHAIN.joint_lever_mm),
            pin_m: s.number(&CHAIN.pin_lever_mm),
            slip: s.number(&CHAIN.slip_percent),
            stiffness_n: s.number(&CHAIN.stiffness_n),
        };
        (chain, s.number(&CHAIN.pitch_mm))
    }
}

/// Torque over capacity (KC-1); that of no clamping force is without bound.
#[physics]
fn use_of_grip<R: Real>(load: &BeltLoad<R>, capacity_nm: R) -> R {
    load.output_torque_nm.abs() / capacity_nm.max(LEAST_NM)
}

/// Capacity that keeps KC-1 finite, Nm (ASSUMED, negligible).
const LEAST_NM: f64 = 1e-9;

#[physics]
impl<R: Real> Tension<R> {
    /// Strands and clamping forces of a chain; the step of its tension is the pull (KC-2).
    pub(super) fn of_chain(belt: &Belt<R>, at: &BeltAtRatio<R>, load: &BeltLoad<R>) -> Self {
        let g = &at.geometry;
        let v = load.primary_speed_rad_s * g.primary_radius_m;
        let clamp_n = load.secondary_clamp_n;
        let pull_n = load.output_torque_nm * at.prepared.inv_secondary_radius;
        let bare = Tension {
            primary_clamp_n: clamp_n * at.thrust_ratio,
            secondary_clamp_n: clamp_n,
            primary_shoulder_n: clamp_n,
            secondary_shoulder_n: clamp_n,
            compression_n: clamp_n.splat(0.0),
            step_n: pull_n,
            ring_n: belt.mass_kg_m * v * v,
        };
        let capacity = capacity_nm(at, &bare, load.capacity_friction);
        let rests = 1.0 - use_of_grip(load, capacity).min(1.0);
        let pressed_n =
            (2.0 * belt.tan_wedge * clamp_n / g.secondary_wrap_rad + 0.5 * pull_n * rests).max(0.0); // KC-2
        Tension {
            primary_shoulder_n: pressed_n * g.primary_wrap_rad,
            secondary_shoulder_n: pressed_n * g.secondary_wrap_rad,
            ..bare
        }
    }
}

/// Slip of both pulleys with the sign of the torque, and where its bound holds it (KC-5, SL-9).
#[physics]
fn slip<R: Real>(belt: &Belt<R>, chain: &Chain<R>, x: R, pull_n: R) -> (R, R::Mask) {
    let slides = 1.0 - (1.0 - x).max(0.0).sqrt() + BEYOND * (x - 1.0).max(0.0);
    let free = chain.slip * slides + pull_n.abs() / chain.stiffness_n; // KC-5
    let most = 2.0 * belt.slip_bound;
    let drives = pull_n.ge(0.0);
    let size = free.min(most);
    (drives.select(size, -size), free.gt(most))
}

/// Everything that the equations give of a chain at one operating point.
#[physics]
pub(super) fn parts<R: Real>(
    belt: &Belt<R>,
    chain: &Chain<R>,
    at: &BeltAtRatio<R>,
    load: &BeltLoad<R>,
) -> Parts<R> {
    let g = &at.geometry;
    let tension = Tension::of_chain(belt, at, load);
    let capacity = capacity_nm(at, &tension, load.capacity_friction);
    let x = use_of_grip(load, capacity);
    let (total, held) = slip(belt, chain, x, tension.step_n);
    let turns = [total.splat(1.0), g.inv_ratio];
    let mean_n = tension.mean_tension_n(g);
    let clamp_n = [tension.primary_clamp_n, tension.secondary_clamp_n];
    let face = 2.0 * load.flank_friction * chain.pin_m;
    let half = 0.5 * total;
    let half_nm = half * (load.output_torque_nm * g.inv_ratio);
    let none = total.splat(0.0);
    Parts {
        slip: Slip {
            primary: half,
            secondary: half,
            gap: none,
            idle: none,
            primary_loss_nm: half_nm,
            secondary_loss_nm: half_nm,
            active_segments: x.min(1.0) * at.prepared.count[0],
            held,
        },
        band_nm: [none; 2],
        film_nm: none,
        joint_nm: both!(i => 2.0 * chain.joint_m * mean_n * turns[i]), // KC-3
        // KC-4: 2 F p/(R beta cos th) is the normal force of both faces, at the entry and once more at the exit, per turn of the pulley
        pin_nm: both!(i => face * clamp_n[i] * at.prepared.normal_per_clamp[i] * turns[i]),
        deflection: deflection(belt, at, &tension, load.flank_friction),
        capacity_nm: capacity,
        holding_n: tension.holding_n(belt, at, load.output_torque_nm, load.segment_friction),
        tension,
    }
}
