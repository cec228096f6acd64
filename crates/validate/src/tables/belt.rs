//! The belt alone as a table.

use super::{Column, Marks, Rows, combinations, rpm};
use crate::belt::{GivenFriction, belt_k, belt_load};
use crate::expr::Table;
use crate::source::{Kind, Source};
use cvtcycle_config::setup::Setup;
use cvtcycle_model::lubricant::{Lubricant, ZERO_DEGC_K};
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::cvt::Cvt;
use cvtcycle_model::transmission::cvt::variator::point::PointStatus;
use cvtcycle_model::transmission::cvt::variator::{
    Belt, BeltAtRatio, BeltLoad, BeltPoint, Formulation, Geometry, belt_point, pulley_sliding_m_s,
    sliding_speed_m_s, speed_share,
};

const RATIO: usize = 0;
const SPEED: usize = 1;
const PRESSURE: usize = 2;
const BELT_TEMP: usize = 3;
const BAND_FRICTION: usize = 4;
const SEGMENT_FRICTION: usize = 5;
const ON_STOP: usize = 6;
const BAND_SPEED: usize = 7;
const TORQUE: usize = 8;

/// A solved point; settings in the order of the belt's keys, NaN where none is given.
pub struct Solved {
    x: Vec<f64>,
    belt: Belt,
    at: BeltAtRatio,
    load: BeltLoad,
    belt_k: f64,
    /// Dynamic viscosity at the belt's temperature, Pa s.
    eta_pa_s: f64,
    point: BeltPoint,
}

/// Columns.
pub fn columns() -> Vec<Column<Solved>> {
    columns! { Solved;
        "ratio" s => s.x[RATIO];
        "speed_rpm" s => rpm(s.x[SPEED]);
        "pressure_bar" s => s.x[PRESSURE] / 1e5;
        "torque_nm" s => s.x[TORQUE];
        "belt_degc" s => s.belt_k - ZERO_DEGC_K;
        "band_speed_share" s => if s.x[BAND_SPEED].is_nan() { speed_share(&s.belt) } else { s.x[BAND_SPEED] };
        "band_friction" s => s.load.band.mu;
        "primary_radius_mm" s => 1e3 * s.point.geometry.primary_radius_m;
        "secondary_radius_mm" s => 1e3 * s.point.geometry.secondary_radius_m;
        "primary_wrap_deg" s => s.point.geometry.primary_wrap_rad.to_degrees();
        "secondary_wrap_deg" s => s.point.geometry.secondary_wrap_rad.to_degrees();
        "strut_length_mm" s => 1e3 * s.point.geometry.strut_m;
        "belt_speed_m_s" s => s.point.belt_speed_m_s;
        "primary_clamp_n" s => s.point.tension.primary_clamp_n;
        "secondary_clamp_n" s => s.point.tension.secondary_clamp_n;
        "primary_shoulder_n" s => s.point.tension.primary_shoulder_n;
        "secondary_shoulder_n" s => s.point.tension.secondary_shoulder_n;
        "band_tension_1_n" s => s.point.band_tension_n[0];
        "band_tension_2_n" s => s.point.band_tension_n[1];
        "band_tension_step_n" s => s.point.tension.step_n;
        "segment_compression_n" s => s.point.tension.compression_n;
        "band_1_travel_mm" s => 1e3 * s.point.band_travel_m[0];
        "band_i_travel_mm" s => 1e3 * s.point.band_travel_m[1];
        "band_nm" s => sum(s.point.band_loss_nm);
        "film_nm" s => sum(s.point.film_loss_nm);
        "slip_nm" s => sum(s.point.slip_loss_nm);
        "wedge_nm" s => sum(s.point.wedge_loss_nm);
        "penetration_nm" s => sum(s.point.penetration_loss_nm);
        "wedge_primary_nm" s => s.point.wedge_loss_nm[0];
        "wedge_secondary_nm" s => s.point.wedge_loss_nm[1];
        "penetration_primary_nm" s => s.point.penetration_loss_nm[0];
        "penetration_secondary_nm" s => s.point.penetration_loss_nm[1];
        "loss_nm" s => s.point.loss_nm;
        "input_torque_nm" s => s.point.input_torque_nm;
        "active_segments" s => s.point.active_segments;
        "active_arc_mm" s => 1e3 * s.point.active_segments * s.belt.segment_thickness_m;
        "gap_slip_m_s" s => s.point.gap_slip_m_s;
        "primary_slip_m_s" s => s.point.slip_m_s[0];
        "secondary_slip_m_s" s => s.point.slip_m_s[1];
        "slip_percent" s => 100.0 * s.point.slip_total;
        "capacity_nm" s => s.point.capacity_nm;
        "primary_arc_mm" s => 1e3 * s.at.prepared.arc_m[0];
        "secondary_arc_mm" s => 1e3 * s.at.prepared.arc_m[1];
        "primary_deflection_mm" s => s.deflection_mm(0);
        "secondary_deflection_mm" s => s.deflection_mm(1);
        "band_slide_primary_m_s" s => s.sliding_m_s()[0];
        "band_slide_secondary_m_s" s => s.sliding_m_s()[1];
        "sliding_m_s" s => sliding_speed_m_s(&s.belt, s.point.geometry.ratio, s.load.primary_speed_rad_s)[0];
        "film_share" s => s.load.band.film_share[0];
        "dynamic_viscosity_mpa_s" s => 1e3 * s.eta_pa_s;
        "primary_segment_force_n" s => s.point.tension.primary_clamp_n * s.at.prepared.normal_per_clamp[0];
        "secondary_segment_force_n" s => s.point.tension.secondary_clamp_n * s.at.prepared.normal_per_clamp[1];
        "band_1_share" s => s.band_1_share();
        "shoulder_pressure_bar" s => s.shoulder_pressure_bar();
        "band_pressure_bar" s => s.shoulder_pressure_bar() / s.belt.band_count;
    }
}

