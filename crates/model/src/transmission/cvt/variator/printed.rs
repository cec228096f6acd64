//! The belt as printed, for verification: Appendix C with its repairs, and chapter 8 where its equations differ.
//!
//! Geometry, tension, bands and deflection are those of the other files; this file has the statements that driving smooths.
//!
//! | label | statement | status |
//! |---|---|---|
//! | PR-1 | s = -1 for I > 1, +1 for I < 1; undefined at I = 1 | source: App. C |
//! | PR-2 | k = max(1, ceil(C_x/(mu R' - dT'))) conventional, max(1, ceil(\|C_x\|/(mu R' + dT'))) inverted; none where the bracket is not above 0 | derived: closed form of App. C's loops |
//! | PR-3 | F_T = \|C_x\|/k +- dT' on an active segment, \|C_x\|/n +- dT' on the other pulley; slip shares are ratios of F_T/R' | source: thesis eq. 59 to 70, App. C |
//! | PR-4 | gross slip where k t >= own arc; the torque capacity (VA-2) is not asked | source: App. C, the idle arc vanishes |
//! | PR-5 | friction in wedging and penetration 0.13 | source: App. C |
//!
//! Contact area between segments: SL-3 without holding. Slip speeds are slip shares times belt speed: no slip at standstill is
//! defined, so speed must be above zero. Beyond PR-4 the numbers are those of the printed program and mean nothing.

use super::slip::{Contact, printed_area_m2};
use crate::math::larger;

/// Friction in wedging and penetration, whatever the segment friction is (PR-5).
pub(super) const FLANK_FRICTION: f64 = 0.13;

/// Direction of the tension step (PR-1).
pub(super) fn direction(ratio: f64) -> f64 {
    if ratio > 1.0 { -1.0 } else { 1.0 }
}

/// Slip of both pulleys with whole active segments; shares of belt speed, losses in Nm at the primary shaft.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PrintedSlip {
    pub gap: f64,
    pub idle: f64,
    /// Slip at primary and secondary.
    pub slip: [f64; 2],
    /// Loss at primary and secondary, Nm.
    pub loss_nm: [f64; 2],
    pub active_segments: f64,
    /// No idle arc is left (PR-4).
    pub gross: bool,
}

/// Slip as printed, or none where no number of segments carries the load (PR-2 to PR-4).
pub(super) fn slip(c: &Contact) -> Option<PrintedSlip> {
    let (belt, prepared, f) = (c.belt, &c.at.prepared, c.belt.formulation);
    let inverted = c.compression_n < 0.0;
    let (load, other, sign) = if inverted { (1, 0, -1.0) } else { (0, 1, 1.0) };
    let cx = c.compression_n.abs();
    let pitch = belt.segment_thickness_m;
    let shoulder = sign * c.shoulder_n[load];
    let grip = c.grip_n[load] - shoulder;
    if grip <= 0.0 {
        return None;
    }
    let whole = (cx / grip).ceil();
    let k = larger(whole, 1.0); // PR-2
    let (active, arc) = (k * pitch, prepared.arc_m[load]);
    let e_segs = cx
        * (prepared.strut_gap_m_n
            + 0.5 * (active + prepared.arc_m[other]) / (belt.youngs_pa * printed_area_m2(cx))); // SL-2
    let gap = (c.slack_m + e_segs) / (arc - active); // SL-5
    let pull = cx / k + shoulder; // PR-3
    let pull_other = cx / prepared.count[other] + sign * c.shoulder_n[other]; // PR-3
    let keeps_sign = inverted || f.signed_idle_slip();
    let idle_share = shoulder / pull;
    let other_share = pull_other / c.grip_n[other] / (pull / c.grip_n[load]);
    let idle = gap
        * if keeps_sign {
            idle_share
        } else {
            idle_share.abs()
        }; // SL-6
    let loaded = gap + idle;
    let slip_other = loaded
        * if keeps_sign {
            other_share
        } else {
            other_share.abs()
        }; // SL-6
    let r = c.at.geometry.primary_radius_m;
    let idle_loss = if f.counts_idle_arc() {
        (idle * shoulder * (prepared.count[load] - k)).abs()
    } else {
        0.0
    };
    let mut loss_nm = [0.0; 2];
    loss_nm[load] = r * ((loaded * pull * k).abs() + idle_loss); // SL-7
    loss_nm[other] = r * (slip_other * pull_other * prepared.count[other]).abs(); // SL-7
    let slip = match (inverted, f.flips_inverted_primary()) {
        (false, _) => [loaded, slip_other],
        (true, true) => [slip_other, -loaded],
        (true, false) => [-slip_other, -loaded],
    };
    Some(PrintedSlip {
        gap,
        idle,
        slip,
        loss_nm,
        active_segments: k,
        gross: active >= arc,
    })
}
