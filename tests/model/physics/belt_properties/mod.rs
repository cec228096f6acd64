//! Properties of the belt as `run` uses it: finite everywhere, continuous across every change of regime, monotone where physics says
//! so, true to dimension rescaling, to energy and to its limits.
//!
//! Truth comes from algebra on the labelled equations (written out at each test) and from conservation laws, not from the program.
//! Random points come from a fixed seed, so that a run can be repeated.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "tests stop at the first surprise; some equalities hold to the last bit"
)]

mod continuity;
mod limits;
mod monotone;
mod scaling;
mod statics;

use cvtcycle_model::lubricant::BandFriction;
use cvtcycle_model::transmission::cvt::variator::{
    Belt, BeltAtRatio, BeltLoad, BeltState, Formulation, belt_state,
};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// rpm to rad/s.
pub const RPM: f64 = std::f64::consts::PI / 30.0;
/// All formulations under the rules of driving.
pub const ALL: [Formulation; 3] = [
    Formulation::Smooth,
    Formulation::AppendixC,
    Formulation::Chapter8,
];

/// Random points, the same ones in every run.
pub fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(2001),
        ..ProptestConfig::with_cases(cases)
    }
}

/// The belt of the thesis (Appendix C) with the shipped smoothing.
pub fn thesis_belt(formulation: Formulation) -> Belt {
    let th = 11f64.to_radians();
    Belt {
        centre_distance_m: 0.155,
        length_m: 0.6486,
        segment_thickness_m: 1.46e-3,
        cos_wedge: th.cos(),
        tan_wedge: th.tan(),
        band_count: 12.0,
        band_thickness_m: 0.217e-3,
        band_width_m: 20e-3,
        band_offset_m: 3e-3,
        mass_kg_m: 1.039 / 0.6486,
        band_mass_kg_m: 0.263 / 0.6486,
        youngs_pa: 206e9,
        strut_area_m2: 10e-6,
        initial_gap_m: 0.0,
        primary_compliance_per_n: 1.0 / 0.6e7,
        secondary_compliance_per_n: 1.0 / 5e7,
        stop_from_ratio: 2.30,
        stop_to_ratio: 2.417,
        unity_width: 0.015,
        blend_n: 120.0,
        slip_bound: 0.1,
        shoulder_friction: 1.0,
        thrust_ratio: None,
        chain: None,
        formulation,
    }
}

/// An operating point in the units of the sweeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    pub ratio: f64,
    pub rpm: f64,
    pub torque_nm: f64,
    pub clamp_n: f64,
    pub mu_band: f64,
    pub mu_segment: f64,
    pub mu_flank: f64,
    pub film_share: f64,
}

impl Point {
    /// Warm oil, 30 Nm, 2000 rpm, 20 bar or so.
    pub fn plain(ratio: f64) -> Self {
        Point {
            ratio,
            rpm: 2000.0,
            torque_nm: 30.0,
            clamp_n: 20e3,
            mu_band: 0.13,
            mu_segment: 0.125,
            mu_flank: 0.13,
            film_share: 0.2,
        }
    }

    /// The load; the printed forms have no film.
    pub fn load(&self, formulation: Formulation) -> BeltLoad {
        let film = if formulation.has_film() { 1.0 } else { 0.0 };
        BeltLoad {
            primary_speed_rad_s: self.rpm * RPM,
            output_torque_nm: self.torque_nm,
            secondary_clamp_n: self.clamp_n,
            band: BandFriction {
                film_share: [1.0, 0.1].map(|part| film * part * self.film_share),
                ..BandFriction::dry(self.mu_band)
            },
            film_n: self.film_n().map(|n| film * n),
            segment_friction: self.mu_segment,
            capacity_friction: self.mu_segment,
            flank_friction: self.mu_flank,
        }
    }

    /// Forces of the films, N: some hundred at speed, none at rest.
    pub fn film_n(&self) -> [f64; 2] {
        [0.02, 0.001].map(|n_per_rpm| n_per_rpm * self.film_share * self.rpm.abs())
    }

    pub fn state(&self, belt: &Belt) -> BeltState {
        belt_state(
            belt,
            &BeltAtRatio::new(belt, self.ratio),
            &self.load(belt.formulation),
        )
    }

