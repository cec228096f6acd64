//! Summary of a curve of slip against torque, and the resolution of the rig.

use super::{Held, MAX_OUTPUT_NM, VariatorRig, VariatorRow};
use crate::math::larger;

/// Slip whose torque is looked for: the largest that the thesis reports (6.4).
const THREE_PERCENT: f64 = 0.03;
/// Points of a scan along a curve.
const POINTS: u32 = 400;

/// One curve in numbers; slips are fractions, NaN where there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveSummary {
    /// Values held.
    pub held: Held,
    /// Torque at which the compression between segments changes sign, Nm.
    pub breakpoint_nm: f64,
    /// Torque that the clamping forces carry, Nm.
    pub capacity_nm: f64,
    /// Slip at zero torque.
    pub slip_at_zero: f64,
    /// Slip at the breakpoint, where it lies at a torque above zero.
    pub slip_at_breakpoint: f64,
    /// Slip at capacity.
    pub slip_at_capacity: f64,
    /// Largest slip within the rig's limits and below capacity.
    pub most_slip: f64,
    /// Torque, Nm.
    pub most_slip_nm: f64,
    /// Largest primary and secondary slip speed there, m/s.
    pub most_slip_m_s: [f64; 2],
    /// Torque at 3 % slip, Nm, below capacity.
    pub three_percent_nm: f64,
    /// Primary and secondary slip speed there, m/s.
    pub three_percent_m_s: [f64; 2],
    /// Coefficient of determination of a straight line through slip against torque, from the breakpoint (or zero) to 3 % slip.
    pub measured_r2: f64,
    /// The same up to capacity.
    pub capacity_r2: f64,
}

impl VariatorRig {
    /// A curve in numbers.
    pub fn summary(&self, held: &Held) -> CurveSummary {
        let slip = |torque: f64| self.rows(held, &[torque])[0].belt.losses.slip_total;
        let breakpoint_nm = self.breakpoint_nm(held);
        let capacity_nm = self.rows(held, &[0.0])[0].belt.losses.capacity_nm;
        let from = larger(breakpoint_nm, 0.0);
        let scan = |low: f64, high: f64| -> Vec<VariatorRow> {
            let torques: Vec<f64> = (0..=POINTS)
                .map(|i| low + (high - low) * f64::from(i) / f64::from(POINTS))
                .collect();
            self.rows(held, &torques)
        };
        let within = scan(0.0, capacity_nm.min(MAX_OUTPUT_NM));
        let fine: Vec<&VariatorRow> = within.iter().filter(|row| row.flags.is_fine()).collect();
        let most = fine.iter().max_by(|a, b| {
            a.belt
                .losses
                .slip_total
                .total_cmp(&b.belt.losses.slip_total)
        });
        let most_of =
            |get: fn(&VariatorRow) -> f64| fine.iter().map(|row| get(row)).fold(f64::NAN, f64::max);
        let line = |to: f64| {
            let points: Vec<(f64, f64)> = scan(from, to)
                .iter()
                .map(|row| (row.output_nm, row.belt.losses.slip_total))
                .collect();
            determination(&points)
        };
        let three_percent_nm = crossing(from, capacity_nm, |torque| slip(torque) - THREE_PERCENT);
        CurveSummary {
            held: *held,
            breakpoint_nm,
            capacity_nm,
            slip_at_zero: slip(0.0),
            slip_at_breakpoint: if breakpoint_nm > 0.0 {
                slip(breakpoint_nm)
            } else {
                f64::NAN
            },
            slip_at_capacity: slip(capacity_nm),
            most_slip: most.map_or(f64::NAN, |row| row.belt.losses.slip_total),
            most_slip_nm: most.map_or(f64::NAN, |row| row.output_nm),
            most_slip_m_s: [
                most_of(|row| row.slip_m_s()[0]),
                most_of(|row| row.slip_m_s()[1]),
            ],
            three_percent_nm,
            three_percent_m_s: if three_percent_nm.is_nan() {
                [f64::NAN; 2]
            } else {
                self.rows(held, &[three_percent_nm])[0].slip_m_s()
            },
            measured_r2: if three_percent_nm.is_nan() {
                f64::NAN
            } else {
                line(three_percent_nm)
            },
            capacity_r2: line(capacity_nm),
        }
    }
}

/// Where a function changes from below to above zero, by bisection; NaN where it does not.
fn crossing(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    if !(f(low) <= 0.0 && f(high) >= 0.0) {
        return f64::NAN;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if f(middle) > 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    0.5 * (low + high)
}

/// Coefficient of determination R2 of the least-squares line through points.
fn determination(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let mean = |get: fn(&(f64, f64)) -> f64| points.iter().map(get).sum::<f64>() / n;
    let (mx, my) = (mean(|p| p.0), mean(|p| p.1));
    let sum =
        |f: &dyn Fn(f64, f64) -> f64| points.iter().map(|(x, y)| f(x - mx, y - my)).sum::<f64>();
    let (sxy, sxx, syy) = (sum(&|x, y| x * y), sum(&|x, _| x * x), sum(&|_, y| y * y));
    sxy * sxy / (sxx * syy)
}

/// How finely the rig's counters read a state (thesis 6.3.1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// Time of one measurement, s: 10 s in high ratio, 100 belt turns in low.
    pub gate_s: f64,
    /// True for a gate of 100 belt turns; otherwise 10 s, in which segments are counted.
    pub belt_turns: bool,
    /// Segments counted in the gate; none where belt turns make the gate.
    pub segments: f64,
    /// Turns of primary and secondary in the gate.
    pub turns: [f64; 2],
    /// Slip that one pulse more of primary and of secondary means, as fractions.
    pub slip_per_pulse: [f64; 2],
    /// Belt speed that one segment more means, as a fraction; none in low ratio.
    pub belt_per_segment: f64,
}

impl Resolution {
    /// Resolution at the state of a row, with a number of pulses a turn of the shafts.
    pub fn new(row: &VariatorRow, belt_length_m: f64, segment_m: f64, pulses: f64) -> Self {
        let belt_turns = row.held.ratio > 1.0;
        let gate_s = if belt_turns {
            100.0 * belt_length_m / row.belt_m_s
        } else {
            10.0
        };
        let turns = row
            .shaft_rad_s
            .map(|w| w * gate_s / (2.0 * std::f64::consts::PI));
        let segments = if belt_turns {
            f64::NAN
        } else {
            row.belt_m_s * gate_s / segment_m
        };
        Resolution {
            gate_s,
            belt_turns,
            segments,
            turns,
            slip_per_pulse: turns.map(|n| 1.0 / (n * pulses)),
            belt_per_segment: 1.0 / segments,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hand calculation: points on a line have R2 = 1; of (0, 0), (1, 1), (2, 0) nothing is explained.
    #[test]
    fn val_determination() {
        assert!((determination(&[(1.0, 3.0), (2.0, 5.0), (4.0, 9.0)]) - 1.0).abs() < 1e-12);
        assert!(determination(&[(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)]).abs() < 1e-12);
    }

    #[test]
    fn crossings_are_found_or_not_a_number() {
        assert!((crossing(0.0, 4.0, |x| x * x - 4.0) - 2.0).abs() < 1e-12);
        assert!(crossing(0.0, 1.0, |x| x - 4.0).is_nan());
        assert!(crossing(5.0, 9.0, |x| x - 4.0).is_nan());
    }
}
