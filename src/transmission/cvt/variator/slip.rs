//! Segments slide along the pulleys because gaps between them must close.
//!
//! | label | statement | status |
//! |---|---|---|
//! | SL-1 | e_band = (T1+T2)/2 L / (E A_band) | source: thesis eq. 54 |
//! | SL-2 | e_segs = \|C_x\|/E (strut/A_strut + (active arc + other arc)/2 / A_arc(\|C_x\|)) | source: thesis eq. 55, 56 |
//! | SL-3 | A_arc = 1.74142e-6 + 1.56364e-9 \|C_x\| - 1.74032e-13 C_x2, held beyond its maximum at 4492 N | source: thesis eq. 58; holding is ours |
//! | SL-4 | active arc k t with k = C_x/(mu R' - dT') conventional, \|C_x\|/(mu R' + dT') inverted, real valued | source: thesis eq. 59 to 61; real k derived from the printed count |
//! | SL-5 | gap slip = v e_belt / (own arc - k t) | source: thesis eq. 61 to 64 |
//! | SL-6 | idle slip = gap slip lambda_idle/lambda_act, other pulley by lambda_other/lambda_act | source: thesis eq. 65 to 70; signs per Formulation |
//! | SL-7 | loss = sum \|v_slip F_T\| / w_in | source: thesis eq. 74 to 76 |
//! | SL-8 | conventional at max(C_x, 0) and inverted at max(-C_x, 0) blended by (1 + tanh(C_x/C0))/2 | ASSUMED smoothing of the change of pulley at C_x = 0 |
//! | SL-9 | each pulley's slip is held at +-`slip_bound`, gap and idle slip in proportion | ASSUMED: beyond it gross slip, flagged |
//! | SL-10 | lambda_idle is held above -0.95 | ASSUMED: an idle segment takes no more than its grip; else overload slips the wrong way |
//!
//! Slip is a fraction of belt speed, positive when the output turns slower than the geometric ratio says; independent of speed, so
//! defined at standstill.

use super::{Belt, BeltAtRatio, Tension};
use crate::numeric::exp;

/// Slip and its loss.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Slip {
    /// Slip at the primary over belt speed.
    pub primary: f64,
    /// Slip at the secondary over belt speed.
    pub secondary: f64,
    /// Part of the loading pulley's slip that closes the gaps, over belt speed.
    pub gap: f64,
    /// Part of the loading pulley's slip that the band friction on its idle arc adds, over belt speed.
    pub idle: f64,
    /// Torque loss at the primary, referred to the primary shaft, Nm.
    pub primary_loss_nm: f64,
    /// Torque loss at the secondary, referred to the primary shaft, Nm.
    pub secondary_loss_nm: f64,
    /// Segments in the active arc of the branch in force.
    pub active_segments: f64,
    /// Whether the bound of SL-9 holds the slip.
    pub held: bool,
}

/// Grip never below this share of the friction limit (ASSUMED): keeps the active arc finite where the bands' pull alone takes it up.
const LEAST_GRIP: f64 = 0.05;

/// Grip never below this force, N (ASSUMED; nothing beside any real one): without clamping slip is at its bound and not 0/0.
const NO_GRIP_N: f64 = 1e-6;

/// Blend beyond which one branch alone counts: the other's weight is below 2e-8.
const ALONE: f64 = 9.0;

/// Compression at which the fitted contact area is largest, N (SL-3).
pub(super) const LARGEST_AREA_N: f64 = 4492.0;

/// Contact area between segments in an arc as printed, m2: falls again above [`LARGEST_AREA_N`] (SL-3 without holding).
#[inline]
pub(super) fn printed_area_m2(compression_n: f64) -> f64 {
    let c = compression_n.abs();
    1.74142e-6 + 1.56364e-9 * c - 1.74032e-13 * c * c // SL-3
}

/// Contact area between segments in an arc, m2 (SL-3).
#[inline]
fn arc_area_m2(compression_n: f64) -> f64 {
    let c = compression_n.abs();
    printed_area_m2(if c < LARGEST_AREA_N { c } else { LARGEST_AREA_N })
}

/// What the slip equations of both branches look at; pairs are primary, secondary.
#[derive(Clone, Copy)]
pub(super) struct Contact<'a> {
    pub belt: &'a Belt,
    pub at: &'a BeltAtRatio,
    /// Extension of the band pack and initial gap, m.
    pub slack_m: f64,
    /// Normal force on a segment times friction, N.
    pub grip_n: [f64; 2],
    /// Band friction on the shoulder of a segment, with the sign of dT, N.
    pub shoulder_n: [f64; 2],
    /// C_x as the formulation has the slip equations take it, N.
    pub compression_n: f64,
}

impl<'a> Contact<'a> {
    #[inline]
    pub fn new(belt: &'a Belt, at: &'a BeltAtRatio, t: &Tension, mu_segment: f64) -> Self {
        let prepared = &at.prepared;
        let grip = |clamp_n: f64, pulley: usize| {
            let n = mu_segment * clamp_n * prepared.normal_per_clamp[pulley];
            if n > NO_GRIP_N { n } else { NO_GRIP_N }
        };
        Contact {
            belt,
            at,
            slack_m: t.primary_shoulder_n * prepared.band_gap_m_n + belt.initial_gap_m, // SL-1
            grip_n: [grip(t.primary_clamp_n, 0), grip(t.secondary_clamp_n, 1)],
            shoulder_n: [t.step_n * prepared.shoulder_per_step[0], t.step_n * prepared.shoulder_per_step[1]],
            compression_n: belt.formulation.compression_n(t.compression_n),
        }
    }
}

