//! Drag of the box that a coast-down in neutral has in its coefficients.
//!
//! | label | statement | status |
//! |---|---|---|
//! | NC-18 | F(v) = k T(v)/r, T the loss of the box turned by the wheels without torque, at the shaft that turns k times as fast as they do; f0, f1, f2 its least squares at 20, 30 .. 110 km/h | derived: the model's own drag, RL-9 |
//!
//! Of a CVT: final drive, pulley bearings, seal rings, belt and the open clutch behind the engine; not the pump and the input shaft, which the engine turns.
//! The belt is at the ratio that holds the primary at `gentle_rpm`, as far as its range reaches, and under the clamp law's pressure at closed throttle. Of a
//! manual box: the loss with its top gear engaged, in which its input shaft turns; in neutral that shaft is dragged along. The oil is at 60 degC
//! (ASSUMED 50 to 80: a coast-down follows half an hour of driving). What is taken off the road load here is what the box costs when it is driven without
//! load at that speed, so that the measured force is counted once.

use crate::setup::Setup;
use cvtcycle_model::rig::{Bench, BenchPoint};
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::component::{Component, LossGroup};

/// Oil of a coast-down, K.
const OIL_K: f64 = 333.15;
/// Speeds, m/s.
const SPEEDS: [f64; 10] = [20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 90.0, 100.0, 110.0];

/// Coefficients of the drag in neutral: N, N/(km/h), N/(km/h)2 (NC-18). `None` where the box cannot be turned at one of the speeds.
pub(super) fn drag_coefficients(setup: &Setup) -> Option<[f64; 3]> {
    let bench = Bench::new(&setup.vehicle);
    let forces: Option<Vec<f64>> = SPEEDS
        .iter()
        .map(|kmh| drag_n(setup, &bench, kmh / 3.6))
        .collect();
    least_squares(&forces?)
}

/// Drag at a speed, N.
fn drag_n(setup: &Setup, bench: &Bench, speed_m_s: f64) -> Option<f64> {
    let radius_m = setup.road_load.base.wheel_radius_m;
    let wheel_rad_s = speed_m_s / radius_m;
    let (ratio, overall) = match setup.transmission() {
        Transmission::Cvt(cvt) => {
            let line = cvt.ratio.gentle_rad_s / (wheel_rad_s * cvt.final_drive.ratio);
            let ratio = line.clamp(cvt.ratio.high, cvt.ratio.low);
            (ratio, ratio * cvt.final_drive.ratio)
        }
        Transmission::Manual(manual) => (manual.overall.len() as f64, *manual.overall.last()?),
    };
    let point = BenchPoint {
        ratio,
        input_rad_s: wheel_rad_s * overall,
        sump_k: OIL_K,
        ..BenchPoint::default()
    };
    let answer = bench.solve(&point);
    let turned_by_engine = |component: &Component| {
        *component == Component::InputShaft
            || matches!(component.group(), LossGroup::Pump | LossGroup::Launch)
    };
    let parts = Component::ALL
        .into_iter()
        .filter(|component| !turned_by_engine(component));
    let force_n = parts
        .map(|component| answer.part_nm(component))
        .sum::<f64>()
        * overall
        / radius_m; // NC-18
    force_n.is_finite().then_some(force_n)
}

/// The parabola nearest to the forces at [`SPEEDS`], by its normal equations.
fn least_squares(forces: &[f64]) -> Option<[f64; 3]> {
    let mut rows = [[0.0; 4]; 3];
    for (kmh, force) in SPEEDS.iter().zip(forces) {
        let x = [1.0, kmh / 100.0, kmh * kmh / 1e4];
        for (i, row) in rows.iter_mut().enumerate() {
            for (k, cell) in row.iter_mut().take(3).enumerate() {
                *cell += x[i] * x[k];
            }
            row[3] += x[i] * force;
        }
    }
    // Symmetric and positive definite: no exchange of rows is needed.
    for i in 0..3 {
        let pivot = rows[i];
        if pivot[i].abs() < 1e-12 {
            return None;
        }
        for (_, row) in rows.iter_mut().enumerate().filter(|(k, _)| *k != i) {
            let factor = row[i] / pivot[i];
            row.iter_mut()
                .zip(pivot)
                .for_each(|(cell, own)| *cell -= factor * own);
        }
    }
    let x = [0, 1, 2].map(|i| rows[i][3] / rows[i][i]);
    Some([x[0], x[1] / 100.0, x[2] / 1e4])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Outside truth: a parabola is its own nearest one.
    #[test]
    fn a_parabola_is_found_again() {
        let forces = SPEEDS.map(|v| 20.0 - 0.1 * v + 0.002 * v * v);
        let found = least_squares(&forces).unwrap_or_default();
        for (found, own) in found.iter().zip([20.0, -0.1, 0.002]) {
            assert!((found - own).abs() < 1e-9, "{found}");
        }
    }
}
