//! The belt at one ratio: what every operating point there has in common.

use super::{Belt, Geometry, bands, deflection};
use crate::math::{Gather, Real, both, physics, ramp};

/// The belt at one ratio: everything that does not depend on torque or pressure.
#[derive(Clone, Copy, Debug, Gather, PartialEq)]
pub struct BeltAtRatio<R: Real = f64> {
    /// Geometry.
    pub geometry: Geometry<R>,
    /// Direction of the tension step, -1 in low, +1 in high (TE-6).
    pub direction: R,
    /// Primary clamp over secondary clamp (TE-1).
    pub thrust_ratio: R,
    /// Constants of the loss equations at any ratio.
    pub fixed: Fixed<R>,
    /// Constants of the loss equations at this ratio.
    pub prepared: Prepared<R>,
}

/// Coefficients of a belt at every ratio, so that a new one costs few divisions.
#[derive(Clone, Copy, Debug, Gather, PartialEq)]
pub struct Fixed<R: Real = f64> {
    /// One over the segments' thickness, 1/m.
    pub inv_pitch: R,
    /// Resultant normal force of all segments of a wrap over the clamping force.
    pub normal_per_clamp: R,
    /// Extension of the band pack per force and length of the belt over that on the primary's wrap, m/N (SL-1).
    pub band_gap_m_n: R,
    /// Compression of a strut per force and length, 1/N (SL-2).
    pub strut_per_n: R,
    /// Mean offset of the bands above the rocking edge, weighted by friction, m (BT-2).
    pub mean_offset_m: R,
    /// Part of the bands' sliding that is not at the innermost interface, from 0 to 1.
    pub outer_part: R,
    /// Part of it that a coating of the shoulders takes away; 0 without one (BT-8).
    pub coated_part: R,
    /// Half the cotangent of the angle in the wedge terms (WE-2).
    pub wedge_half_cot: R,
    /// Arcs over twice the segment thickness, 1/m (WE-3).
    pub wedge_per_m: R,
    /// Penetration torque per friction force, deflection and radius of the primary, 1/m (PE-1).
    pub penetration_per_m: R,
    /// One over the width of the smoothing of the tension step in ln I (TE-6).
    pub inv_unity_width: R,
    /// One over the width of the blend between the loading branches, 1/N.
    pub per_blend_n: R,
}

/// Coefficients of one ratio, so that an operating point costs few divisions; pairs are primary, secondary.
#[derive(Clone, Copy, Debug, Gather, PartialEq)]
pub struct Prepared<R: Real = f64> {
    /// Contact arcs, m.
    pub arc_m: [R; 2],
    /// Segments in the wraps.
    pub count: [R; 2],
    /// Resultant normal force of a segment per clamping force.
    pub normal_per_clamp: [R; 2],
    /// Shoulder friction of a segment per tension step.
    pub shoulder_per_step: [R; 2],
    /// Extension of the band pack per shoulder force of the primary, m/N (SL-1).
    pub band_gap_m_n: R,
    /// Compression of the free strut per force, m/N (SL-2).
    pub strut_gap_m_n: R,
    /// Friction-weighted sliding of the band pack per turn of the primary, m/rad (BT-3, BT-6).
    pub slide_m: [R; 2],
    /// Smaller wrap times the friction factor of the shoulders, rad (TE-7, BT-8).
    pub shoulder_rad: R,
    /// Contact area of a film, m2 (FI-1).
    pub film_area_m2: R,
    /// Levers of the films' forces, innermost interface and all others, m (FI-1).
    pub film_levers_m: [R; 2],
    /// Share of the primary's deflection left by its end stop (WE-4).
    pub stop: R,
    /// Arcs over twice the segment thickness, referred to the primary shaft, 1/m (WE-3).
    pub wedge_per_m: [R; 2],
    /// Penetration torque per friction force and deflection (PE-1).
    pub penetration: R,
    /// One over the segments in the wraps.
    pub inv_segments: [R; 2],
    /// One over the secondary radius, 1/m.
    pub inv_secondary_radius: R,
    /// Sum of both clamping forces over their wraps per clamping force of the secondary, 1/rad (TE-7).
    pub clamps_per_wrap: R,
    /// Torque capacity per clamping force and friction, m (VA-2, VA-4).
    pub capacity_m: R,
}

