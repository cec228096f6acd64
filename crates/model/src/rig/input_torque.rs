//! An operating point by the torque at its input shaft.

use super::{Bench, BenchPoint};
use crate::transmission::Transmission;

/// Passes after which the search ends; each leaves a few per cent of the error.
const MAX_PASSES: u32 = 60;
/// It ends when the torque is met to this, relative to 1 Nm and more.
const MET: f64 = 1e-13;

impl Bench {
    /// Torque of the output shaft over that of the shaft before the final drive of a CVT, or over that of the input of a manual box.
    pub fn own_ratio(&self, point: &BenchPoint) -> f64 {
        match &self.car().transmission {
            Transmission::Cvt(cvt) => cvt.final_drive.ratio,
            Transmission::Manual(manual) => manual.overall[point.ratio as usize - 1],
        }
    }

    /// The point at which the box takes a torque, Nm, at its input. In a CVT the clamp law sees that torque over full load as throttle.
    pub fn at_input_torque(&self, point: &BenchPoint, wanted_nm: f64) -> BenchPoint {
        let (car, own) = (self.car(), self.own_ratio(point));
        let (overall, throttle) = match car.transmission.is_cvt() {
            true => {
                let full_load_nm = car.engine.full_load.at(point.input_rad_s);
                (
                    own * point.ratio,
                    (wanted_nm / full_load_nm).clamp(0.0, 1.0),
                )
            }
            false => (own, point.throttle),
        };
        let mut found = BenchPoint {
            output_nm: wanted_nm * overall,
            throttle,
            ..*point
        };
        let bench = self.at_ratio(point.ratio);
        for _ in 0..MAX_PASSES {
            let miss = bench.solve(&found).input_nm - wanted_nm;
            if miss.abs() <= MET * (1.0 + wanted_nm.abs()) {
                break;
            }
            found.output_nm -= miss * overall;
        }
        found
    }
}
