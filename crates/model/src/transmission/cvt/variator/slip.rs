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
//! | SL-11 | `smooth`: the share of slip in the loss is s T_out/I, with its sign: above zero a loss, below zero it relieves bands and film, T_band + T_film <- T_band + T_film + s T_out/I | derived: statics of both pulleys, T_in = T_out/I + torque of bands, film, wedge and penetration, with w_s = w_p (1 - s)/I |
//! | SL-12 | `smooth`: where s T_out < 0, \|s\| <= (T_band + T_film) I/\|T_out\| | derived: second law, the belt gives no energy back |
//! | SL-8 | conventional at max(C_x, 0) and inverted at max(-C_x, 0) blended by (1 + tanh(C_x/C0))/2 | ASSUMED smoothing of the change of pulley at C_x = 0 |
//! | SL-9 | each pulley's slip is held at +-`slip_bound`, gap and idle slip in proportion | ASSUMED: beyond it gross slip, flagged |
//! | SL-10 | lambda_idle is held above -0.95 | ASSUMED: an idle segment takes no more than its grip; else overload slips the wrong way |
//!
//! Slip is a fraction of belt speed, positive when the output turns slower than the geometric ratio says; independent of speed, so
//! defined at standstill.

use super::{Belt, BeltAtRatio, Tension};
use crate::math::{Mask, Real, both, physics};

/// Slip and its loss.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Slip<R: Real = f64> {
    /// Slip at the primary over belt speed.
    pub primary: R,
    /// Slip at the secondary over belt speed.
    pub secondary: R,
    /// Part of the loading pulley's slip that closes the gaps, over belt speed.
    pub gap: R,
    /// Part of the loading pulley's slip that the band friction on its idle arc adds, over belt speed.
    pub idle: R,
    /// Torque loss at the primary, referred to the primary shaft, Nm; by statics with the sign of slip times torque (SL-11).
    pub primary_loss_nm: R,
    /// Torque loss at the secondary, referred to the primary shaft, Nm; by statics with the sign of slip times torque (SL-11).
    pub secondary_loss_nm: R,
    /// Segments in the active arc of the branch in force.
    pub active_segments: R,
    /// True where the bound of SL-9 limits the slip.
    pub held: R::Mask,
}

/// Grip never below this share of the friction limit (ASSUMED): keeps the active arc finite where the bands' pull alone takes it up.
const MIN_GRIP: f64 = 0.05;

/// Least lambda of an idle segment (SL-10).
const MIN_LAMBDA: f64 = MIN_GRIP - 1.0;

/// Grip never below this force, N (ASSUMED; negligible against any real one): without clamping slip is at its bound and not 0/0.
const NO_GRIP_N: f64 = 1e-6;

/// Blend beyond which one branch alone counts: the other's weight is below 2e-8.
const ALONE: f64 = 9.0;

/// Compression at which the fitted contact area is largest, N (SL-3).
pub(super) const MAX_AREA_N: f64 = 4492.0;

/// Contact area between segments in an arc for a compression \|C_x\| as printed, m2: falls again above [`MAX_AREA_N`] (SL-3 without holding).
#[physics]
pub(super) fn printed_area_m2<R: Real>(compression_n: R) -> R {
    let c = compression_n;
    1.74142e-6 + 1.56364e-9 * c - 1.74032e-13 * c * c // SL-3
}

/// Contact area between segments in an arc for a compression \|C_x\|, m2 (SL-3).
#[physics]
fn arc_area_m2<R: Real>(compression_n: R) -> R {
    printed_area_m2(compression_n.min(MAX_AREA_N))
}

/// Inputs of the slip equations of both branches; pairs are primary, secondary.
#[derive(Clone, Copy)]
pub(super) struct Contact<'a, R: Real = f64> {
    pub belt: &'a Belt<R>,
    pub at: &'a BeltAtRatio<R>,
    /// Extension of the band pack and initial gap, m.
    pub slack_m: R,
    /// Normal force on a segment times friction, N.
    pub grip_n: [R; 2],
    /// Band friction on the shoulder of a segment, with the sign of dT, N.
    pub shoulder_n: [R; 2],
    /// C_x as the formulation has the slip equations take it, N.
    pub compression_n: R,
}