/// One loading branch: `LOAD` is the pulley where segments are loaded (0 primary, 1 secondary).
#[inline(always)]
fn branch<const LOAD: usize>(c: &Contact) -> Slip {
    let (belt, prepared, f) = (c.belt, &c.at.prepared, c.belt.formulation);
    let (load, other, inverted) = (LOAD, 1 - LOAD, LOAD == 1);
    let sign = if inverted { -1.0 } else { 1.0 };
    let cx = sign * c.compression_n;
    let cx = if cx > 0.0 { cx } else { 0.0 };
    let pitch = belt.segment_thickness_m;
    let shoulder = sign * c.shoulder_n[load];
    let grip = c.grip_n[load] - shoulder;
    let floor = LEAST_GRIP * c.grip_n[load];
    let grip = if grip > floor { grip } else { floor };
    let k = cx / grip; // SL-4
    let arc = prepared.arc_m[load];
    let active = if k * pitch < arc { k * pitch } else { arc };
    let e_segs = cx * (prepared.strut_gap_m_n + 0.5 * (active + prepared.arc_m[other]) / (belt.youngs_pa * arc_area_m2(cx))); // SL-2
    let idle = arc - active;
    let gap = (c.slack_m + e_segs) / (idle + 1e-9); // SL-5
    let lambda_idle = shoulder / c.grip_n[load];
    let lambda_idle = if lambda_idle > LEAST_GRIP - 1.0 { lambda_idle } else { LEAST_GRIP - 1.0 }; // SL-10
    let idle_slip = gap * if inverted || f.signed_idle_slip() { lambda_idle } else { lambda_idle.abs() }; // SL-6
    let free = gap + idle_slip;
    let held = free > belt.slip_bound;
    let share = if held { belt.slip_bound / free } else { 1.0 };
    let (gap, idle_slip) = (gap * share, idle_slip * share); // SL-9
    let loaded = if held { belt.slip_bound } else { free };
    let r = c.at.geometry.primary_radius_m;
    let total_other = cx + sign * c.shoulder_n[other] * prepared.count[other];
    let lambda_other = total_other * prepared.per_count[other] / c.grip_n[other];
    let slip_other = clamp_abs(loaded * lambda_other, belt.slip_bound);
    let idle_loss = if f.counts_idle_arc() { idle_slip.abs() * shoulder.abs() * idle / pitch } else { 0.0 };
    let loss_load = r * (loaded.abs() * c.grip_n[load] * active * (1.0 / pitch) + idle_loss); // SL-7
    let loss_other = r * slip_other.abs() * total_other.abs(); // SL-7
    if inverted {
        let primary = if f.flips_inverted_primary() { slip_other } else { -slip_other }; // SL-6
        Slip {
            primary,
            secondary: -loaded,
            gap,
            idle: idle_slip,
            primary_loss_nm: loss_other,
            secondary_loss_nm: loss_load,
            active_segments: k,
            held,
        }
    } else {
        Slip {
            primary: loaded,
            secondary: slip_other.abs(),
            gap,
            idle: idle_slip,
            primary_loss_nm: loss_load,
            secondary_loss_nm: loss_other,
            active_segments: k,
            held,
        }
    }
}

#[inline]
fn clamp_abs(x: f64, bound: f64) -> f64 {
    if x > bound {
        bound
    } else if x < -bound {
        -bound
    } else {
        x
    }
}

/// Slip of both pulleys and its loss (SL-1 to SL-9).
#[must_use]
#[inline(always)]
pub fn slip(belt: &Belt, at: &BeltAtRatio, t: &Tension, mu_segment: f64) -> Slip {
    let contact = Contact::new(belt, at, t, mu_segment);
    let x = contact.compression_n * (1.0 / belt.blend_n);
    let a = if x >= -ALONE { branch::<0>(&contact) } else { Slip::default() };
    let b = if x <= ALONE { branch::<1>(&contact) } else { Slip::default() };
    // SL-8: (1 + tanh x)/2
    let w = if x > ALONE {
        1.0
    } else if x < -ALONE {
        0.0
    } else {
        1.0 / (1.0 + exp(-2.0 * x))
    };
    let mix = |p: f64, q: f64| w * p + (1.0 - w) * q;
    Slip {
        primary: mix(a.primary, b.primary),
        secondary: mix(a.secondary, b.secondary),
        gap: mix(a.gap, b.gap),
        idle: mix(a.idle, b.idle),
        primary_loss_nm: mix(a.primary_loss_nm, b.primary_loss_nm),
        secondary_loss_nm: mix(a.secondary_loss_nm, b.secondary_loss_nm),
        active_segments: if x >= 0.0 { a.active_segments } else { b.active_segments },
        held: if x >= 0.0 { a.held } else { b.held },
    }
}
