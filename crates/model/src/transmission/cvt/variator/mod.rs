//! The pushing metal V-belt, or the chain, between its two pulleys: from output torque to input torque, loss by loss.
//!
//! | label | statement | status |
//! |---|---|---|
//! | VA-1 | T_in = (T_out/I)(1 - slip) + band + film + slip loss + wedge + penetration; of a chain joints and pin ends in place of band and film (KC-3, KC-4) | derived: energy with w_sec = w_pri (1 - slip)/I; the printed sum counts slip power twice |
//! | VA-2 | T_cap = 2 mu_seg R_s min(F_p, F_s) / cos th | source: Coulomb limit on both pulleys; the thesis checks the primary only; the printed forms' |
//! | VA-4 | driving: VA-2 with mu_cap, the friction of macro slip | ASSUMED mu_cap, 0.08 to 0.10: below the friction at which micro slip is measured |
//! | VA-3 | F_s = p A_s + spring + (1 - compensated) pi rho w2 (r_o4 - r_i4)/4 | source: App. C; centrifugal head from hydrostatics |
//!
//! Valid for clamping forces from zero on; torque above VA-4 is flagged `gross_slip` and slip is bounded (SL-9).

mod at_ratio;
mod bands;
mod chain;
mod deflection;
mod formulation;
mod geometry;
mod keys;
mod load;
mod slip;
mod tension;
mod printed;
pub mod point;

pub use at_ratio::{BeltAtRatio, Prepared};
pub use bands::{film_area_m2, pulley_sliding_m_s, sliding_speed_m_s, speed_share};
pub use chain::{CHAIN, Chain, ChainKeys};
pub use deflection::Deflection;
pub use formulation::Formulation;
pub use geometry::Geometry;
pub use keys::{BELT, BeltKeys, VARIATOR, VariatorKeys};
pub use load::BeltLoad;
pub use point::{BeltPoint, belt_point, driving_point};
pub use slip::Slip;
pub use tension::Tension;

use crate::math::{Gather, Mask, Real, physics};
use crate::transmission::component::{ByComponent, Component};
use crate::transmission::loss_factor::LossFactors;

/// The checked belt and pulleys.
#[derive(Clone, Debug, Gather, PartialEq)]
pub struct Belt<R: Real = f64> {
    /// Centre distance of the pulleys, m.
    pub centre_distance_m: R,
    /// Length of the belt, m.
    pub length_m: R,
    /// Thickness of a segment, m.
    pub segment_thickness_m: R,
    /// Half wedge angle: cosine.
    pub cos_wedge: R,
    /// Half wedge angle: tangent.
    pub tan_wedge: R,
    /// Bands in a pack.
    pub band_count: R,
    /// Thickness of a band, m.
    pub band_thickness_m: R,
    /// Width of both packs, m.
    pub band_width_m: R,
    /// Offset of the innermost band above the rocking edge, m.
    pub band_offset_m: R,
    /// Friction between shoulders and innermost band over that between bands (BT-8).
    pub shoulder_friction: R,
    /// Mass per length, kg/m.
    pub mass_kg_m: R,
    /// Part of it in the bands, kg/m.
    pub band_mass_kg_m: R,
    /// Young's modulus of bands and segments, Pa.
    pub youngs_pa: R,
    /// Contact area between segments in the free strut, m2.
    pub strut_area_m2: R,
    /// Gap between all segments at no load, m.
    pub initial_gap_m: R,
    /// Axial deflection of the primary per radius and force, 1/N.
    pub primary_compliance_per_n: R,
    /// Axial deflection of the secondary per radius and force, 1/N.
    pub secondary_compliance_per_n: R,
    /// Ratio from which the primary leans on its end stop.
    pub stop_from_ratio: R,
    /// Ratio at which it rests on it fully.
    pub stop_to_ratio: R,
    /// Width of the smoothing of the tension step in ln I.
    pub unity_width: R,
    /// Force width of the blend between the loading branches, N.
    pub blend_n: R,
    /// Bound of each pulley's slip.
    pub slip_bound: R,
    /// Thrust ratio F_p/F_s over ln I, or none for the wrap ratio.
    pub thrust_ratio: Option<R::Curve>,
    /// Joints and pins of a chain, which has no bands and segments.
    pub chain: Option<Chain<R>>,
    /// Reading of the thesis.
    #[gather(same)]
    pub formulation: Formulation,
}