#[physics]
impl<'a, R: Real> Contact<'a, R> {
    pub fn new(belt: &'a Belt<R>, at: &'a BeltAtRatio<R>, t: &Tension<R>, mu_segment: R) -> Self {
        let prepared = &at.prepared;
        let clamp_n = [t.primary_clamp_n, t.secondary_clamp_n];
        let grip_n =
            both!(i => (mu_segment * clamp_n[i] * prepared.normal_per_clamp[i]).max(NO_GRIP_N));
        Contact {
            belt,
            at,
            slack_m: (t.primary_shoulder_n + t.ring_n * at.geometry.primary_wrap_rad)
                * prepared.band_gap_m_n
                + belt.initial_gap_m, // SL-1
            grip_n,
            shoulder_n: [
                t.step_n * prepared.shoulder_per_step[0],
                t.step_n * prepared.shoulder_per_step[1],
            ],
            compression_n: belt.formulation.compression_n(t.compression_n),
        }
    }
}

/// Both loading branches side by side: conventional (segments loaded in the primary), inverted (in the secondary).
struct Branches<R> {
    /// Slip of the loaded pulley, not below zero, and of the other one.
    loaded: [R; 2],
    other: [R; 2],
    /// Slip of the loaded pulley before its bound (SL-9), and the part of it that closes the gaps.
    free: [R; 2],
    gap: [R; 2],
    loss_loaded_nm: [R; 2],
    loss_other_nm: [R; 2],
    active_segments: [R; 2],
}

/// Works out both branches (SL-2 to SL-7, SL-9, SL-10). One of them carries no compression; processors do two at once for one.
#[physics]
fn branches<R: Real>(c: &Contact<'_, R>) -> Branches<R> {
    let (belt, prepared, f) = (c.belt, &c.at.prepared, c.belt.formulation);
    let pitch = belt.segment_thickness_m;
    let arc = prepared.arc_m;
    let arc_other = [arc[1], arc[0]];
    let cx = [c.compression_n.max(0.0), (-c.compression_n).max(0.0)];
    let shoulder = [c.shoulder_n[0], -c.shoulder_n[1]];
    let grip = both!(i => (c.grip_n[i] - shoulder[i]).max(MIN_GRIP * c.grip_n[i]));
    let k = both!(i => cx[i] / grip[i]); // SL-4
    let segments = both!(i => k[i].min(prepared.count[i]));
    let active = both!(i => segments[i] * pitch);
    let arcs = both!(i => 0.5 * (active[i] + arc_other[i]) / (belt.youngs_pa * arc_area_m2(cx[i])));
    let e_segs = both!(i => cx[i] * (prepared.strut_gap_m_n + arcs[i])); // SL-2
    let idle_arc = both!(i => arc[i] - active[i]);
    let gap = both!(i => (c.slack_m + e_segs[i]) / (idle_arc[i] + 1e-9)); // SL-5
    let per_grip = both!(i => 1.0 / c.grip_n[i]);
    let lambda = both!(i => (shoulder[i] * per_grip[i]).max(MIN_LAMBDA)); // SL-10
    // Conventional loading takes the magnitude: the larger of the number and its opposite.
    let turned = [if f.signed_idle_slip() { 1.0 } else { -1.0 }, 1.0];
    let idle = both!(i => gap[i] * (turned[i] * lambda[i]).max(lambda[i])); // SL-6
    let free = both!(i => gap[i] + idle[i]); // not below zero (SL-10)
    let loaded = both!(i => belt.slip_bound.min(free[i])); // SL-9
    // The other pulley of each branch: the secondary of conventional loading, the primary of inverted loading.
    let total_other = [
        cx[0] + c.shoulder_n[1] * prepared.count[1],
        cx[1] - c.shoulder_n[0] * prepared.count[0],
    ];
    let per_other = [
        prepared.inv_segments[1] * per_grip[1],
        prepared.inv_segments[0] * per_grip[0],
    ];
    let other_free = both!(i => loaded[i] * (total_other[i] * per_other[i]));
    let other = both!(i => other_free[i].clamp(-belt.slip_bound, belt.slip_bound)); // SL-9
    let mut branches = Branches {
        loaded,
        other,
        free,
        gap,
        loss_loaded_nm: [c.slack_m.splat(0.0); 2],
        loss_other_nm: [c.slack_m.splat(0.0); 2],
        active_segments: k,
    };
    if f.by_statics() {
        return branches; // SL-11
    }
    let r = c.at.geometry.primary_radius_m;
    let mut loaded_n = both!(i => loaded[i] * c.grip_n[i] * segments[i]);
    if f.counts_idle_arc() {
        let held = both!(i => free[i].gt(loaded[i]));
        let share = both!(i => held[i].select(loaded[i] / free[i], free[i].splat(1.0)));
        let idle_n = both!(i => (idle[i] * share[i] * shoulder[i]).abs());
        loaded_n = both!(i => loaded_n[i] + idle_n[i] * (idle_arc[i] / pitch));
    }
    branches.loss_loaded_nm = both!(i => r * loaded_n[i]); // SL-7
    branches.loss_other_nm = both!(i => r * (other[i] * total_other[i]).abs()); // SL-7
    branches
}