    /// Output torque at which C_x is zero (TE-5 or TE-7 with Z = 0), written out here from TE-1, TE-2 and TE-6.
    pub fn breakpoint_nm(&self, belt: &Belt) -> f64 {
        let at = BeltAtRatio::new(belt, self.ratio);
        let g = at.geometry;
        let v = self.rpm * RPM * g.primary_radius_m;
        let smooth = belt.formulation == Formulation::Smooth;
        let (wrap, mu, film_n) = if smooth {
            let mu = self.mu_band * (1.0 - self.film_share);
            let least = g.primary_wrap_rad.min(g.secondary_wrap_rad);
            (least, mu, self.film_n()[0]) // TE-7
        } else {
            (g.primary_wrap_rad, self.mu_band, 0.0)
        };
        let clamp_n = self.clamp_n * at.thrust_ratio;
        let pull = wrap
            * (2.0 * clamp_n * belt.tan_wedge / g.primary_wrap_rad + belt.masses_kg_m()[0] * v * v);
        (self.ratio.ln() / belt.unity_width).tanh() * (mu * pull + film_n) * g.secondary_radius_m
    }
}

/// Quantities that must be finite and continuous, with names.
pub const NAMES: [&str; 11] = [
    "band",
    "film",
    "slip loss",
    "wedge",
    "penetration",
    "slip",
    "primary slip",
    "secondary slip",
    "input torque",
    "C_x",
    "dT",
];

pub fn values(s: &BeltState) -> [f64; NAMES.len()] {
    let (t, slip) = (&s.tension, &s.slip);
    [
        s.losses.band_nm,
        s.losses.film_nm,
        s.losses.slip_nm,
        s.losses.wedge_nm,
        s.losses.penetration_nm,
        s.losses.slip_total,
        slip.primary,
        slip.secondary,
        s.input_torque_nm,
        t.compression_n,
        t.step_n,
    ]
}

/// True where the second law bounds slip (SL-12): bands and film then lose nothing.
pub fn second_law_binds(s: &BeltState) -> bool {
    let share_nm = s.slip.primary_loss_nm + s.slip.secondary_loss_nm;
    share_nm <= 0.0 && s.losses.band_nm + s.losses.film_nm <= 1e-12 * (s.band_nm + s.film_nm)
}

/// Zero, the ends and everything between.
pub fn zero_to(top: f64) -> impl Strategy<Value = f64> {
    prop_oneof![1 => Just(0.0), 1 => Just(top), 1 => 0.0..1e-6, 7 => 0.0..top]
}

/// The two regimes' ends, unity, its neighbours and everything between.
pub fn any_ratio() -> impl Strategy<Value = f64> {
    prop_oneof![
        1 => prop::sample::select(vec![0.35, 0.4137, 0.5, 1.0, 2.30, 2.417, 3.0]),
        1 => (-1e-3..1e-3f64).prop_map(|x| 1.0 + x),
        6 => (0.35f64.ln()..3f64.ln()).prop_map(f64::exp),
    ]
}

/// Any operating point of the brief's box; one in six sits exactly where C_x changes sign.
pub fn any_point() -> impl Strategy<Value = Point> {
    let torque = prop_oneof![1 => Just(0.0), 6 => -400.0..400.0f64];
    let speeds_forces = (any_ratio(), zero_to(7000.0), torque, zero_to(50e3));
    let frictions = (zero_to(0.2), zero_to(0.2), zero_to(0.2), zero_to(1.0));
    (speeds_forces, frictions, 0..6u8).prop_map(
        |((ratio, rpm, torque_nm, clamp_n), (mu_band, mu_segment, mu_flank, film_share), seat)| {
            let p = Point {
                ratio,
                rpm,
                torque_nm,
                clamp_n,
                mu_band,
                mu_segment,
                mu_flank,
                film_share,
            };
            if seat == 0 {
                Point {
                    torque_nm: p.breakpoint_nm(&thesis_belt(Formulation::Smooth)),
                    ..p
                }
            } else {
                p
            }
        },
    )
}

/// One of the three formulations.
pub fn any_formulation() -> impl Strategy<Value = Formulation> {
    prop::sample::select(ALL.to_vec())
}

/// A property with its place in words.
pub fn hold(good: bool, said: impl FnOnce() -> String) -> Result<(), TestCaseError> {
    if good {
        Ok(())
    } else {
        Err(TestCaseError::fail(said()))
    }
}
