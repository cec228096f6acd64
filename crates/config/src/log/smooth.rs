//! Resolution and noise of a recorded speed, and its smoothing.
//!
//! | label | equation | validity, source |
//! |---|---|---|
//! | LG-1 | a_res = q / dt with the smallest difference q of two speeds that occur and the median step dt | acceleration resolution, as in the trip dynamics of real driving emissions, (EU) 2017/1151, Annex IIIA |
//! | LG-2 | s2 = max(q2/12, (m2 - q_a dt3)/20) with m = median abs(third difference) / 0.6745, the second term for steps up to 0.5 s | variance of an error that is even over q; the third difference of white noise has 20 s2, that of LG-3's motion q_a dt3 |
//! | LG-3 | v minimises sum (y - v)2 / s2 + 1/q_a integral (dv2/dt2)2 dt, q_a = (0.5 m/s2)2/s | mean of a car whose acceleration is a random walk; the rms change of acceleration over 1 s in shipped cycles is 0.11 (HWFET) to 0.62 m/s2 (Artemis urban) |
//! | LG-4 | smoothed where sqrt(2 s2)/dt > 0.1 m/s2 | accelerations below: 1.5 % of 7 m/s2 at full load; a table in 0.1 mph at 1 Hz has 0.02, whole km/h at 1 Hz 0.11, at 10 Hz 1.1 |
//!
//! The regulation smooths by T4253H with Hanning weights. Medians keep the steps of a coarse resolution at a high rate, and at 1 Hz they take away
//! accelerations that are there. With LG-3 fuel stays within 1 % and the difference to the manual car within 0.5 points on UDDS, HWFET and US06 at 10, 4, 2
//! and 1 Hz (tests/cli/commands/log.rs).

use cvtcycle_model::cycle::is_standstill;

/// Density of the change of acceleration (LG-3), (m/s2)2/s.
const CHANGE: f64 = 0.25;
/// Error of an acceleration beyond which speeds are smoothed (LG-4), m/s2.
const MAX_ERROR_M_S2: f64 = 0.1;
/// Values of a table with a coarser resolution are corners, and no recording.
const MAX_RESOLUTION_M_S: f64 = 0.6;
/// Longest step at which the motion of LG-3 is less than noise, s, ...
const MAX_NOISE_STEP_S: f64 = 0.5;
/// ... and up to which noise is only what is beyond the liveliest motion: the third differences of shipped cycles at 1 Hz are up to 0.43 (m/s)2 (Artemis urban),
/// and a noise above half as much again is taken for one.
const MAX_LIVELY_STEP_S: f64 = 1.2;
const LIVELY: f64 = 0.45;
const BEYOND: f64 = 1.6;
/// Most values that are sorted.
const SAMPLE: usize = 200_000;
/// Variance of a speed at standstill, of that of another: a car at rest is at rest.
const AT_REST: f64 = 1e-6;

/// Rate and resolution of a recorded speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// Median step, s.
    pub step_s: f64,
    /// Smallest difference of two speeds, m/s.
    pub speed_m_s: f64,
    /// Standard deviation of the error of a speed (LG-2), m/s.
    pub error_m_s: f64,
}

impl Resolution {
    /// Acceleration resolution (LG-1), m/s2.
    #[must_use]
    pub fn accel_m_s2(&self) -> f64 {
        self.speed_m_s / self.step_s
    }

    /// True where the resolution makes most of the error, and no noise.
    #[must_use]
    pub fn is_rounded(&self) -> bool {
        self.speed_m_s * self.speed_m_s / 12.0 > 0.5 * self.error_m_s * self.error_m_s
    }

    /// True where differences of speeds are noise (LG-4).
    #[must_use]
    pub fn is_coarse(&self) -> bool {
        std::f64::consts::SQRT_2 * self.error_m_s / self.step_s > MAX_ERROR_M_S2
    }