#[physics]
impl<R: Real> Belt<R> {
    /// Cross-section of both band packs, m2.
    pub fn band_area_m2(&self) -> R {
        self.band_count * self.band_width_m * self.band_thickness_m
    }

    /// Mass per length that presses on the bands, and that of the bands where they carry themselves, kg/m (TE-8).
    pub fn masses_kg_m(&self) -> [R; 2] {
        let bands = if self.formulation.by_statics() {
            self.band_mass_kg_m
        } else {
            self.mass_kg_m.splat(0.0)
        };
        [self.mass_kg_m - bands, bands] // TE-8
    }

    /// Sliding speeds that can carry a film, at the innermost interface and at each other one, m/s; 0 for formulations without a film.
    pub fn sliding_m_s(&self, ratio: R, primary_rad_s: R) -> [R; 2] {
        if self.formulation.has_film() && self.chain.is_none() {
            sliding_speed_m_s(self, ratio, primary_rad_s)
        } else {
            [ratio.splat(0.0); 2]
        }
    }
}

/// The belt's answer: its losses and what they follow from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeltState<R: Real = f64> {
    /// Torque at the primary pulley, Nm (VA-1).
    pub input_torque_nm: R,
    /// Tensions and forces.
    pub tension: Tension<R>,
    /// Slip in detail.
    pub slip: Slip<R>,
    /// Boundary friction of the bands before slip relieves them, Nm at the primary shaft (BT-3, BT-6).
    pub band_nm: R,
    /// Shear of the film before slip relieves it, Nm at the primary shaft (FI-1).
    pub film_nm: R,
    /// Losses, total slip and capacity.
    pub losses: BeltLosses<R>,
}

/// Losses of the belt as torques at the primary shaft, Nm, never negative.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BeltLosses<R: Real = f64> {
    /// Boundary friction of the bands.
    pub band_nm: R,
    /// Shear of the film.
    pub film_nm: R,
    /// Joints of a chain.
    pub joint_nm: R,
    /// Pin ends of a chain.
    pub pin_nm: R,
    /// Sliding of segments on pulleys.
    pub slip_nm: R,
    /// Wedging.
    pub wedge_nm: R,
    /// Penetration.
    pub penetration_nm: R,
    /// Total slip as a fraction.
    pub slip_total: R,
    /// Torque capacity at the secondary, Nm (VA-2).
    pub capacity_nm: R,
    /// Force of the primary that holds the ratio, N (TE-9).
    pub holding_n: R,
    /// Torque above capacity, or slip at its bound.
    pub gross_slip: R::Mask,
}

#[physics]
impl<R: Real> BeltLosses<R> {
    /// All belt losses, Nm at the primary shaft.
    pub fn sum_nm(&self) -> R {
        self.band_nm
            + self.film_nm
            + self.slip_nm
            + self.wedge_nm
            + self.penetration_nm
            + (self.joint_nm + self.pin_nm)
    }
}

/// Most total slip that a factor leads to (CV-7): that of the largest allowed bound of both pulleys (SL-9). At 1 no speed belongs to it (CV-1).
const MAX_SLIP: f64 = 0.8;

#[physics]
impl<R: Real> BeltLosses<R> {
    /// The factor on slip, as far as its bound allows (CV-7).
    fn slip_factor(&self, factor: &ByComponent<R>) -> R {
        let most = MAX_SLIP / self.slip_total.abs();
        most.min(factor[Component::BeltSlip])
    }

