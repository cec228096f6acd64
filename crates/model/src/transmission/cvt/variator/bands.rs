//! Heat where the bands slide on the segments and on each other.
//!
//! | label | statement | status |
//! |---|---|---|
//! | BT-1 | required band speeds differ by (d + (i-1) t)(w_p - w_s); the adopted speed is their mean, and half of it slides on each pulley | source: thesis eq. 8 to 21, App. C; the printed forms' |
//! | BT-2 | normal force of interface i: Q (1 - (i-1)/n) | source: thesis 8.4.2 |
//! | BT-3 | torque loss of a pulley, at the primary: f mu_b Q \|1/I - 1\|/2 (d + t (n-1)/2) | derived: closed sum of thesis eq. 48, 49 |
//! | BT-4 | f = min wrap / own wrap (App. C) or 1 (eq. 49) | source: the two disagree, see Formulation |
//! | BT-6 | torque loss by the one force of TE-7, at the primary, all of it on the smaller wrap: \|s\| mu_b Tm beta \|1/I - 1\| ((1-u_1) d + (1-u_t) t (n-1)/2), beta the smaller wrap | derived: moments about both pulleys, T_p - T_s/I = \|1/I - 1\| (d F_1 + t sum F_i) |
//! | BT-8 | friction at the innermost interface: k mu_b, k a factor for a coating of the shoulders; in BT-6 (1-u_1) d becomes k (1-u_1) d | derived: BT-6 with a friction of its own for F_1 |
//! | BT-7 | `smooth`: the bands slide on the pulley of smaller wrap alone, by dv_1 = \|1/I - 1\| d w_p, and run with the other one, x = -0.5 in BT-5 | derived: one force on both pulleys, and the larger wrap could hold more of it |
//! | BT-5 | travel on its neighbour in a belt revolution: d (L/2 (1/R_p + 1/R_s) - 2 pi) + x d L \|1/R_p - 1/R_s\|, t for d above band 1 | derived from thesis 8.3, App. C; x = 0 is the mean speed of the printed forms |
//! | FI-1 | film shear: F_v,i = u_i eta dv_i A/h_i at each interface by FH-1 at F_v,i dv_i, A = B L of the smaller wrap, dv_i of BT-7; torque at the primary \|s\| \|1/I - 1\| (F_v,1 d + F_v,t t (n-1)) | derived: thesis eq. 52 with one force on both pulleys and LU-5, FI-2 |
//!
//! Symbols: d offset of band 1 above the rocking edge m, t band thickness m, n bands, B width of both packs m, L contact arcs m; index 1 innermost interface, t each other one.
//! No loss at I = 1, exactly (thesis 8.3). Losses carry no sign of torque: they are positive in drive and overrun.

use super::{Belt, BeltAtRatio, BeltLoad, Geometry, Tension};
use crate::lubricant::{BandFriction, Friction};
use crate::math::{Mask, Real, both, physics};
use crate::transmission::viscous_self_heating::ViscousSelfHeating;

/// Friction-weighted sliding of the band pack on each pulley per turn of the primary, m: on both with the wrap factor (BT-2 to BT-4), or on
/// the smaller wrap alone, with the part of the one force that a `direction` of the tension step leaves (BT-6, BT-7).
#[physics]
pub fn slide_m<R: Real>(belt: &Belt<R>, g: &Geometry<R>, mean_offset_m: R, direction: R) -> [R; 2] {
    let slide = (g.inv_ratio - 1.0).abs() * mean_offset_m;
    if belt.formulation.by_statics() {
        return on_smaller_wrap(g, direction.abs() * slide);
    }
    let wraps = [g.primary_wrap_rad, g.secondary_wrap_rad];
    let least = wraps[0].min(wraps[1]);
    if belt.formulation.scales_band_force() {
        both!(i => 0.5 * slide * least / wraps[i]) // BT-4
    } else {
        [0.5 * slide; 2] // BT-4
    }
}

/// A value of the pulley of smaller wrap, where the bands slide, and nothing of the other (BT-7).
#[physics]
fn on_smaller_wrap<R: Real>(g: &Geometry<R>, value: R) -> [R; 2] {
    let (primary, none) = (
        g.secondary_wrap_rad.gt(g.primary_wrap_rad),
        value.splat(0.0),
    );
    [primary.select(value, none), primary.select(none, value)]
}

/// Offset of the bands above the rocking edge, weighted by their normal forces, m (BT-2).
#[physics]
pub fn mean_offset_m<R: Real>(belt: &Belt<R>) -> R {
    belt.band_offset_m + belt.band_thickness_m * (belt.band_count - 1.0) / 2.0
}

/// Part of the bands' sliding, weighted by friction, that is not at the innermost interface (BT-2).
#[physics]
pub fn outer_part<R: Real>(belt: &Belt<R>) -> R {
    let outer = belt.band_thickness_m * (belt.band_count - 1.0) / 2.0;
    let part = outer / mean_offset_m(belt);
    outer.gt(0.0).select(part, outer.splat(0.0))
}