    /// Resolution of the speeds at these times; none of a car at rest, or of corners of a schedule.
    pub(crate) fn of(time_s: &[f64], speed_m_s: &[f64]) -> Option<Resolution> {
        let steps = time_s.windows(2).take(SAMPLE).map(|pair| pair[1] - pair[0]);
        let step_s = median(steps.collect())?;
        let moving = speed_m_s
            .iter()
            .copied()
            .filter(|speed| !is_standstill(*speed));
        let mut speeds: Vec<f64> = moving.take(SAMPLE).collect();
        speeds.sort_by(f64::total_cmp);
        // 1e-6: two numbers that are one before their unit was changed
        speeds.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
        let gaps = speeds.windows(2).map(|pair| pair[1] - pair[0]);
        let speed = gaps.fold(f64::INFINITY, f64::min);
        if speed.is_nan() || speed > MAX_RESOLUTION_M_S {
            return None;
        }
        let mut variance = speed * speed / 12.0;
        if step_s <= MAX_LIVELY_STEP_S {
            let thirds = speed_m_s.windows(4).zip(time_s.windows(4)).take(SAMPLE);
            let even = thirds.filter(|(v, t)| {
                !v.iter().any(|v| is_standstill(*v)) && t[3] - t[0] < 4.5 * step_s
            });
            let thirds = even
                .map(|(v, _)| (v[3] - 3.0 * v[2] + 3.0 * v[1] - v[0]).abs())
                .collect();
            let m = median(thirds).unwrap_or(0.0) / 0.6745;
            let motion = match step_s <= MAX_NOISE_STEP_S {
                true => CHANGE,
                false => LIVELY,
            } * step_s.powi(3);
            // Rounding has its part in them.
            let beyond = m * m - motion - 20.0 * variance;
            if step_s <= MAX_NOISE_STEP_S || beyond > (BEYOND - 1.0) * motion {
                variance = variance.max((m * m - motion) / 20.0);
            }
        }
        Some(Resolution {
            step_s,
            speed_m_s: speed,
            error_m_s: variance.sqrt(),
        })
    }
}

