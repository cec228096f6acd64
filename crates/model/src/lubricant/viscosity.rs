//! Kinematic viscosity in the coordinates of ASTM D341 (LU-1): straight lines between points, the end lines continued.

use crate::math::{Gather, Mask, Real, ln, physics};

/// Steepest fall of ln ln(nu + 0.7) over ln T. Usual oils have 2.5 to 4; the steepest that is sold, a polyphenyl ether, 4.6. A slip of the pen
/// beyond it would be solid in the cold.
const STEEPEST: f64 = 5.0;

/// ln ln(nu + 0.7) against ln T: one line from two points, or a polyline through a table.
#[derive(Clone, Debug, Gather, PartialEq)]
pub struct Viscosity<R: Real = f64> {
    /// ln T of the points, rising.
    x: Vec<R>,
    /// Value ln ln(nu + 0.7) of the points, nu in mm2/s.
    w: Vec<R>,
    /// Slope of the line that ends at each point; the first point has the second's.
    slope: Vec<R>,
}

impl Viscosity {
    /// From points (temperature K, kinematic viscosity m2/s).
    ///
    /// # Errors
    /// A sentence if there are fewer than two points, temperatures do not rise, or viscosity does not fall with temperature, or falls more
    /// steeply than that of any oil.
    pub fn new(points: &[(f64, f64)]) -> Result<Self, String> {
        if points.len() < 2 {
            return Err("viscosity needs at least two points".into());
        }
        if points
            .iter()
            .any(|p| !(p.0 > 0.0 && p.1 * 1e6 > 0.5 && p.1.is_finite()))
        {
            return Err("viscosity must be above 0.5 mm2/s at a temperature above 0 K".into());
        }
        if points.windows(2).any(|p| p[0].0 >= p[1].0) {
            return Err("temperatures must rise from row to row".into());
        }
        if points.windows(2).any(|p| p[0].1 <= p[1].1) {
            return Err("viscosity must fall as temperature rises".into());
        }
        let x: Vec<f64> = points.iter().map(|p| ln(p.0)).collect();
        let w: Vec<f64> = points.iter().map(|p| ln(ln(p.1 * 1e6 + 0.7))).collect();
        let slope: Vec<f64> = (0..x.len())
            .map(|i| i.max(1))
            .map(|hi| (w[hi] - w[hi - 1]) / (x[hi] - x[hi - 1]))
            .collect();
        if slope.iter().any(|slope| *slope < -STEEPEST) {
            return Err(
                "viscosity falls more steeply than that of any oil (slope above 5 in ASTM D341)"
                    .into(),
            );
        }
        Ok(Viscosity { x, w, slope })
    }
}

#[physics]
impl<R: Real> Viscosity<R> {
    /// Kinematic viscosity at a temperature, m2/s.
    pub fn kinematic_m2_s(&self, temp_k: R) -> R {
        self.kinematic_each_m2_s([temp_k])[0]
    }

    /// Kinematic viscosity at several temperatures together, m2/s.
    pub fn kinematic_each_m2_s<const N: usize>(&self, temp_k: [R; N]) -> [R; N] {
        let mut w = R::ln_array(temp_k);
        for x in &mut w {
            *x = self.line(*x);
        }
        let mut nu = R::exp_array(R::exp_array(w));
        for nu in &mut nu {
            *nu = (*nu - 0.7) * 1e-6; // LU-1
        }
        nu
    }

    /// ln ln(nu + 0.7) at ln T.
    fn line(&self, x: R) -> R {
        let mut line = self.w[1] + self.slope[1] * (x - self.x[1]);
        for hi in 2..self.x.len() {
            let beyond = x.ge(self.x[hi - 1]);
            line = beyond.select(self.w[hi] + self.slope[hi] * (x - self.x[hi]), line);
        }
        line
    }
}
