//! Steady tests: torque loss and secondary pressure at held speed, oil temperature, ratio and load (thesis 5.3.1, 5.3.4).

use super::conditions::Conditions;
use crate::rig::{Bench, BenchAnswer, BenchPoint, KeptRatio, Parts};

/// Test points.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Belt ratios.
    pub ratios: Vec<f64>,
    /// Input speeds, rad/s; those of the rig for each ratio where none are given.
    pub speeds_rad_s: Option<Vec<f64>>,
    /// Temperatures of the bulk oil, K.
    pub oil_k: Vec<f64>,
    /// Torques at the output shaft of the loaded tests, Nm.
    pub torques_nm: Vec<f64>,
}

impl Plan {
    /// The rig's own points.
    pub fn from_conditions(c: &Conditions) -> Self {
        Plan {
            ratios: vec![c.low_ratio, c.high_ratio],
            speeds_rad_s: None,
            oil_k: c.oil_k.clone(),
            torques_nm: c.torques_nm.clone(),
        }
    }

    /// Input speeds at a ratio, rad/s.
    pub fn speeds(&self, c: &Conditions, ratio: f64) -> Vec<f64> {
        self.speeds_rad_s
            .clone()
            .unwrap_or_else(|| c.speeds(ratio).list())
    }

    /// Every point without load, by ratio, then temperature, then speed.
    pub fn points<'a>(&'a self, c: &'a Conditions) -> impl Iterator<Item = BenchPoint> + 'a {
        self.ratios.iter().flat_map(move |&ratio| {
            let speeds = self.speeds(c, ratio);
            self.oil_k.iter().flat_map(move |&sump_k| {
                speeds
                    .clone()
                    .into_iter()
                    .map(move |input_rad_s| BenchPoint {
                        ratio,
                        input_rad_s,
                        sump_k,
                        throttle: c.throttle,
                        ..BenchPoint::default()
                    })
            })
        })
    }
}

/// A point and what the bench answered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteadyPoint {
    /// Settings of the rig.
    pub set: BenchPoint,
    /// Answer of the rig.
    pub answer: BenchAnswer,
}

fn solved(bench: &mut KeptRatio, set: BenchPoint) -> SteadyPoint {
    SteadyPoint {
        set,
        answer: bench.at(set.ratio).solve(&set),
    }
}

/// The maps without load, by ratio, then temperature, then speed.
pub fn steady(bench: &Bench, c: &Conditions, plan: &Plan) -> Vec<SteadyPoint> {
    let mut bench = KeptRatio::new(bench, c.low_ratio);
    plan.points(c).map(|p| solved(&mut bench, p)).collect()
}

/// The maps under load, by ratio, then temperature, then output torque, then speed.
pub fn loaded(bench: &Bench, c: &Conditions, plan: &Plan) -> Vec<SteadyPoint> {
    let mut points = Vec::new();
    let mut bench = KeptRatio::new(bench, c.low_ratio);
    for &ratio in &plan.ratios {
        let speeds = plan.speeds(c, ratio);
        for &sump_k in &plan.oil_k {
            for &output_nm in &plan.torques_nm {
                let at = |&input_rad_s: &f64| BenchPoint {
                    ratio,
                    input_rad_s,
                    output_nm,
                    sump_k,
                    throttle: c.throttle,
                    ..BenchPoint::default()
                };
                points.extend(speeds.iter().map(|w| solved(&mut bench, at(w))));
            }
        }
    }
    points
}

/// A point in the first box and in the second one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoBoxes {
    /// The box of all other tests.
    pub first: SteadyPoint,
    /// The same with the second box's pressure (RT-6).
    pub second: SteadyPoint,
}

impl TwoBoxes {
    /// Loss of the second box over that of the first, Nm.
    pub fn difference_nm(&self) -> f64 {
        self.second.answer.total_nm() - self.first.answer.total_nm()
    }
}

/// The maps without load of both boxes.
pub fn second_box(bench: &Bench, c: &Conditions, plan: &Plan) -> Vec<TwoBoxes> {
    let factor = c.pressure.second_box;
    let mut bench = KeptRatio::new(bench, c.low_ratio);
    let both = |p: BenchPoint| TwoBoxes {
        first: solved(&mut bench, p),
        second: solved(
            &mut bench,
            BenchPoint {
                pressure_factor: factor,
                parts: Parts::ALL,
                ..p
            },
        ), // RT-6
    };
    plan.points(c).map(both).collect()
}
