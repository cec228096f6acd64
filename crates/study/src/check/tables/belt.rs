//! The belt alone as a table.

use super::{Marks, Table, combinations, from_rows, rpm, truth};
use crate::check::source::Source;
use cvtcycle_config::setup::Setup;
use cvtcycle_model::fluid::{BandFriction, Friction, Lubricant, ZERO_DEGC_K};
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::cvt::Cvt;
use cvtcycle_model::transmission::cvt::variator::point::PointStatus;
use cvtcycle_model::transmission::cvt::variator::{
    Belt, BeltAtRatio, BeltLoad, BeltPoint, Formulation, Geometry, belt_point, sliding_speed_m_s,
};

/// Band friction of the printed forms, where none is given.
const PRINTED_BAND: f64 = 0.13;
/// Belt temperature where none is given, K.
const REFERENCE_K: f64 = 85.0 + ZERO_DEGC_K;

const COLUMNS: [&str; 53] = [
    "ratio",
    "speed_rpm",
    "pressure_bar",
    "torque_nm",
    "belt_degc",
    "band_speed_share",
    "band_friction",
    "primary_radius_mm",
    "secondary_radius_mm",
    "primary_wrap_deg",
    "secondary_wrap_deg",
    "strut_length_mm",
    "belt_speed_m_s",
    "primary_clamp_n",
    "secondary_clamp_n",
    "primary_shoulder_n",
    "secondary_shoulder_n",
    "band_tension_1_n",
    "band_tension_2_n",
    "band_tension_step_n",
    "segment_compression_n",
    "band_1_travel_mm",
    "band_i_travel_mm",
    "band_nm",
    "film_nm",
    "slip_nm",
    "wedge_nm",
    "penetration_nm",
    "wedge_primary_nm",
    "wedge_secondary_nm",
    "penetration_primary_nm",
    "penetration_secondary_nm",
    "loss_nm",
    "input_torque_nm",
    "active_segments",
    "active_arc_mm",
    "gap_slip_m_s",
    "primary_slip_m_s",
    "secondary_slip_m_s",
    "slip_percent",
    "capacity_nm",
    "primary_arc_mm",
    "secondary_arc_mm",
    "primary_deflection_mm",
    "secondary_deflection_mm",
    "sliding_m_s",
    "film_share",
    "dynamic_viscosity_mpa_s",
    "primary_segment_force_n",
    "secondary_segment_force_n",
    "band_1_share",
    "shoulder_pressure_bar",
    "band_pressure_bar",
];

const GROSS: usize = COLUMNS.len();

/// Names of the columns.
pub fn columns() -> Vec<&'static str> {
    COLUMNS.to_vec()
}

/// Whether a belt runs at a ratio at all.
pub fn fits(belt: &Belt, ratio: f64) -> Result<(), String> {
    let g = Geometry::new(ratio, belt.centre_distance_m, belt.length_m);
    let good = |x: f64| x.is_finite() && x > 0.0;
    let runs = good(g.primary_radius_m)
        && good(g.secondary_radius_m)
        && good(g.strut_m)
        && good(g.primary_wrap_rad);
    if runs {
        Ok(())
    } else {
        Err(format!("the belt cannot run at ratio {ratio}"))
    }
}

struct OneBelt<'a> {
    cvt: &'a Cvt,
    oil: &'a Lubricant,
    formulation: Formulation,
}

/// Computes all points.
pub fn table(source: &Source, setup: &Setup) -> Result<Table, String> {
    let Transmission::Cvt(cvt) = setup.transmission() else {
        return Err("the vehicle has no belt".to_owned());
    };
    let one = OneBelt {
        cvt,
        oil: setup.oils().0,
        formulation: source.formulation,
    };
    let nan = |key: &str| source.axis_or_none(key).unwrap_or_else(|| vec![f64::NAN]);
    let axes = [
        nan("ratio"),
        nan("speed_rpm"),
        nan("pressure_bar"),
        nan("belt_degc"),
        nan("band_friction"),
        nan("segment_friction"),
        nan("on_stop"),
        nan("band_speed_share"),
        nan("torque_nm"),
    ];
    for ratio in &axes[0] {
        fits(&cvt.belt, *ratio)?;
        if source.formulation != Formulation::Smooth && (ratio - 1.0).abs() <= 0.0 {
            return Err("the printed forms are not defined at ratio 1".to_owned());
        }
    }
    if source.formulation != Formulation::Smooth && axes[1].iter().any(|speed| *speed <= 0.0) {
        return Err("the printed forms are not defined at rest".to_owned());
    }
    let rows = combinations(&axes).into_iter().map(|x| (one.row(&x), 1.0));
    Ok(from_rows(
        GROSS,
        rows,
        Marks {
            gross: Some(GROSS),
            outside: None,
        },
    ))
}

fn or(x: f64, other: f64) -> f64 {
    if x.is_nan() { other } else { x }
}