pub(crate) fn median(mut values: Vec<f64>) -> Option<f64> {
    if values.is_empty() {
        return None;
    }
    let middle = values.len() / 2;
    let (_, median, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
    Some(*median)
}

/// Smooths speeds (LG-3), with `factor` times the density of the change of acceleration. The speed of a car at rest is 0.
///
/// A cubic smoothing spline by Reinsch's algorithm, five diagonals of n - 2 unknowns: written here because the crates for it bring sparse matrices of
/// another linear algebra.
pub(super) fn smoothed(time_s: &[f64], speed_m_s: &[f64], error_m_s: f64, factor: f64) -> Vec<f64> {
    let n = time_s.len();
    if n < 4 || error_m_s <= 0.0 {
        return speed_m_s.to_vec();
    }
    let alpha = error_m_s * error_m_s / (CHANGE * factor);
    let h: Vec<f64> = time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let weight = |k: usize| {
        if is_standstill(speed_m_s[k]) {
            AT_REST
        } else {
            1.0
        }
    };
    // Q' is the second divided difference, R the integral of hat functions: (R + alpha Q' W Q) gamma = Q' y, v = y - alpha W Q gamma.
    let q = |j: usize| [1.0 / h[j], -1.0 / h[j] - 1.0 / h[j + 1], 1.0 / h[j + 1]];
    let m = n - 2;
    let (mut d0, mut d1, mut d2, mut x) = (vec![0.0; m], vec![0.0; m], vec![0.0; m], vec![0.0; m]);
    for j in 0..m {
        let own = q(j);
        d0[j] = (h[j] + h[j + 1]) / 3.0
            + alpha * (0..3).map(|k| own[k] * own[k] * weight(j + k)).sum::<f64>();
        if j + 1 < m {
            let next = q(j + 1);
            d1[j] = h[j + 1] / 6.0
                + alpha * (own[1] * next[0] * weight(j + 1) + own[2] * next[1] * weight(j + 2));
        }
        if j + 2 < m {
            d2[j] = alpha * own[2] * q(j + 2)[0] * weight(j + 2);
        }
        x[j] = (0..3).map(|k| own[k] * speed_m_s[j + k]).sum();
    }
    // L D L' of five diagonals, which is positive definite.
    for j in 0..m {
        if j >= 1 {
            d0[j] -= d1[j - 1] * d1[j - 1] * d0[j - 1];
        }
        if j >= 2 {
            d0[j] -= d2[j - 2] * d2[j - 2] * d0[j - 2];
        }
        if j >= 1 {
            d1[j] -= d1[j - 1] * d2[j - 1] * d0[j - 1];
        }
        d1[j] /= d0[j];
        d2[j] /= d0[j];
        if j >= 1 {
            x[j] -= d1[j - 1] * x[j - 1];
        }
        if j >= 2 {
            x[j] -= d2[j - 2] * x[j - 2];
        }
    }
    for j in (0..m).rev() {
        x[j] /= d0[j];
        if j + 1 < m {
            x[j] -= d1[j] * x[j + 1];
        }
        if j + 2 < m {
            x[j] -= d2[j] * x[j + 2];
        }
    }
    let mut smooth = speed_m_s.to_vec();
    for j in 0..m {
        for (k, q) in q(j).into_iter().enumerate() {
            smooth[j + k] -= alpha * weight(j + k) * q * x[j];
        }
    }
    let still = |(own, speed): (f64, &f64)| {
        if is_standstill(*speed) {
            0.0
        } else {
            own.max(0.0)
        }
    };
    smooth.into_iter().zip(speed_m_s).map(still).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the minimum of LG-3 of a straight line is itself; and its gradient is 0, by differences of the function.
    #[test]
    fn a_line_stays_and_the_sum_is_least() {
        let time: Vec<f64> = (0..40)
            .map(|k| 0.3 * f64::from(k) + 0.05 * f64::from(k % 3))
            .collect();
        let line: Vec<f64> = time.iter().map(|t| 5.0 + 0.7 * t).collect();
        for (own, line) in smoothed(&time, &line, 0.1, 1.0).iter().zip(&line) {
            assert!((own - line).abs() < 1e-10);
        }
        let speed: Vec<f64> = (0..40)
            .map(|k| 12.0 + (f64::from(k) * 0.9).sin() + 0.1 * f64::from(k % 2))
            .collect();
        let smooth = smoothed(&time, &speed, 0.3, 1.0);
        // The integral of the natural spline through v: quadratic in v, by the same Q and R solved densely.
        let cost = |v: &[f64]| {
            let n = v.len();
            let h: Vec<f64> = time.windows(2).map(|p| p[1] - p[0]).collect();
            let m = n - 2;
            let mut r = nalgebra_free(m, &h);
            let mut b: Vec<f64> = (0..m)
                .map(|j| (v[j + 2] - v[j + 1]) / h[j + 1] - (v[j + 1] - v[j]) / h[j])
                .collect();
            let c = b.clone();
            solve(&mut r, &mut b);
            let bend: f64 = b.iter().zip(&c).map(|(a, b)| a * b).sum();
            let misfit: f64 = v.iter().zip(&speed).map(|(a, b)| (a - b) * (a - b)).sum();
            misfit / 0.09 + bend / CHANGE
        };
        let least = cost(&smooth);
        for k in 0..smooth.len() {
            for step in [1e-3, -1e-3] {
                let mut other = smooth.clone();
                other[k] += step;
                assert!(cost(&other) > least, "{k}");
            }
        }
    }

    fn nalgebra_free(m: usize, h: &[f64]) -> Vec<Vec<f64>> {
        let mut r = vec![vec![0.0; m]; m];
        for j in 0..m {
            r[j][j] = (h[j] + h[j + 1]) / 3.0;
            if j + 1 < m {
                r[j][j + 1] = h[j + 1] / 6.0;
                r[j + 1][j] = h[j + 1] / 6.0;
            }
        }
        r
    }

    fn solve(a: &mut [Vec<f64>], b: &mut [f64]) {
        for j in 0..b.len() {
            for k in j + 1..b.len() {
                let factor = a[k][j] / a[j][j];
                let own = a[j].clone();
                for (to, from) in a[k].iter_mut().zip(own).skip(j) {
                    *to -= factor * from;
                }
                b[k] -= factor * b[j];
            }
        }
        for j in (0..b.len()).rev() {
            for k in j + 1..b.len() {
                b[j] -= a[j][k] * b[k];
            }
            b[j] /= a[j][j];
        }
    }
}
