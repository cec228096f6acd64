//! Heat where the bands slide on the segments and on each other.
//!
//! | label | statement | status |
//! |---|---|---|
//! | BT-1 | required band speeds differ by (d + (i-1) t)(w_p - w_s); the adopted speed is their mean | source: thesis eq. 8 to 21, App. C |
//! | BT-2 | normal force of interface i: Q (1 - (i-1)/n) | source: thesis 8.4.2 |
//! | BT-3 | torque loss of a pulley, at the primary: f mu_b Q \|1/I - 1\|/2 (d + t (n-1)/2) | derived: closed sum of thesis eq. 48, 49 |
//! | BT-4 | f = min wrap / own wrap (App. C) or 1 (eq. 49) | source: the two disagree, see Formulation |
//! | BT-6 | torque loss by the one force of TE-7, at the primary: \|s\| mu_b Tm beta \|1/I - 1\| (d + t (n-1)/2), beta the smaller wrap, half of it on each pulley | derived: moments about both pulleys, T_p - T_s/I = \|1/I - 1\| (d F_1 + t sum F_i) |
//! | BT-5 | travel on its neighbour in a belt revolution: d (L/2 (1/R_p + 1/R_s) - 2 pi) + x d L \|1/R_p - 1/R_s\|, t for d above band 1 | derived from thesis 8.3, App. C; x = 0 is the mean speed |
//! | FI-1 | film shear, at the primary: share eta B (L_p + L_s) sum dv_i2 / (h w_in) | source: thesis eq. 52; share and h ASSUMED |
//!
//! Symbols: d offset of band 1 above the rocking edge m, t band thickness m, n bands, B width of both packs m, L contact arcs m, h film m.
//! No loss at I = 1, exactly (thesis 8.3). Losses carry no sign of torque: they are positive in drive and overrun.

use super::{Belt, BeltAtRatio, BeltLoad, Geometry, Tension};
use crate::math::{pair, smaller};

/// Friction-weighted sliding of the band pack per turn of the primary, times the wrap factor of each pulley, m (BT-2 to BT-4); with one
/// force on both pulleys also times the part of that force that a `direction` of the tension step leaves (BT-6).
pub fn slide_m(belt: &Belt, g: &Geometry, direction: f64) -> [f64; 2] {
    let n = belt.band_count;
    let slide = (1.0 / g.ratio - 1.0).abs() / 2.0
        * (belt.band_offset_m + belt.band_thickness_m * (n - 1.0) / 2.0);
    let wraps = [g.primary_wrap_rad, g.secondary_wrap_rad];
    let least = smaller(wraps[0], wraps[1]);
    let slide = if belt.formulation.by_statics() {
        direction.abs() * slide // BT-6
    } else {
        slide
    };
    wraps.map(|w| {
        if belt.formulation.scales_band_force() {
            slide * least / w
        } else {
            slide
        }
    }) // BT-4
}

/// Film shear torque per share, viscosity and speed over film thickness, m4 (FI-1).
pub fn film_m4(belt: &Belt, g: &Geometry) -> f64 {
    let arcs =
        g.primary_radius_m * g.primary_wrap_rad + g.secondary_radius_m * g.secondary_wrap_rad;
    let spread = (1.0 / g.ratio - 1.0) / 2.0;
    let offsets = belt.band_offset_m * belt.band_offset_m
        + (belt.band_count - 1.0) * belt.band_thickness_m * belt.band_thickness_m;
    belt.band_width_m * arcs * spread * spread * offsets
}

/// Travel of the innermost band and of each other band on what lies below it, m per belt revolution (BT-5).
///
/// `speed_share` is the adopted band speed: its distance from the mean of the two required speeds over their difference, 0 for the
/// mean, 0.5 for what the smaller pulley requires, -0.5 for the larger one's (thesis 8.3: within a few per cent of the mean).
pub fn travel_m(belt: &Belt, g: &Geometry, speed_share: f64) -> [f64; 2] {
    let (p, s) = (1.0 / g.primary_radius_m, 1.0 / g.secondary_radius_m);
    let turns = belt.length_m / 2.0 * (p + s) - 2.0 * std::f64::consts::PI
        + speed_share * belt.length_m * (p - s).abs();
    [belt.band_offset_m * turns, belt.band_thickness_m * turns] // BT-5
}

/// Sliding speed of the innermost band in each arc, m/s (BT-1).
#[inline]
pub fn sliding_speed_m_s(belt: &Belt, ratio: f64, primary_speed_rad_s: f64) -> f64 {
    (1.0 / ratio - 1.0).abs() / 2.0 * belt.band_offset_m * primary_speed_rad_s.abs() // BT-1
}

/// Boundary friction loss of the bands on the arcs of primary and secondary, Nm at the primary shaft (BT-3).
#[inline]
pub fn band_loss_nm(at: &BeltAtRatio, t: &Tension, mu_band: f64) -> [f64; 2] {
    let shoulder_n = [t.primary_shoulder_n, t.secondary_shoulder_n];
    pair(|i| mu_band * shoulder_n[i] * at.prepared.slide_m[i]) // BT-3
}

/// Viscous shear of the carrying film, torque at the primary shaft, Nm (FI-1).
#[inline]
pub fn film_loss_nm(at: &BeltAtRatio, load: &BeltLoad) -> f64 {
    let speed = load.primary_speed_rad_s.abs();
    load.band.film_share * load.eta_pa_s * at.prepared.film_m4 / load.film_thickness_m * speed // FI-1
}
