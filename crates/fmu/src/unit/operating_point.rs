//! Operating points of a transmission.

use cvtcycle_config::ProblemKind::Failed;
use cvtcycle_model::flags::Flags;
use cvtcycle_model::rig::{Bench, BenchPoint};
use cvtcycle_model::transmission::component::ByComponent;

use super::{Refusal, Unit, set_outputs};
use crate::variables::{Get, LossResult, point};

impl Unit {
    /// Solves the operating point of the current inputs.
    pub(super) fn solve(&mut self) -> Result<(), Refusal> {
        let Some(bench) = &self.bench else {
            return Ok(());
        };
        let value = |place: usize| self.saved.values[place];
        let is_cvt = bench.cvt().is_some();
        let asked = BenchPoint {
            ratio: value(point::RATIO),
            input_rad_s: value(point::SPEED),
            sump_k: value(point::OIL),
            pressure_pa: Some(point::PRESSURE)
                .filter(|_| is_cvt)
                .map(value)
                .filter(|pa| *pa > 0.0),
            ..BenchPoint::default()
        };
        let wanted_nm = value(point::TORQUE);
        let turns = asked.input_rad_s > 0.0;
        let result = match turns {
            true => {
                let point = bench.at_input_torque(&asked, wanted_nm);
                let answer = bench.solve(&point);
                LossResult { point, answer }
            }
            false => shaft_at_rest(bench, &asked, wanted_nm),
        };
        self.saved.stale = false;
        let solved = result.answer.total_nm().is_finite();
        let loss_w = result.answer.loss_nm.map(|nm| nm * asked.input_rad_s);
        set_outputs(
            &self.variables,
            &mut self.saved.values,
            &loss_w,
            |get| match get {
                Get::Losses(output) => Some(output(&result)),
                _ => None,
            },
        );
        match solved && !result.answer.flags.contains(Flags::NOT_CONVERGED) {
            true => Ok(()),
            false => {
                let message = format!(
                    "no operating point at {} rad/s, {wanted_nm} Nm, ratio {}: the belt slips; the outputs without a value keep their last one",
                    asked.input_rad_s, asked.ratio
                );
                Err(Refusal::new(Failed, message))
            }
        }
    }
}

/// Result for an input shaft at rest: no power loss, torque passed on.
fn shaft_at_rest(bench: &Bench, asked: &BenchPoint, wanted_nm: f64) -> LossResult {
    let turning = BenchPoint {
        input_rad_s: 1.0,
        ..*asked
    };
    let overall = match bench.cvt() {
        Some(_) => asked.ratio * bench.own_ratio(asked),
        None => bench.own_ratio(asked),
    };
    let mut answer = bench.solve(&turning);
    answer.loss_nm = ByComponent::default();
    answer.input_nm = wanted_nm;
    answer.output_rad_s = 0.0;
    answer.flags = Flags::default();
    LossResult {
        point: BenchPoint {
            output_nm: wanted_nm * overall,
            ..*asked
        },
        answer,
    }
}