#[physics]
impl<R: Real> Slip<R> {
    /// The slip with its share of the loss by statics: `net_nm` is the output torque at the primary shaft, `sliding_nm` what bands and film
    /// lose before it (SL-11, SL-12).
    pub(super) fn by_statics(self, net_nm: R, sliding_nm: R) -> Self {
        let share_nm = (self.primary + self.secondary) * net_nm;
        let beyond = (-sliding_nm).gt(share_nm);
        let mut kept = share_nm.splat(1.0);
        if beyond.any() {
            kept = beyond.select(-sliding_nm / share_nm, kept); // SL-12
        }
        let (primary, secondary) = (kept * self.primary, kept * self.secondary);
        Slip {
            primary,
            secondary,
            gap: kept * self.gap,
            idle: kept * self.idle,
            primary_loss_nm: primary * net_nm,     // SL-11
            secondary_loss_nm: secondary * net_nm, // SL-11
            ..self
        }
    }
}

/// A value of both branches by the weight of the first (SL-8).
#[physics]
fn mixed<R: Real>(weight: R, conventional: R, inverted: R) -> R {
    weight * conventional + (1.0 - weight) * inverted
}

/// Slip of both pulleys and its loss (SL-1 to SL-9).
#[physics]
pub fn slip<R: Real>(
    belt: &Belt<R>,
    at: &BeltAtRatio<R>,
    t: &Tension<R>,
    mu_segment: R,
) -> Slip<R> {
    let contact = Contact::new(belt, at, t, mu_segment);
    let b = branches(&contact);
    let x = contact.compression_n * at.fixed.per_blend_n;
    // SL-8: (1 + tanh x)/2
    let (blends, zero) = (!x.abs().gt(ALONE), x.splat(0.0));
    let mut w = x.gt(0.0).select(x.splat(1.0), zero);
    if blends.any() {
        w = blends.select(1.0 / (1.0 + (-2.0 * x).exp()), w);
    }
    let other = if belt.formulation.flips_inverted_primary() {
        b.other[1]
    } else {
        -b.other[1]
    }; // SL-6
    let held = both!(i => b.free[i].gt(b.loaded[i]));
    let gap = both!(i => held[i].select(b.gap[i] * (b.loaded[i] / b.free[i]), b.gap[i])); // SL-9
    let is_inverted = zero.gt(x);
    Slip {
        primary: mixed(w, b.loaded[0], other),
        secondary: mixed(w, b.other[0].abs(), -b.loaded[1]),
        gap: mixed(w, gap[0], gap[1]),
        idle: mixed(w, b.loaded[0] - gap[0], b.loaded[1] - gap[1]),
        primary_loss_nm: mixed(w, b.loss_loaded_nm[0], b.loss_other_nm[1]),
        secondary_loss_nm: mixed(w, b.loss_other_nm[0], b.loss_loaded_nm[1]),
        active_segments: is_inverted.select(b.active_segments[1], b.active_segments[0]),
        held: is_inverted
            .select(b.free[1], b.free[0])
            .gt(is_inverted.select(b.loaded[1], b.loaded[0])),
    }
}