    /// Each loss times its factor, slip with the loss that it makes (CV-7).
    pub fn times(self, factor: &ByComponent<R>) -> Self {
        let slips = self.slip_factor(factor);
        BeltLosses {
            band_nm: factor[Component::BeltBand] * self.band_nm,
            film_nm: factor[Component::BeltFilm] * self.film_nm,
            joint_nm: factor[Component::ChainJoint] * self.joint_nm,
            pin_nm: factor[Component::ChainPin] * self.pin_nm,
            slip_nm: slips * self.slip_nm,
            wedge_nm: factor[Component::BeltWedge] * self.wedge_nm,
            penetration_nm: factor[Component::BeltPenetration] * self.penetration_nm,
            slip_total: slips * self.slip_total,
            ..self
        } // CV-7
    }
}

impl BeltState {
    /// Each loss times its factor, under an output torque, Nm, at a ratio (CV-7, VA-1).
    pub fn times(self, factor: &LossFactors, output_nm: f64, ratio: f64) -> Self {
        let losses = self.losses.times(factor);
        let slips = self.losses.slip_factor(factor);
        // Parts of a printed sum other than VA-1 stay as they are.
        let own_nm = |l: &BeltLosses| output_nm / ratio * (1.0 - l.slip_total) + l.sum_nm(); // VA-1
        BeltState {
            input_torque_nm: self.input_torque_nm + own_nm(&losses) - own_nm(&self.losses),
            slip: Slip {
                primary: slips * self.slip.primary,
                secondary: slips * self.slip.secondary,
                gap: slips * self.slip.gap,
                idle: slips * self.slip.idle,
                primary_loss_nm: slips * self.slip.primary_loss_nm,
                secondary_loss_nm: slips * self.slip.secondary_loss_nm,
                ..self.slip
            },
            band_nm: factor[Component::BeltBand] * self.band_nm,
            film_nm: factor[Component::BeltFilm] * self.film_nm,
            losses,
            ..self
        }
    }
}

/// Torque capacity at the secondary, Nm, for the clamping forces of both pulleys and a friction (VA-2, VA-4).
#[physics]
fn capacity_nm<R: Real>(at: &BeltAtRatio<R>, tension: &Tension<R>, friction: R) -> R {
    let weaker = tension.primary_clamp_n.min(tension.secondary_clamp_n);
    weaker * friction * at.prepared.capacity_m // VA-2, VA-4
}

/// Everything that the equations give at one operating point, pulley by pulley.
struct Parts<R: Real> {
    tension: Tension<R>,
    slip: Slip<R>,
    band_nm: [R; 2],
    film_nm: R,
    joint_nm: [R; 2],
    pin_nm: [R; 2],
    deflection: Deflection<R>,
    capacity_nm: R,
    holding_n: R,
}

#[physics]
fn parts<R: Real>(belt: &Belt<R>, at: &BeltAtRatio<R>, load: &BeltLoad<R>) -> Parts<R> {
    if let Some(chain) = &belt.chain {
        return chain::parts(belt, chain, at, load);
    }
    let tension = Tension::driving(belt, at, load);
    let none = [load.output_torque_nm.splat(0.0); 2];
    let mu_segment = belt.formulation.segment_friction(load.segment_friction);
    let band_nm = bands::band_loss_nm(at, &tension, &load.band);
    let film_nm = bands::film_loss_nm(at, load);
    let slip = slip::slip(belt, at, &tension, mu_segment);
    let holding_n = tension.holding_n(belt, at, load.output_torque_nm, mu_segment);
    Parts {
        holding_n,
        slip: if belt.formulation.by_statics() {
            let net_nm = load.output_torque_nm * at.geometry.inv_ratio;
            slip.by_statics(net_nm, sum(band_nm) + film_nm)
        } else {
            slip
        },
        band_nm,
        film_nm,
        joint_nm: none,
        pin_nm: none,
        deflection: deflection::deflection(belt, at, &tension, load.flank_friction),
        capacity_nm: capacity_nm(
            at,
            &tension,
            belt.formulation
                .capacity_friction(mu_segment, load.capacity_friction),
        ),
        tension,
    }
}

