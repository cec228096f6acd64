//! Sums of a run by phase, gathered row by row without keeping the rows.

use super::{EnergyTerms, HIGHEST_K, Recorder, Row};
use crate::flags::Flags;
use crate::math::larger;
use crate::transmission::clamp_cause::ClampCause;
use crate::transmission::component::ByComponent;

/// Sums over one phase.
#[derive(Clone, Debug, Default)]
pub struct PhaseTotals {
    /// Duration, s.
    pub duration_s: f64,
    /// Distance, m.
    pub distance_m: f64,
    /// Fuel, kg.
    pub fuel_kg: f64,
    /// Fuel at standstill, kg.
    pub standstill_fuel_kg: f64,
    /// Demanded wheel work in drive, J.
    pub wheel_positive_j: f64,
    /// Demanded wheel work in braking, J.
    pub wheel_negative_j: f64,
    /// Loss of each component, J.
    pub loss_j: ByComponent<f64>,
    /// Ledger terms, J.
    pub terms: EnergyTerms,
}

/// Largest value of the rows that were looked at, and when.
#[derive(Clone, Copy, Debug)]
pub struct Extreme {
    /// Value; minus infinity if no row was looked at.
    pub value: f64,
    /// End of its row, s; NaN without one.
    pub at_s: f64,
}

impl Default for Extreme {
    fn default() -> Self {
        Extreme {
            value: f64::NEG_INFINITY,
            at_s: f64::NAN,
        }
    }
}

impl Extreme {
    fn see(&mut self, value: f64, at_s: f64) {
        if value > self.value {
            *self = Extreme { value, at_s };
        }
    }
}

/// Sums and extremes over a whole run.
#[derive(Clone, Debug, Default)]
pub struct Totals {
    /// By phase index of the cycle.
    pub phases: Vec<PhaseTotals>,
    /// Largest ledger error of any row, both ledgers.
    pub ledger_error: f64,
    /// Smallest clamp safety factor, infinite if never loaded.
    pub min_clamp_safety: f64,
    /// Time of that row's end, s.
    pub min_clamp_at_s: f64,
    /// Time with each flag, s, in the order of [`Flags::NAMES`].
    pub flag_s: [f64; Flags::NAMES.len()],
    /// Moving time in which each cause decided the secondary pressure, s, in the order of [`ClampCause::NAMES`].
    pub clamp_cause_s: [f64; ClampCause::NAMES.len()],
    /// Worst missing power, W.
    pub worst_deficit_w: f64,
    /// Torque at the wheels missing there, Nm.
    pub worst_deficit_nm: f64,
    /// End of the row with the worst deficit, s.
    pub worst_deficit_at_s: f64,
    /// Highest engine speed of the rows above its limit, rad/s.
    pub fastest_rad_s: Extreme,
    /// Highest temperatures of the rows that are too hot, K, in the order of [`HIGHEST_K`].
    pub hottest_k: [Extreme; HIGHEST_K.len()],
    /// End of the first row with a gear that the cycle does not prescribe, s.
    pub wrong_gear_at_s: f64,
    /// Time in which torque, speed, fuel or a temperature was no number, s.
    pub not_finite_s: f64,
    /// End of the first such row, s.
    pub not_finite_at_s: f64,
    /// Largest residual of the implicit solve.
    pub worst_residual: f64,
    /// Evaluations of the driveline.
    pub evaluations: u64,
    /// Rows.
    pub rows: u64,
}

impl Totals {
    /// Empty sums for a number of phases.
    pub fn new(phases: usize) -> Self {
        Totals {
            phases: vec![PhaseTotals::default(); phases.max(1)],
            min_clamp_safety: f64::INFINITY,
            min_clamp_at_s: f64::NAN,
            worst_deficit_at_s: f64::NAN,
            wrong_gear_at_s: f64::NAN,
            not_finite_at_s: f64::NAN,
            ..Totals::default()
        }
    }

    /// Seconds with a flag.
    pub fn seconds(&self, flag: Flags) -> f64 {
        Flags::NAMES
            .iter()
            .zip(&self.flag_s)
            .filter(|((f, _), _)| *f == flag)
            .map(|(_, s)| s)
            .sum()
    }

    /// Sums over some phases.
    pub fn over(&self, phases: &[u16]) -> PhaseTotals {
        let mut sum = PhaseTotals::default();
        for p in phases
            .iter()
            .filter_map(|&k| self.phases.get(usize::from(k)))
        {
            sum.add(p);
        }
        sum
    }