#[physics]
impl<R: Real> Fixed<R> {
    #[inline]
    fn new(belt: &Belt<R>) -> Self {
        let inv_pitch = 1.0 / belt.segment_thickness_m;
        let (band_gap_m_n, strut_per_n) = match belt.chain {
            Some(_) => (inv_pitch.splat(0.0), inv_pitch.splat(0.0)),
            None => (
                belt.length_m / (belt.youngs_pa * belt.band_area_m2()),
                1.0 / (belt.youngs_pa * belt.strut_area_m2),
            ),
        };
        Fixed {
            inv_pitch,
            normal_per_clamp: 2.0 / belt.cos_wedge,
            band_gap_m_n,
            strut_per_n,
            mean_offset_m: bands::mean_offset_m(belt),
            outer_part: bands::outer_part(belt),
            coated_part: bands::coated_part(belt),
            wedge_half_cot: 0.5 / belt.formulation.wedge_tan(belt.tan_wedge),
            wedge_per_m: (belt.formulation.wedge_arcs() * inv_pitch) * 0.5, // WE-3
            penetration_per_m: deflection::penetration_per_m(belt, inv_pitch),
            inv_unity_width: 1.0 / belt.unity_width,
            per_blend_n: 1.0 / belt.blend_n,
        }
    }
}

#[physics]
impl<R: Real> Prepared<R> {
    fn new(
        belt: &Belt<R>,
        fixed: &Fixed<R>,
        g: &Geometry<R>,
        (direction, thrust_ratio): (R, R),
    ) -> Self {
        let pitch = belt.segment_thickness_m;
        let arc_m = [
            g.primary_radius_m * g.primary_wrap_rad,
            g.secondary_radius_m * g.secondary_wrap_rad,
        ];
        let inv_secondary_radius = 1.0 / g.secondary_radius_m;
        let inv_radius = [g.ratio * inv_secondary_radius, inv_secondary_radius]; // GE-1
        let inv_wrap = [1.0 / g.primary_wrap_rad, 1.0 / g.secondary_wrap_rad];
        let inv_segments = both!(i => pitch * (inv_radius[i] * inv_wrap[i]));
        let least = g.primary_wrap_rad.min(g.secondary_wrap_rad);
        let inv_least = inv_wrap[0].max(inv_wrap[1]);
        Prepared {
            arc_m,
            count: both!(i => arc_m[i] * fixed.inv_pitch),
            normal_per_clamp: both!(i => fixed.normal_per_clamp * inv_segments[i]),
            shoulder_per_step: both!(i => pitch * (inv_radius[i] * inv_least)),
            band_gap_m_n: fixed.band_gap_m_n * inv_wrap[0],
            strut_gap_m_n: g.strut_m * fixed.strut_per_n,
            slide_m: bands::slide_m(belt, g, fixed.mean_offset_m, direction),
            shoulder_rad: least * belt.shoulder_friction, // BT-8
            film_area_m2: bands::film_area_m2(belt, g),
            film_levers_m: bands::film_levers_m(belt, g, direction),
            stop: belt
                .formulation
                .primary_stop(1.0 - ramp(g.ratio, belt.stop_from_ratio, belt.stop_to_ratio)), // WE-4
            wedge_per_m: [fixed.wedge_per_m, fixed.wedge_per_m * g.inv_ratio], // WE-3
            penetration: fixed.penetration_per_m * g.primary_radius_m,         // PE-1
            inv_segments,
            inv_secondary_radius,
            clamps_per_wrap: thrust_ratio * inv_wrap[0] + inv_wrap[1],
            capacity_m: fixed.normal_per_clamp * g.secondary_radius_m,
        }
    }
}

#[physics]
impl<R: Real> BeltAtRatio<R> {
    /// Prepares a ratio.
    #[inline]
    pub fn new(belt: &Belt<R>, ratio: R) -> Self {
        ratio.vectorize(|| Self::prepare(belt, Fixed::new(belt), ratio))
    }

    /// Takes the belt, which is the same, to another ratio.
    pub fn move_to(&mut self, belt: &Belt<R>, ratio: R) {
        *self = Self::prepare(belt, self.fixed, ratio);
    }

    fn prepare(belt: &Belt<R>, fixed: Fixed<R>, ratio: R) -> Self {
        let geometry = Geometry::new(ratio, belt.centre_distance_m, belt.length_m);
        let log = ratio.ln();
        let direction = -(log * fixed.inv_unity_width).tanh(); // TE-6
        let thrust_ratio = match &belt.thrust_ratio {
            Some(curve) => log.interpolate(curve),
            None => geometry.primary_wrap_rad / geometry.secondary_wrap_rad, // TE-1
        };
        BeltAtRatio {
            geometry,
            prepared: Prepared::new(belt, &fixed, &geometry, (direction, thrust_ratio)),
            direction,
            thrust_ratio,
            fixed,
        }
    }
}