#[physics]
fn sum<R: Real>(pair: [R; 2]) -> R {
    pair[0] + pair[1]
}

#[physics]
fn losses<R: Real>(load: &BeltLoad<R>, parts: &Parts<R>) -> BeltLosses<R> {
    let (slip, capacity_nm) = (&parts.slip, parts.capacity_nm);
    let share_nm = slip.primary_loss_nm + slip.secondary_loss_nm;
    // Slip against the torque relieves bands and film, both by the same share (SL-11).
    let sliding_nm = sum(parts.band_nm) + parts.film_nm;
    let is_relieved = share_nm.splat(0.0).gt(share_nm);
    let mut left = share_nm.splat(1.0);
    if is_relieved.any() {
        left = is_relieved.select((1.0 + share_nm / sliding_nm).max(0.0), left);
    }
    BeltLosses {
        band_nm: left * sum(parts.band_nm),
        film_nm: left * parts.film_nm,
        joint_nm: sum(parts.joint_nm),
        pin_nm: sum(parts.pin_nm),
        slip_nm: share_nm.max(0.0),
        wedge_nm: sum(parts.deflection.wedge_nm),
        penetration_nm: sum(parts.deflection.penetration_nm),
        slip_total: slip.primary + slip.secondary,
        capacity_nm,
        holding_n: parts.holding_n,
        gross_slip: slip.held | load.output_torque_nm.abs().gt(capacity_nm),
    }
}

#[physics]
fn state<R: Real>(at: &BeltAtRatio<R>, load: &BeltLoad<R>, parts: &Parts<R>) -> BeltState<R> {
    let losses = losses(load, parts);
    BeltState {
        input_torque_nm: load.output_torque_nm / at.geometry.ratio * (1.0 - losses.slip_total)
            + losses.sum_nm(), // VA-1
        tension: parts.tension,
        slip: parts.slip,
        band_nm: sum(parts.band_nm),
        film_nm: parts.film_nm,
        losses,
    }
}

/// Slip, losses and capacity at one operating point: the sums of [`belt_state`] without its detail.
#[physics]
pub fn belt_losses<R: Real>(
    belt: &Belt<R>,
    at: &BeltAtRatio<R>,
    load: &BeltLoad<R>,
) -> BeltLosses<R> {
    losses(load, &parts(belt, at, load))
}

/// Torque capacity at the secondary for a clamping force of the secondary, Nm (VA-2, VA-4).
#[physics]
pub fn belt_capacity_nm<R: Real>(belt: &Belt<R>, at: &BeltAtRatio<R>, load: &BeltLoad<R>) -> R {
    belt_losses(belt, at, load).capacity_nm
}

/// Solves the belt at one operating point.
///
/// ```
/// use cvtcycle_config::setup::{Options, load};
/// use cvtcycle_model::rig::Bench;
/// use cvtcycle_model::transmission::cvt::variator::{BeltAtRatio, BeltLoad, belt_state};
///
/// let bench = Bench::new(&load("rover_216_cvt", &Options::default()).expect("a shipped car"));
/// let belt = &bench.cvt().expect("a CVT").belt;
/// let load = BeltLoad {
///     output_torque_nm: 60.0,
///     secondary_clamp_n: 20e3,
///     ..BeltLoad::turning(belt, &bench.car().oil, 353.15, 2.0, 200.0)
/// };
/// let state = belt_state(belt, &BeltAtRatio::new(belt, 2.0), &load);
/// assert!(state.losses.slip_total > 0.0 && !state.losses.gross_slip);
/// ```
#[physics]
pub fn belt_state<R: Real>(
    belt: &Belt<R>,
    at: &BeltAtRatio<R>,
    load: &BeltLoad<R>,
) -> BeltState<R> {
    state(at, load, &parts(belt, at, load))
}
