//! One operating point of the belt with everything that is known of it, for all readings of the model.

use super::bands::{band_loss_nm, speed_share, travel_m};
use super::deflection::{Deflection, deflection};
use super::slip::{Contact, MAX_AREA_N};
use super::{
    Belt, BeltAtRatio, BeltLoad, Formulation, Geometry, Tension, capacity_nm, parts, printed, state,
};
use crate::lubricant::VALID_K;

/// How the solution of a point ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointStatus {
    /// Within what the equations mean.
    Ok,
    /// The belt slides as a whole: no idle arc is left (printed forms), or torque above capacity or slip at its bound (driving).
    GrossSlip,
    /// No number of segments carries the load against the bands' pull: slip and total loss are NaN (printed forms only).
    NoActiveArc,
}

impl PointStatus {
    /// All of them.
    pub const ALL: [PointStatus; 3] = [
        PointStatus::Ok,
        PointStatus::GrossSlip,
        PointStatus::NoActiveArc,
    ];

    /// Name as in the `status` column.
    pub fn name(self) -> &'static str {
        match self {
            PointStatus::Ok => "ok",
            PointStatus::GrossSlip => "gross_slip",
            PointStatus::NoActiveArc => "no_active_arc",
        }
    }
}

/// One operating point. Pairs are primary, secondary; losses are torques at the primary shaft (power over its speed), Nm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeltPoint {
    /// Radii, wraps and strut.
    pub geometry: Geometry,
    /// Clamping and shoulder forces, tension step, segment compression (before any lifting to 30 N).
    pub tension: Tension,
    /// Belt speed, m/s.
    pub belt_speed_m_s: f64,
    /// Smaller and larger band tension, N (thesis eq. 39).
    pub band_tension_n: [f64; 2],
    /// Travel of the innermost band and of each other one on what lies below it, m per belt revolution (BT-5).
    pub band_travel_m: [f64; 2],
    /// Boundary friction of the bands.
    pub band_loss_nm: [f64; 2],
    /// Shear of the film, on the smaller wrap; zero in the printed forms.
    pub film_loss_nm: [f64; 2],
    /// Sliding of segments on pulleys.
    pub slip_loss_nm: [f64; 2],
    /// Wedging at entry and exit.
    pub wedge_loss_nm: [f64; 2],
    /// Penetration.
    pub penetration_loss_nm: [f64; 2],
    /// Joints of a chain.
    pub joint_loss_nm: [f64; 2],
    /// Pin ends of a chain.
    pub pin_loss_nm: [f64; 2],
    /// All belt losses.
    pub loss_nm: f64,
    /// Torque at the primary pulley, Nm (VA-1).
    pub input_torque_nm: f64,
    /// Active segments of the branch in force: whole in the printed forms, 0 where there are none; real-valued in driving.
    pub active_segments: f64,
    /// Slip speed of the loading pulley that closes the gaps, m/s.
    pub gap_slip_m_s: f64,
    /// Slip speed that its idle arc adds, m/s.
    pub idle_slip_m_s: f64,
    /// Slip speeds, m/s.
    pub slip_m_s: [f64; 2],
    /// Total slip as a fraction of belt speed.
    pub slip_total: f64,
    /// Torque capacity at the secondary, Nm (VA-2).
    pub capacity_nm: f64,
    /// How the solution ended.
    pub status: PointStatus,
}

impl BeltPoint {
    /// The same point with another adopted band speed, which moves the travel only.
    ///
    /// `speed_share`: distance of the adopted speed from the mean over the difference of the speeds that the pulleys require, 0.5 for the
    /// smaller pulley's, -0.5 for the larger one's (BT-5).
    pub fn with_band_speed(self, belt: &Belt, speed_share: f64) -> Self {
        BeltPoint {
            band_travel_m: travel_m(belt, &self.geometry, speed_share),
            ..self
        }
    }
}

/// A ratio may lie outside the vehicle's limits by this share before it is flagged: the printed 2.417 against the derived 2.4169.
pub const LIMIT_SLACK: f64 = 1e-3;

/// Limits of a vehicle's variator, for the flags of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLimits {
    /// Belt ratios of the highest and of the lowest gear.
    pub ratio: [f64; 2],
    /// Smallest and largest secondary pressure, Pa.
    pub pressure_pa: [f64; 2],
    /// Highest engine speed, rad/s.
    pub highest_rad_s: f64,
}

