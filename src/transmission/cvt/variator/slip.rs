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
//! | SL-9 | each pulley's slip is held at +-`slip_bound` | ASSUMED: beyond it gross slip, flagged |
//!
//! Slip is a fraction of belt speed, positive when the output turns slower than the geometric ratio says; independent of speed, so
//! defined at standstill.

use super::{Belt, Formulation, Geometry, Tension};

/// Slip and its loss.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Slip {
    /// Slip at the primary over belt speed.
    pub primary: f64,
    /// Slip at the secondary over belt speed.
    pub secondary: f64,
    /// Torque loss at the primary, referred to the primary shaft, Nm.
    pub primary_loss_nm: f64,
    /// Torque loss at the secondary, referred to the primary shaft, Nm.
    pub secondary_loss_nm: f64,
    /// Segments in the active arc of the branch in force.
    pub active_segments: f64,
    /// Whether the bound of SL-9 holds the slip.
    pub held: bool,
}

/// Forces per segment on both pulleys, N.
struct PerSegment {
    /// Resultant normal force (both flanks), primary and secondary.
    normal: [f64; 2],
    /// Band friction on the shoulder, primary and secondary, with the sign of dT.
    shoulder: [f64; 2],
    /// Segments in the wraps.
    count: [f64; 2],
}

#[inline]
fn per_segment(belt: &Belt, g: &Geometry, t: &Tension) -> PerSegment {
    let pitch = belt.segment_thickness_m;
    let least = if g.primary_wrap_rad < g.secondary_wrap_rad { g.primary_wrap_rad } else { g.secondary_wrap_rad };
    let one = |clamp: f64, radius: f64, wrap: f64| {
        let count = radius * wrap / pitch;
        (2.0 * clamp / (count * belt.cos_wedge), t.step_n * pitch / (radius * least), count)
    };
    let p = one(t.primary_clamp_n, g.primary_radius_m, g.primary_wrap_rad);
    let s = one(t.secondary_clamp_n, g.secondary_radius_m, g.secondary_wrap_rad);
    PerSegment { normal: [p.0, s.0], shoulder: [p.1, s.1], count: [p.2, s.2] }
}

/// Contact area between segments in an arc, m2 (SL-3).
#[inline]
fn arc_area_m2(compression_n: f64) -> f64 {
    let c = compression_n.abs();
    let c = if c < 4492.0 { c } else { 4492.0 };
    1.74142e-6 + 1.56364e-9 * c - 1.74032e-13 * c * c // SL-3
}

/// What the slip equations of both branches look at.
#[derive(Clone, Copy)]
struct Contact<'a> {
    belt: &'a Belt,
    f: Formulation,
    g: &'a Geometry,
    t: &'a Tension,
    seg: &'a PerSegment,
    mu: f64,
    compression_n: f64,
}

/// One loading branch: `load` is the pulley where segments are loaded (0 primary, 1 secondary).
#[inline]
fn branch(c: &Contact, load: usize) -> Slip {
    let Contact { belt, f, g, t, seg, mu, compression_n } = *c;
    let inverted = load == 1;
    let other = 1 - load;
    let cx = if inverted { -compression_n } else { compression_n };
    let cx = if cx > 0.0 { cx } else { 0.0 };
    let sign = if inverted { -1.0 } else { 1.0 };
    let pitch = belt.segment_thickness_m;
    let arc = [seg.count[0] * pitch, seg.count[1] * pitch];
    let grip = mu * seg.normal[load] - sign * seg.shoulder[load];
    let floor = 0.05 * mu * seg.normal[load];
    let grip = if grip > floor { grip } else { floor };
    let k = cx / grip; // SL-4
    let active = if k * pitch < arc[load] { k * pitch } else { arc[load] };
    let e_band = t.mean_tension_n(g) * belt.length_m / (belt.youngs_pa * belt.band_area_m2()); // SL-1
    let e_segs = cx / belt.youngs_pa
        * (g.strut_m / belt.strut_area_m2 + 0.5 * (active + arc[other]) / arc_area_m2(cx)); // SL-2
    let idle = arc[load] - active;
    let gap = (e_band + e_segs + belt.initial_gap_m) / (idle + 1e-9); // SL-5
    let shoulder = sign * seg.shoulder[load];
    let lambda_idle = shoulder / (mu * seg.normal[load]);
    let idle_slip = gap * if inverted || f.signed_idle_slip() { lambda_idle } else { lambda_idle.abs() }; // SL-6
    let bound = belt.slip_bound;
    let loaded = gap + idle_slip;
    let held = loaded > bound;
    let loaded = if held { bound } else { loaded };
    let tract_other = cx / seg.count[other] + sign * seg.shoulder[other];
    let lambda_other = tract_other / (mu * seg.normal[other]);
    let r = g.primary_radius_m;
    let force_other = tract_other.abs() * seg.count[other];
    let idle_part = if f.counts_idle_arc() && !held { idle_slip.abs() * shoulder.abs() * idle / pitch } else { 0.0 };
    let loss_load = loaded.abs() * r * (mu * seg.normal[load] * active / pitch) + idle_part * r; // SL-7
    let slip_other = clamp_abs(loaded * lambda_other.abs() , bound);
    let loss_other = slip_other.abs() * r * force_other; // SL-7
    if inverted {
        let signed = clamp_abs(loaded * lambda_other, bound);
        let primary = if f.flips_inverted_primary() { signed } else { -signed }; // SL-6
        Slip { primary, secondary: -loaded, primary_loss_nm: loss_other, secondary_loss_nm: loss_load, active_segments: k, held }
    } else {
        Slip { primary: loaded, secondary: slip_other, primary_loss_nm: loss_load, secondary_loss_nm: loss_other, active_segments: k, held }
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
#[inline]
pub fn slip(belt: &Belt, f: Formulation, g: &Geometry, t: &Tension, mu_segment: f64) -> Slip {
    let seg = &per_segment(belt, g, t);
    let compression_n = f.compression_n(t.compression_n);
    let contact = Contact { belt, f, g, t, seg, mu: mu_segment, compression_n };
    let x = compression_n / belt.blend_n;
    if x > 20.0 {
        return branch(&contact, 0);
    }
    if x < -20.0 {
        return branch(&contact, 1);
    }
    let a = branch(&contact, 0);
    let b = branch(&contact, 1);
    let w = 1.0 / (1.0 + (-2.0 * x).exp()); // SL-8: (1 + tanh x)/2
    let mix = |p: f64, q: f64| w * p + (1.0 - w) * q;
    Slip {
        primary: mix(a.primary, b.primary),
        secondary: mix(a.secondary, b.secondary),
        primary_loss_nm: mix(a.primary_loss_nm, b.primary_loss_nm),
        secondary_loss_nm: mix(a.secondary_loss_nm, b.secondary_loss_nm),
        active_segments: if x >= 0.0 { a.active_segments } else { b.active_segments },
        held: a.held || b.held,
    }
}