    /// Sums over the whole run.
    pub fn total(&self) -> PhaseTotals {
        let mut sum = PhaseTotals::default();
        for p in &self.phases {
            sum.add(p);
        }
        sum
    }

    #[inline(always)]
    fn extremes(&mut self, row: &Row) {
        let error = larger(row.power_ledger_error, row.heat_ledger_error);
        // A ledger error that is not a number must not hide.
        if error.is_nan() || error > self.ledger_error {
            self.ledger_error = error;
        }
        if row.clamp_safety < self.min_clamp_safety {
            (self.min_clamp_safety, self.min_clamp_at_s) = (row.clamp_safety, row.time_s);
        }
        if row.deficit_w > self.worst_deficit_w && row.flags.contains(Flags::MISSED_TRACE) {
            (self.worst_deficit_w, self.worst_deficit_at_s) = (row.deficit_w, row.time_s);
            self.worst_deficit_nm = row.deficit_w * row.wheel_torque_nm / row.wheel_power_w;
        }
        if row.solve_residual.is_nan() || row.solve_residual > self.worst_residual {
            self.worst_residual = row.solve_residual;
        }
        if row.flags.any(Flags::IMPOSSIBLE) {
            let temps_k = [row.coolant_k, row.engine_oil_k, row.sump_k]; // in the order of HIGHEST_K
            self.impossible(row.flags, row.time_s, row.engine_speed_rad_s, temps_k);
        }
        // One sum, so that a row pays for one test.
        let sum = row.engine_torque_nm
            + row.engine_speed_rad_s
            + row.fuel_kg_s
            + (row.coolant_k + row.engine_oil_k + row.sump_k + row.metal_k);
        if !sum.is_finite() {
            if self.not_finite_at_s.is_nan() {
                self.not_finite_at_s = row.time_s;
            }
            self.not_finite_s += row.dt_s;
        }
    }

    // Numbers and no row, so that none has to be put together for this rare case.
    #[cold]
    fn impossible(
        &mut self,
        flags: Flags,
        at_s: f64,
        engine_rad_s: f64,
        temps_k: [f64; HIGHEST_K.len()],
    ) {
        if flags.contains(Flags::OVERSPEED) {
            self.fastest_rad_s.see(engine_rad_s, at_s);
        }
        if flags.contains(Flags::TOO_HOT) {
            for (extreme, temp_k) in self.hottest_k.iter_mut().zip(temps_k) {
                extreme.see(temp_k, at_s);
            }
        }
        if flags.contains(Flags::WRONG_GEAR) && self.wrong_gear_at_s.is_nan() {
            self.wrong_gear_at_s = at_s;
        }
    }
}

impl PhaseTotals {
    fn add(&mut self, other: &PhaseTotals) {
        self.duration_s += other.duration_s;
        self.distance_m += other.distance_m;
        self.fuel_kg += other.fuel_kg;
        self.standstill_fuel_kg += other.standstill_fuel_kg;
        self.wheel_positive_j += other.wheel_positive_j;
        self.wheel_negative_j += other.wheel_negative_j;
        for (s, o) in self.loss_j.iter_mut().zip(other.loss_j) {
            *s += o;
        }
        self.terms.add(&other.terms, 1.0);
    }
}

impl Recorder for Totals {
    // Within the loop, so that the parts of a row that no total looks at are never put together.
    #[inline(always)]
    fn record(&mut self, row: &Row, terms: &EnergyTerms) {
        let index = usize::from(row.phase).min(self.phases.len() - 1);
        let p = &mut self.phases[index];
        p.duration_s += row.dt_s;
        p.distance_m += row.distance_m;
        p.fuel_kg += row.fuel_kg_s * row.dt_s;
        if row.speed_m_s <= 0.0 {
            p.standstill_fuel_kg += row.fuel_kg_s * row.dt_s;
        }
        p.wheel_positive_j += row.wheel_work_positive_j;
        p.wheel_negative_j += row.wheel_work_negative_j;
        for (s, w) in p.loss_j.iter_mut().zip(row.loss_w) {
            *s += w * row.dt_s;
        }
        p.terms.add(terms, row.dt_s);
        if row.speed_m_s > 0.0 {
            self.clamp_cause_s[row.clamp_cause as usize] += row.dt_s;
        }
        let mut left = row.flags.0;
        while left != 0 {
            let bit = left.trailing_zeros() as usize; // flags are in the order of their bits
            if let Some(seconds) = self.flag_s.get_mut(bit) {
                *seconds += row.dt_s;
            }
            left &= left - 1;
        }
        self.evaluations += u64::from(row.iterations);
        self.rows += 1;
        self.extremes(row);
    }
}