/// Departures of a point from what vehicle, fluid and model are valid for, as a bit set. Nothing is clamped for a flag.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PointFlags(u16);

impl PointFlags {
    /// Names in the order of the bits, with their meaning.
    pub const NAMES: [(&'static str, &'static str); 9] = [
        (
            "outside_ratio_range",
            "the ratio is outside the vehicle's limits",
        ),
        (
            "above_capacity",
            "the torque is above what the clamping forces carry (VA-2)",
        ),
        (
            "gross_slip",
            "the belt slides as a whole; slip and losses mean nothing in the printed forms, slip is bounded in smooth",
        ),
        (
            "no_active_arc",
            "the bands' pull leaves the segments no grip; slip and belt loss are NaN",
        ),
        (
            "overrun",
            "the output torque is negative: outside what the thesis describes",
        ),
        (
            "above_pressure_cap",
            "the secondary pressure is above the vehicle's largest",
        ),
        (
            "below_pressure_floor",
            "the secondary pressure is below the vehicle's smallest",
        ),
        ("overspeed", "the input speed is above the engine's highest"),
        (
            "outside_validity",
            "belt temperature outside the fluid's range, or segment compression beyond the fitted contact area (SL-3)",
        ),
    ];

    /// The flags of a point at a secondary pressure in Pa and a belt temperature in K.
    pub fn new(
        point: &BeltPoint,
        load: &BeltLoad,
        pressure_pa: f64,
        belt_k: f64,
        limits: &PointLimits,
    ) -> Self {
        let ratio = point.geometry.ratio;
        let set = [
            ratio < limits.ratio[0] * (1.0 - LIMIT_SLACK)
                || ratio > limits.ratio[1] * (1.0 + LIMIT_SLACK),
            load.output_torque_nm.abs() > point.capacity_nm,
            point.status == PointStatus::GrossSlip,
            point.status == PointStatus::NoActiveArc,
            load.output_torque_nm < 0.0,
            pressure_pa > limits.pressure_pa[1],
            pressure_pa < limits.pressure_pa[0],
            load.primary_speed_rad_s > limits.highest_rad_s * (1.0 + 1e-9),
            !VALID_K.contains(&belt_k) || point.tension.compression_n.abs() > MAX_AREA_N,
        ];
        PointFlags(
            set.iter()
                .enumerate()
                .map(|(bit, on)| u16::from(*on) << bit)
                .sum(),
        )
    }

    /// True if the flag at that index in [`PointFlags::NAMES`] is set.
    pub fn has(self, place: usize) -> bool {
        self.0 >> place & 1 == 1
    }

    /// Names of the flags that are set.
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        Self::NAMES
            .iter()
            .enumerate()
            .filter(move |(place, _)| self.has(*place))
            .map(|(_, (name, _))| *name)
    }
}

/// The point as the belt's formulation has it: pure `appendix_c` and `chapter_8` as printed, `smooth` as in driving.
///
/// The printed forms need a ratio other than 1 and a speed above zero; they take the load's segment friction as it is, no film,
/// and 0.13 in wedging and penetration.
pub fn belt_point(belt: &Belt, at: &BeltAtRatio, load: &BeltLoad) -> BeltPoint {
    if belt.formulation == Formulation::Smooth {
        driving_point(belt, at, load)
    } else {
        printed_point(belt, at, load)
    }
}

/// The point with the smooth rules, whatever the belt's formulation: the same numbers as [`super::belt_state`].
pub fn driving_point(belt: &Belt, at: &BeltAtRatio, load: &BeltLoad) -> BeltPoint {
    let parts = parts(belt, at, load);
    let state = state(at, load, &parts);
    let v = load.primary_speed_rad_s * at.geometry.primary_radius_m;
    let (slip, losses) = (state.slip, &state.losses);
    BeltPoint {
        film_loss_nm: split_nm(losses.film_nm, at.prepared.slide_m), // FI-1, BT-7
        slip_loss_nm: split_nm(
            losses.slip_nm,
            [slip.primary_loss_nm, slip.secondary_loss_nm],
        ),
        joint_loss_nm: parts.joint_nm,
        pin_loss_nm: parts.pin_nm,
        loss_nm: state.losses.sum_nm(),
        input_torque_nm: state.input_torque_nm,
        active_segments: slip.active_segments,
        gap_slip_m_s: v * slip.gap,
        idle_slip_m_s: v * slip.idle,
        slip_m_s: [v * slip.primary, v * slip.secondary],
        slip_total: state.losses.slip_total,
        capacity_nm: state.losses.capacity_nm,
        status: if state.losses.gross_slip {
            PointStatus::GrossSlip
        } else {
            PointStatus::Ok
        },
        ..without_slip(
            belt,
            at,
            load,
            &parts.tension,
            split_nm(losses.band_nm, parts.band_nm),
            &parts.deflection,
        )
    }
}

