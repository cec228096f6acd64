//! Slopes from heights.

use super::samples::Samples;

/// Length of road on either side over which a slope is taken from heights, m.
const SLOPE_M: f64 = 100.0;
/// Steepest slope, rise over run.
const STEEPEST: f64 = 0.35;

/// Slopes from heights: the line of least squares through the heights within 100 m of road on either side, of which each metre counts once. Returns
/// slopes, and how many rows were above the steepest road and are set to it.
pub(super) fn slopes(samples: &Samples, altitude_m: &[f64]) -> (Vec<f64>, usize) {
    /// Mean height of a metre of road.
    struct Point {
        road_m: f64,
        sum_m: f64,
        count: f64,
    }
    let mut points: Vec<Point> = Vec::new();
    let mut point_of = Vec::with_capacity(altitude_m.len());
    let mut road_m = 0.0;
    for (k, height) in altitude_m.iter().enumerate() {
        if k > 0 {
            road_m += 0.5 * (samples.speed_m_s[k] + samples.speed_m_s[k - 1]) * samples.step(k - 1);
        }
        if height.is_finite() {
            match points.last_mut().filter(|last| road_m - last.road_m < 1.0) {
                Some(last) => (last.sum_m, last.count) = (last.sum_m + height, last.count + 1.0),
                None => points.push(Point {
                    road_m,
                    sum_m: *height,
                    count: 1.0,
                }),
            }
        }
        point_of.push(points.len().saturating_sub(1));
    }
    let (mut low, mut high) = (0, 0);
    let mut of_points: Vec<f64> = Vec::with_capacity(points.len());
    for own in &points {
        while high < points.len() && points[high].road_m <= own.road_m + SLOPE_M {
            high += 1;
        }
        while points[low].road_m < own.road_m - SLOPE_M {
            low += 1;
        }
        let window = &points[low..high];
        let mean =
            |of: &dyn Fn(&Point) -> f64| window.iter().map(of).sum::<f64>() / window.len() as f64;
        let (x, y) = (
            mean(&|p| p.road_m - own.road_m),
            mean(&|p| p.sum_m / p.count),
        );
        let xx = mean(&|p| (p.road_m - own.road_m - x).powi(2));
        let xy = mean(&|p| (p.road_m - own.road_m - x) * (p.sum_m / p.count - y));
        // Less than some metres of road have no slope of their own.
        of_points.push(match window.len() >= 3 && xx > 25.0 {
            true => xy / xx,
            false => of_points.last().copied().unwrap_or(0.0),
        });
    }
    let slope = |point: &usize| of_points.get(*point).copied().unwrap_or(0.0);
    let steep = point_of
        .iter()
        .filter(|point| slope(point).abs() > STEEPEST)
        .count();
    (
        point_of
            .iter()
            .map(|point| slope(point).clamp(-STEEPEST, STEEPEST))
            .collect(),
        steep,
    )
}
