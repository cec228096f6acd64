//! Load of the belt: speed, torque, clamping force and the friction of its lubricant.

use super::{Belt, Geometry, bands};
use crate::lubricant::{BandFriction, ElementFriction, Friction, Lubricant};
use crate::math::{Mask, Real, physics};

/// Load of the belt at one operating point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeltLoad<R: Real = f64> {
    /// Primary speed, rad/s.
    pub primary_speed_rad_s: R,
    /// Torque at the secondary pulley, Nm; negative in overrun.
    pub output_torque_nm: R,
    /// Axial clamping force of the secondary, N.
    pub secondary_clamp_n: R,
    /// Band friction in force.
    pub band: BandFriction<R>,
    /// Force of the film at the innermost interface and at each other one, N (FI-1).
    pub film_n: [R; 2],
    /// Segment friction of the fluid.
    pub segment_friction: R,
    /// Friction of macro slip of the fluid.
    pub capacity_friction: R,
    /// Flank friction of the fluid.
    pub flank_friction: R,
}

#[physics]
impl<R: Real> BeltLoad<R> {
    /// The lubricated belt without speed, torque and clamping force, for a band friction in a contact area, m2, that slides at speeds, m/s.
    pub fn unloaded(
        friction: &Friction<R>,
        band: BandFriction<R>,
        film_area_m2: R,
        sliding_m_s: [R; 2],
    ) -> Self {
        let none = film_area_m2.splat(0.0);
        BeltLoad {
            primary_speed_rad_s: none,
            output_torque_nm: none,
            secondary_clamp_n: none,
            band,
            film_n: bands::film_n(friction, &band, film_area_m2, sliding_m_s),
            segment_friction: friction.segment,
            capacity_friction: friction.capacity,
            flank_friction: friction.flank,
        }
    }
}

#[physics]
impl<R: Real> BeltLoad<R> {
    /// The same with the friction of elements on pulleys at its state.
    pub fn with_elements(self, elements: ElementFriction<R>) -> Self {
        BeltLoad {
            segment_friction: elements.segment,
            capacity_friction: elements.capacity,
            ..self
        }
    }

    /// `yes` where the mask says so, else `no`: loads of the same fluid.
    pub(in crate::transmission::cvt) fn select(mask: R::Mask, yes: &Self, no: &Self) -> Self {
        let of = |yes: R, no: R| mask.select(yes, no);
        let pair = |yes: [R; 2], no: [R; 2]| [of(yes[0], no[0]), of(yes[1], no[1])];
        BeltLoad {
            primary_speed_rad_s: of(yes.primary_speed_rad_s, no.primary_speed_rad_s),
            output_torque_nm: of(yes.output_torque_nm, no.output_torque_nm),
            secondary_clamp_n: of(yes.secondary_clamp_n, no.secondary_clamp_n),
            band: BandFriction {
                mu: of(yes.band.mu, no.band.mu),
                film_share: pair(yes.band.film_share, no.band.film_share),
                shear_pa: pair(yes.band.shear_pa, no.band.shear_pa),
            },
            film_n: pair(yes.film_n, no.film_n),
            segment_friction: of(yes.segment_friction, no.segment_friction),
            capacity_friction: of(yes.capacity_friction, no.capacity_friction),
            ..*yes
        }
    }
}

impl BeltLoad {
    /// The lubricated belt at a temperature, K, that turns at a ratio and primary speed, without torque and clamping force.
    pub fn turning(
        belt: &Belt,
        oil: &Lubricant,
        belt_k: f64,
        ratio: f64,
        primary_rad_s: f64,
    ) -> Self {
        let geometry = Geometry::new(ratio, belt.centre_distance_m, belt.length_m);
        let film_area_m2 = bands::film_area_m2(belt, &geometry);
        let at = (film_area_m2, geometry.primary_radius_m);
        BeltLoad::turning_on(belt, at, oil, belt_k, (ratio, primary_rad_s))
    }

    /// The same with the area of its films, m2, and the radius of the primary, m, known, at a ratio and primary speed.
    pub(crate) fn turning_on(
        belt: &Belt,
        (film_area_m2, primary_radius_m): (f64, f64),
        oil: &Lubricant,
        belt_k: f64,
        (ratio, primary_rad_s): (f64, f64),
    ) -> Self {
        let friction = &oil.friction;
        let sliding = belt.sliding_m_s(ratio, primary_rad_s);
        let eta_pa_s = oil.dynamic_pa_s(belt_k);
        let band = friction.band(belt_k, eta_pa_s, sliding);
        let elements = friction.elements(belt_k, eta_pa_s, primary_radius_m * primary_rad_s.abs());
        BeltLoad {
            primary_speed_rad_s: primary_rad_s,
            ..BeltLoad::unloaded(friction, band, film_area_m2, sliding).with_elements(elements)
        }
    }
}