fn sum(pair: [f64; 2]) -> f64 {
    pair[0] + pair[1]
}

impl Solved {
    fn deflection_mm(&self, pulley: usize) -> f64 {
        let (g, t) = (&self.point.geometry, &self.point.tension);
        if pulley == 0 {
            let per_n = self.belt.primary_compliance_per_n;
            1e3 * self.at.prepared.stop * g.primary_radius_m * t.primary_clamp_n * per_n
        } else {
            let per_n = self.belt.secondary_compliance_per_n;
            1e3 * g.secondary_radius_m * t.secondary_clamp_n * per_n
        }
    }

    fn sliding_m_s(&self) -> [f64; 2] {
        let w = self.load.primary_speed_rad_s;
        pulley_sliding_m_s(&self.belt, &self.point.geometry, w)
    }

    /// Share of the innermost interface in a loss that falls in equal steps outwards: d over d + t (n-1)/2 (BT-2, BT-3).
    fn band_1_share(&self) -> f64 {
        let belt = &self.belt;
        let outer = belt.band_thickness_m * (belt.band_count - 1.0) / 2.0;
        belt.band_offset_m / (belt.band_offset_m + outer)
    }

    fn shoulder_pressure_bar(&self) -> f64 {
        let area_m2 = self.at.prepared.arc_m[0] * self.belt.band_width_m;
        self.point.tension.primary_shoulder_n / area_m2 / 1e5
    }
}

/// An error if a belt cannot run at a ratio.
pub fn fits(belt: &Belt, ratio: f64) -> Result<(), String> {
    let g = Geometry::new(ratio, belt.centre_distance_m, belt.length_m);
    let radii = [g.primary_radius_m, g.secondary_radius_m];
    let lengths = radii.into_iter().chain([g.strut_m, g.primary_wrap_rad]);
    let runs = lengths.into_iter().all(|x| x.is_finite() && x > 0.0);
    let refusal = || format!("the belt cannot run at ratio {ratio}");
    runs.then_some(()).ok_or_else(refusal)
}

/// Computes all points.
pub fn table(source: &Source, setup: &Setup) -> Result<Table, String> {
    let Transmission::Cvt(cvt) = setup.transmission() else {
        return Err("the vehicle has no belt".to_owned());
    };
    let axes = Kind::Belt.axes().iter().map(|key| source.axis(key));
    let axes: Vec<Vec<f64>> = axes.collect();
    let is_printed = source.formulation != Formulation::Smooth;
    for ratio in &axes[RATIO] {
        fits(&cvt.belt, *ratio)?;
        if is_printed && (ratio - 1.0).abs() <= 0.0 {
            return Err("the printed forms are not defined at ratio 1".to_owned());
        }
    }
    if is_printed && axes[SPEED].iter().any(|speed| *speed <= 0.0) {
        return Err("the printed forms are not defined at rest".to_owned());
    }
    let belt = Belt {
        formulation: source.formulation,
        ..cvt.belt.clone()
    };
    let points = combinations(&axes);
    let mut rows = Rows::new(points.len());
    for x in points {
        let solved = solve(x, cvt, &belt, setup.oils().0);
        let marks = Marks {
            gross: solved.point.status != PointStatus::Ok,
            ..Marks::default()
        };
        rows.add(solved, &marks);
    }
    Ok(rows.by(columns()))
}

fn solve(x: Vec<f64>, cvt: &Cvt, belt: &Belt, oil: &Lubricant) -> Solved {
    let mut at = BeltAtRatio::new(belt, x[RATIO]);
    if !x[ON_STOP].is_nan() {
        at.prepared.stop = 1.0 - x[ON_STOP];
    }
    let given = GivenFriction {
        band: x[BAND_FRICTION],
        segment: x[SEGMENT_FRICTION],
        belt_k: x[BELT_TEMP],
    };
    let load = BeltLoad {
        output_torque_nm: x[TORQUE],
        secondary_clamp_n: cvt.secondary_clamp_n(x[PRESSURE], x[SPEED] / x[RATIO]),
        ..belt_load(oil, belt, x[RATIO], x[SPEED], &given)
    };
    let mut point = belt_point(belt, &at, &load);
    if !x[BAND_SPEED].is_nan() {
        point = point.with_band_speed(belt, x[BAND_SPEED]);
    }
    Solved {
        belt_k: belt_k(x[BELT_TEMP]),
        eta_pa_s: oil.dynamic_pa_s(belt_k(x[BELT_TEMP])),
        x,
        belt: belt.clone(),
        at,
        load,
        point,
    }
}