/// A loss of the belt on each pulley, in the proportion of the pair that came before SL-11.
fn split_nm(loss_nm: f64, pair: [f64; 2]) -> [f64; 2] {
    let [a, b] = pair.map(f64::abs);
    if a + b > 0.0 {
        [loss_nm * a / (a + b), loss_nm * b / (a + b)]
    } else {
        pair
    }
}

/// The point as printed (PR-1 to PR-5).
fn printed_point(belt: &Belt, at: &BeltAtRatio, load: &BeltLoad) -> BeltPoint {
    let tension = Tension::new(belt, at, load, printed::direction(at.geometry.ratio)); // PR-1
    let band_nm = band_loss_nm(at, &tension, &load.band);
    let deflection = deflection(belt, at, &tension, printed::FLANK_FRICTION); // PR-5
    let bare = without_slip(belt, at, load, &tension, band_nm, &deflection);
    let bare = BeltPoint {
        capacity_nm: capacity_nm(at, &tension, load.segment_friction),
        ..bare
    };
    let Some(slip) = printed::slip(&Contact::new(belt, at, &tension, load.segment_friction)) else {
        return bare;
    };
    let v = bare.belt_speed_m_s;
    let slip_total = slip.slip[0] + slip.slip[1];
    let sum = |pair: [f64; 2]| pair[0] + pair[1];
    let loss_nm = sum(bare.band_loss_nm)
        + sum(slip.loss_nm)
        + sum(bare.wedge_loss_nm)
        + sum(bare.penetration_loss_nm);
    BeltPoint {
        slip_loss_nm: slip.loss_nm,
        loss_nm,
        input_torque_nm: load.output_torque_nm / at.geometry.ratio * (1.0 - slip_total) + loss_nm, // VA-1
        active_segments: slip.active_segments,
        gap_slip_m_s: v * slip.gap,
        idle_slip_m_s: v * slip.idle,
        slip_m_s: slip.slip.map(|share| v * share),
        slip_total,
        status: if slip.gross {
            PointStatus::GrossSlip
        } else {
            PointStatus::Ok
        },
        ..bare
    }
}

/// Everything but slip, which stays not a number.
fn without_slip(
    belt: &Belt,
    at: &BeltAtRatio,
    load: &BeltLoad,
    tension: &Tension,
    band_loss_nm: [f64; 2],
    deflection: &Deflection,
) -> BeltPoint {
    let g = &at.geometry;
    let (mean, step) = (tension.mean_tension_n(g), tension.step_n.abs());
    BeltPoint {
        geometry: *g,
        tension: *tension,
        belt_speed_m_s: load.primary_speed_rad_s * g.primary_radius_m,
        band_tension_n: [mean - step / 2.0, mean + step / 2.0],
        band_travel_m: travel_m(belt, g, speed_share(belt)),
        band_loss_nm,
        film_loss_nm: [0.0; 2],
        slip_loss_nm: [f64::NAN; 2],
        wedge_loss_nm: deflection.wedge_nm,
        penetration_loss_nm: deflection.penetration_nm,
        joint_loss_nm: [0.0; 2],
        pin_loss_nm: [0.0; 2],
        loss_nm: f64::NAN,
        input_torque_nm: f64::NAN,
        active_segments: 0.0,
        gap_slip_m_s: f64::NAN,
        idle_slip_m_s: f64::NAN,
        slip_m_s: [f64::NAN; 2],
        slip_total: f64::NAN,
        capacity_nm: f64::NAN,
        status: PointStatus::NoActiveArc,
    }
}