impl OneBelt<'_> {
    fn band(&self, x: &[f64], belt_k: f64, eta_pa_s: f64) -> BandFriction {
        let smooth = self.formulation == Formulation::Smooth;
        let fluid = &self.oil.friction;
        let mu = or(x[4], if smooth { fluid.band } else { PRINTED_BAND });
        if x[3].is_nan() {
            return BandFriction {
                mu,
                film_share: 0.0,
            };
        }
        let sliding = if smooth {
            sliding_speed_m_s(&self.cvt.belt, x[0], x[1])
        } else {
            0.0
        };
        Friction { band: mu, ..*fluid }.band(belt_k, eta_pa_s, sliding)
    }

    fn row(&self, x: &[f64]) -> Vec<f64> {
        let belt = Belt {
            formulation: self.formulation,
            ..self.cvt.belt.clone()
        };
        let mut at = BeltAtRatio::new(&belt, x[0]);
        if !x[6].is_nan() {
            at.prepared.stop = 1.0 - x[6];
        }
        let fluid = &self.oil.friction;
        let segment = match self.formulation {
            Formulation::Smooth => fluid.segment,
            printed => printed.segment_friction(fluid.segment),
        };
        let belt_k = or(x[3], REFERENCE_K);
        let eta_pa_s = self.oil.dynamic_pa_s(belt_k);
        let load = BeltLoad {
            primary_speed_rad_s: x[1],
            output_torque_nm: x[8],
            secondary_clamp_n: self.cvt.secondary_clamp_n(x[2], x[1] / x[0]),
            band: self.band(x, belt_k, eta_pa_s),
            eta_pa_s,
            film_thickness_m: fluid.film_thickness_m,
            segment_friction: or(x[5], segment),
            flank_friction: fluid.flank,
        };
        let point = belt_point(&belt, &at, &load);
        let point = if x[7].is_nan() {
            point
        } else {
            point.with_band_speed(&belt, x[7])
        };
        let gross = truth(point.status != PointStatus::Ok);
        let head = [
            x[0],
            rpm(x[1]),
            x[2] / 1e5,
            x[8],
            belt_k - ZERO_DEGC_K,
            or(x[7], 0.0),
            load.band.mu,
        ];
        head.into_iter()
            .chain(forces(&point))
            .chain(losses(&point))
            .chain(rest(&belt, &at, &load, &point))
            .chain([gross])
            .collect()
    }
}

fn forces(p: &BeltPoint) -> [f64; 16] {
    let (g, t) = (&p.geometry, &p.tension);
    [
        1e3 * g.primary_radius_m,
        1e3 * g.secondary_radius_m,
        g.primary_wrap_rad.to_degrees(),
        g.secondary_wrap_rad.to_degrees(),
        1e3 * g.strut_m,
        p.belt_speed_m_s,
        t.primary_clamp_n,
        t.secondary_clamp_n,
        t.primary_shoulder_n,
        t.secondary_shoulder_n,
        p.band_tension_n[0],
        p.band_tension_n[1],
        t.step_n,
        t.compression_n,
        1e3 * p.band_travel_m[0],
        1e3 * p.band_travel_m[1],
    ]
}

fn losses(p: &BeltPoint) -> [f64; 11] {
    let sum = |pair: [f64; 2]| pair[0] + pair[1];
    [
        sum(p.band_loss_nm),
        sum(p.film_loss_nm),
        sum(p.slip_loss_nm),
        sum(p.wedge_loss_nm),
        sum(p.penetration_loss_nm),
        p.wedge_loss_nm[0],
        p.wedge_loss_nm[1],
        p.penetration_loss_nm[0],
        p.penetration_loss_nm[1],
        p.loss_nm,
        p.input_torque_nm,
    ]
}

fn rest(belt: &Belt, at: &BeltAtRatio, load: &BeltLoad, p: &BeltPoint) -> [f64; 19] {
    let (g, t) = (&p.geometry, &p.tension);
    let sliding = sliding_speed_m_s(belt, g.ratio, load.primary_speed_rad_s);
    // Share of the innermost interface in a loss that falls in equal steps outwards: d over d + t (n-1)/2 (BT-2, BT-3).
    let outer = belt.band_thickness_m * (belt.band_count - 1.0) / 2.0;
    let normal = |clamp: f64, k: usize| clamp * at.prepared.normal_per_clamp[k];
    let pressure = |force: f64, arc_m: f64| force / (arc_m * belt.band_width_m) / 1e5;
    let shoulder = pressure(t.primary_shoulder_n, at.prepared.arc_m[0]);
    [
        p.active_segments,
        1e3 * p.active_segments * belt.segment_thickness_m,
        p.gap_slip_m_s,
        p.slip_m_s[0],
        p.slip_m_s[1],
        100.0 * p.slip_total,
        p.capacity_nm,
        1e3 * at.prepared.arc_m[0],
        1e3 * at.prepared.arc_m[1],
        1e3 * at.prepared.stop
            * g.primary_radius_m
            * t.primary_clamp_n
            * belt.primary_compliance_per_n,
        1e3 * g.secondary_radius_m * t.secondary_clamp_n * belt.secondary_compliance_per_n,
        sliding,
        load.band.film_share,
        1e3 * load.eta_pa_s,
        normal(t.primary_clamp_n, 0),
        normal(t.secondary_clamp_n, 1),
        belt.band_offset_m / (belt.band_offset_m + outer),
        shoulder,
        shoulder / belt.band_count,
    ]
}