/// Part of the bands' sliding that a coating of the shoulders takes away (BT-8).
#[physics]
pub fn coated_part<R: Real>(belt: &Belt<R>) -> R {
    (1.0 - belt.shoulder_friction) * (1.0 - outer_part(belt)) // BT-8
}

/// Contact area of a film, on the smaller wrap, m2 (FI-1).
#[physics]
pub fn film_area_m2<R: Real>(belt: &Belt<R>, g: &Geometry<R>) -> R {
    let arcs_m = [
        g.primary_radius_m * g.primary_wrap_rad,
        g.secondary_radius_m * g.secondary_wrap_rad,
    ];
    belt.band_width_m * arcs_m[0].min(arcs_m[1])
}

/// Levers of the films' forces, at the primary shaft, m: innermost interface, all others together (FI-1).
#[physics]
pub fn film_levers_m<R: Real>(belt: &Belt<R>, g: &Geometry<R>, direction: R) -> [R; 2] {
    let turns = direction.abs() * (g.inv_ratio - 1.0).abs();
    [
        turns * belt.band_offset_m,
        turns * belt.band_thickness_m * (belt.band_count - 1.0),
    ]
}

/// Forces of the films on the innermost interface and on each other one, N (FI-1, FH-1).
#[physics]
pub fn film_n<R: Real>(
    friction: &Friction<R>,
    band: &BandFriction<R>,
    area_m2: R,
    sliding_m_s: [R; 2],
) -> [R; 2] {
    let heating = ViscousSelfHeating::halving(friction.film_heating_w);
    both!(i => heating.torque_nm(band.shear_pa[i] * area_m2, sliding_m_s[i])) // FI-1
}

/// Adopted band speed of a formulation as `travel_m` takes it (BT-1, BT-7).
#[physics]
pub fn speed_share<R: Real>(belt: &Belt<R>) -> f64 {
    if belt.formulation.by_statics() {
        -0.5
    } else {
        0.0
    }
}

/// Travel of the innermost band and of each other band on what lies below it, m per belt revolution (BT-5).
///
/// `speed_share` is the adopted band speed: its distance from the mean of the two required speeds over their difference, 0 for the
/// mean, 0.5 for what the smaller pulley requires, -0.5 for the larger one's.
pub fn travel_m(belt: &Belt, g: &Geometry, speed_share: f64) -> [f64; 2] {
    let (p, s) = (1.0 / g.primary_radius_m, 1.0 / g.secondary_radius_m);
    let turns = belt.length_m / 2.0 * (p + s) - 2.0 * std::f64::consts::PI
        + speed_share * belt.length_m * (p - s).abs();
    [belt.band_offset_m * turns, belt.band_thickness_m * turns] // BT-5
}

/// Sliding speed at the innermost interface and at each other one where the bands slide, m/s (BT-1, BT-7).
#[physics]
pub fn sliding_speed_m_s<R: Real>(belt: &Belt<R>, ratio: R, primary_speed_rad_s: R) -> [R; 2] {
    let share = if belt.formulation.by_statics() {
        1.0 // BT-7
    } else {
        0.5 // BT-1
    };
    let turns = share * (1.0 / ratio - 1.0).abs();
    let steps = [belt.band_offset_m, belt.band_thickness_m];
    both!(i => turns * steps[i] * primary_speed_rad_s.abs())
}

/// Sliding speed at the innermost interface on primary and secondary, m/s (BT-1, BT-7).
pub fn pulley_sliding_m_s(belt: &Belt, g: &Geometry, primary_speed_rad_s: f64) -> [f64; 2] {
    let [inner, _] = sliding_speed_m_s(belt, g.ratio, primary_speed_rad_s);
    if belt.formulation.by_statics() {
        on_smaller_wrap(g, inner)
    } else {
        [inner; 2]
    }
}

/// Boundary friction loss of the bands on the arcs of primary and secondary, Nm at the primary shaft (BT-3, BT-6).
#[physics]
pub fn band_loss_nm<R: Real>(
    at: &BeltAtRatio<R>,
    t: &Tension<R>,
    band: &BandFriction<R>,
) -> [R; 2] {
    let shoulder_n = [t.primary_shoulder_n, t.secondary_shoulder_n];
    let [inner, outer] = band.film_share;
    let lifted = inner + (outer - inner) * at.fixed.outer_part;
    let coated = at.fixed.coated_part * (1.0 - inner);
    let mu = band.mu * (1.0 - lifted - coated); // BT-8
    both!(i => mu * shoulder_n[i] * at.prepared.slide_m[i]) // BT-3, BT-6
}

/// Viscous shear of the films, torque at the primary shaft, Nm (FI-1).
#[physics]
pub fn film_loss_nm<R: Real>(at: &BeltAtRatio<R>, load: &BeltLoad<R>) -> R {
    let [inner, outer] = at.prepared.film_levers_m;
    load.film_n[0] * inner + load.film_n[1] * outer // FI-1
}
