//! Kinematic viscosity in the coordinates of ASTM D341 (LU-1): straight lines between points, the end lines continued.

use crate::math::{exp_each, ln_each};

/// Steepest fall of ln ln(nu + 0.7) over ln T. Usual oils have 2.5 to 4; the steepest that is sold, a polyphenyl ether, 4.6. A slip of the pen
/// beyond it would be solid in the cold.
const STEEPEST: f64 = 5.0;

/// ln ln(nu + 0.7) against ln T: one line from two points, or a polyline through a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Viscosity {
    /// ln T of the points, rising.
    x: Vec<f64>,
    /// Value ln ln(nu + 0.7) of the points, nu in mm2/s.
    w: Vec<f64>,
    /// Slope of the line that ends at each point; the first point has the second's.
    slope: Vec<f64>,
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
        let x: Vec<f64> = points.iter().map(|p| p.0.ln()).collect();
        let w: Vec<f64> = points.iter().map(|p| (p.1 * 1e6 + 0.7).ln().ln()).collect();
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

    /// Kinematic viscosity at a temperature, m2/s.
    #[must_use]
    #[inline]
    pub fn kinematic_m2_s(&self, temp_k: f64) -> f64 {
        self.kinematic_each_m2_s([temp_k])[0]
    }

    /// Kinematic viscosity at several temperatures together, m2/s.
    #[must_use]
    #[inline]
    pub fn kinematic_each_m2_s<const N: usize>(&self, temp_k: [f64; N]) -> [f64; N] {
        let w = ln_each(temp_k).map(|x| self.line(x));
        exp_each(exp_each(w)).map(|nu| (nu - 0.7) * 1e-6) // LU-1
    }

    /// ln ln(nu + 0.7) at ln T.
    #[inline(always)]
    fn line(&self, x: f64) -> f64 {
        let last = self.x.len() - 1;
        let hi = if last == 1 {
            1
        } else {
            self.x.partition_point(|&p| p <= x).clamp(1, last)
        };
        self.w[hi] + self.slope[hi] * (x - self.x[hi])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A worked example of the standard: 32 mm2/s at 40 degC and 5.4 at 100 degC give 8.5 at 80 degC.
    #[test]
    fn val_d341_worked_example() {
        let v = Viscosity::new(&[(313.15, 32e-6), (373.15, 5.4e-6)]).expect("valid");
        assert!((v.kinematic_m2_s(353.15) * 1e6 - 8.5).abs() < 0.05);
        assert!((v.kinematic_m2_s(313.15) * 1e6 - 32.0).abs() < 1e-9);
    }

    /// The project's table of fluid facts: 36 / 7.2 mm2/s gives 519 at -10, 258 at 0, 84 at 20 and 11.0 at 80 degC.
    #[test]
    fn val_cvt_fluid_class() {
        let v = Viscosity::new(&[(313.15, 36e-6), (373.15, 7.2e-6)]).expect("valid");
        for (t_c, nu) in [(-10.0, 519.0), (0.0, 258.0), (20.0, 84.0), (80.0, 11.0)] {
            let got = v.kinematic_m2_s(t_c + 273.15) * 1e6;
            assert!(
                (got / nu - 1.0).abs() < 0.005,
                "{t_c} degC: {got} instead of {nu}"
            );
        }
    }

    #[test]
    fn table_goes_through_its_points_and_falls_everywhere() {
        let points = [
            (233.15, 12000e-6),
            (263.15, 600e-6),
            (313.15, 36e-6),
            (373.15, 7.2e-6),
        ];
        let v = Viscosity::new(&points).expect("valid");
        for (t, nu) in points {
            assert!((v.kinematic_m2_s(t) / nu - 1.0).abs() < 1e-9);
        }
        let mut last = f64::INFINITY;
        for i in 0..400 {
            let nu = v.kinematic_m2_s(230.0 + 0.5 * f64::from(i));
            assert!(nu < last);
            last = nu;
        }
    }

    #[test]
    fn refuses_rising_viscosity() {
        assert!(Viscosity::new(&[(313.15, 7e-6), (373.15, 36e-6)]).is_err());
        assert!(Viscosity::new(&[(313.15, 7e-6)]).is_err());
    }
}
