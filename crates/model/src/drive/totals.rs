//! Sums of a run by phase, gathered row by row without keeping the rows.
//!
//! | label | statement | status |
//! |---|---|---|
//! | TS-1 | e^2 = sum (m_i - m_(i-1))^2 h_i^2/12, m fuel flow of rows, h_i the longer of both steps: standard deviation of the fuel where each change between two rows falls anywhere within a step | derived: a uniform distribution over h has h^2/12; of first order, as changes of a drive stay as many; held against steps of 0.05 s by a test |

use super::{EnergyTerms, HIGHEST_K, Recorder, Row, TERM_NAMES};
use crate::flags::Flags;
use crate::math::{Mask, Real, larger, physics};
use crate::transmission::clamp_cause::ClampCause;
use crate::transmission::component::{ByComponent, Component};

/// Sums over one phase.
#[derive(Clone, Debug, Default)]
pub struct PhaseTotals<R: Real = f64> {
    /// Duration, s.
    pub duration_s: f64,
    /// Distance, m.
    pub distance_m: f64,
    /// Fuel, kg.
    pub fuel_kg: R,
    /// Fuel at standstill, kg.
    pub standstill_fuel_kg: R,
    /// Demanded wheel work in drive, J.
    pub wheel_positive_j: R,
    /// Demanded wheel work in braking, J.
    pub wheel_negative_j: R,
    /// Loss of each component, J.
    pub loss_j: ByComponent<R>,
    /// Ledger terms, J.
    pub terms: EnergyTerms<R>,
}

/// Largest value of the rows that were looked at, and when.
#[derive(Clone, Copy, Debug, PartialEq)]
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
pub struct Totals<R: Real = f64> {
    /// By phase index of the cycle.
    pub phases: Vec<PhaseTotals<R>>,
    /// Largest ledger error of any row, both ledgers.
    pub ledger_error: R,
    /// Smallest clamp safety factor, infinite if never loaded.
    pub min_clamp_safety: R,
    /// Time of that row's end, s.
    pub min_clamp_at_s: R,
    /// Time with each flag, s, in the order of [`Flags::NAMES`].
    pub flag_s: R::PerLane<[f64; Flags::NAMES.len()]>,
    /// Moving time in which each cause decided the secondary pressure, s, in the order of [`ClampCause::NAMES`].
    pub clamp_cause_s: R::PerLane<[f64; ClampCause::NAMES.len()]>,
    /// Worst missing power, W.
    pub worst_deficit_w: R,
    /// Torque at the wheels missing there, Nm.
    pub worst_deficit_nm: R,
    /// End of the row with the worst deficit, s.
    pub worst_deficit_at_s: R,
    /// Highest engine speed of the rows above its limit, rad/s.
    pub fastest_rad_s: R::PerLane<Extreme>,
    /// Highest temperatures of the rows that are too hot, K, in the order of [`HIGHEST_K`].
    pub hottest_k: R::PerLane<[Extreme; HIGHEST_K.len()]>,
    /// End of the first row with a gear that the cycle does not prescribe, s.
    pub wrong_gear_at_s: R::PerLane<f64>,
    /// Time in which torque, speed, fuel or a temperature was no number, s.
    pub not_finite_s: R::PerLane<f64>,
    /// End of the first such row, s.
    pub not_finite_at_s: R::PerLane<f64>,
    /// Largest residual of the implicit solve.
    pub worst_residual: R,
    /// Sum over the rows of the square of the change of fuel flow from the row before, times the length of the longer of both, kg2 (TS-1).
    pub fuel_change_kg2: R,
    /// Fuel flow, kg/s, and length, s, of the last row.
    pub last: (R, f64),
    /// Evaluations of the driveline.
    pub evaluations: R::PerLane<u64>,
    /// Rows.
    pub rows: u64,
}

impl Totals {
    /// Empty sums for a number of phases.
    pub fn new(phases: usize) -> Self {
        Totals::like(0.0, phases)
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

    /// Estimate of the error of the fuel by the length of the steps, kg (TS-1).
    pub fn step_error_kg(&self) -> f64 {
        (self.fuel_change_kg2 / 12.0).sqrt()
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

impl<R: Real> PhaseTotals<R> {
    /// Empty sums for the runs of a number.
    fn like(zero: R) -> Self {
        PhaseTotals {
            duration_s: 0.0,
            distance_m: 0.0,
            fuel_kg: zero,
            standstill_fuel_kg: zero,
            wheel_positive_j: zero,
            wheel_negative_j: zero,
            loss_j: ByComponent([zero; Component::COUNT]),
            terms: EnergyTerms::from_array([zero; TERM_NAMES.len()]),
        }
    }

    /// Those of one run.
    fn of_run(&self, run: usize) -> PhaseTotals {
        PhaseTotals {
            duration_s: self.duration_s,
            distance_m: self.distance_m,
            fuel_kg: self.fuel_kg.lane(run),
            standstill_fuel_kg: self.standstill_fuel_kg.lane(run),
            wheel_positive_j: self.wheel_positive_j.lane(run),
            wheel_negative_j: self.wheel_negative_j.lane(run),
            loss_j: self.loss_j.map(|loss| loss.lane(run)),
            terms: EnergyTerms::from_array(self.terms.as_array().map(|term| term.lane(run))),
        }
    }
}

impl<R: Real> Totals<R> {
    /// Empty sums for the runs of a number, for a number of phases.
    pub fn like(number: R, phases: usize) -> Self {
        let (zero, none) = (number.splat(0.0), number.splat(f64::NAN));
        Totals {
            phases: vec![PhaseTotals::like(zero); phases.max(1)],
            ledger_error: zero,
            min_clamp_safety: zero.splat(f64::INFINITY),
            min_clamp_at_s: none,
            flag_s: R::per_lane(|_| [0.0; Flags::NAMES.len()]),
            clamp_cause_s: R::per_lane(|_| [0.0; ClampCause::NAMES.len()]),
            worst_deficit_w: zero,
            worst_deficit_nm: zero,
            worst_deficit_at_s: none,
            fastest_rad_s: R::per_lane(|_| Extreme::default()),
            hottest_k: R::per_lane(|_| [Extreme::default(); HIGHEST_K.len()]),
            wrong_gear_at_s: R::per_lane(|_| f64::NAN),
            not_finite_s: R::per_lane(|_| 0.0),
            not_finite_at_s: R::per_lane(|_| f64::NAN),
            worst_residual: zero,
            fuel_change_kg2: zero,
            last: (zero, 0.0),
            evaluations: R::per_lane(|_| 0),
            rows: 0,
        }
    }

    /// Those of one run.
    pub fn of_run(&self, run: usize) -> Totals {
        Totals {
            phases: self.phases.iter().map(|phase| phase.of_run(run)).collect(),
            ledger_error: self.ledger_error.lane(run),
            min_clamp_safety: self.min_clamp_safety.lane(run),
            min_clamp_at_s: self.min_clamp_at_s.lane(run),
            flag_s: *R::get(&self.flag_s, run),
            clamp_cause_s: *R::get(&self.clamp_cause_s, run),
            worst_deficit_w: self.worst_deficit_w.lane(run),
            worst_deficit_nm: self.worst_deficit_nm.lane(run),
            worst_deficit_at_s: self.worst_deficit_at_s.lane(run),
            fastest_rad_s: *R::get(&self.fastest_rad_s, run),
            hottest_k: *R::get(&self.hottest_k, run),
            wrong_gear_at_s: *R::get(&self.wrong_gear_at_s, run),
            not_finite_s: *R::get(&self.not_finite_s, run),
            not_finite_at_s: *R::get(&self.not_finite_at_s, run),
            worst_residual: self.worst_residual.lane(run),
            fuel_change_kg2: self.fuel_change_kg2.lane(run),
            last: (self.last.0.lane(run), self.last.1),
            evaluations: *R::get(&self.evaluations, run),
            rows: self.rows,
        }
    }
}

#[physics]
impl<R: Real> Totals<R> {
    fn extremes(&mut self, row: &Row<R>) {
        let at_s = row.deficit_w.splat(row.time_s);
        let error = row.power_ledger_error.max(row.heat_ledger_error);
        // A ledger error that is not a number must not hide.
        let worse = error.gt(self.ledger_error) | !error.ge(error);
        self.ledger_error = worse.select(error, self.ledger_error);
        let weaker = self.min_clamp_safety.gt(row.clamp_safety);
        self.min_clamp_safety = weaker.select(row.clamp_safety, self.min_clamp_safety);
        self.min_clamp_at_s = weaker.select(at_s, self.min_clamp_at_s);
        let lacks = row.deficit_w.gt(self.worst_deficit_w);
        if lacks.any() {
            self.deficit(row, lacks, at_s);
        }
        let residual = row.solve_residual;
        let worse = residual.gt(self.worst_residual) | !residual.ge(residual);
        self.worst_residual = worse.select(residual, self.worst_residual);
        // One sum, so that a row pays for one test.
        let sum = row.engine_torque_nm
            + row.engine_speed_rad_s
            + row.fuel_kg_s
            + (row.coolant_k + row.engine_oil_k + row.sump_k + row.metal_k);
        let is_finite = sum.splat(f64::MAX).ge(sum.abs());
        for run in 0..R::LANES {
            if R::get(&row.flags, run).any(Flags::IMPOSSIBLE) {
                let temps_k = [row.coolant_k, row.engine_oil_k, row.sump_k]; // in the order of HIGHEST_K
                let speed_rad_s = row.engine_speed_rad_s.lane(run);
                let temps_k = temps_k.map(|temp_k| temp_k.lane(run));
                self.impossible(
                    run,
                    *R::get(&row.flags, run),
                    row.time_s,
                    speed_rad_s,
                    temps_k,
                );
            }
        }
        if (!is_finite).any() {
            for run in (0..R::LANES).filter(|run| !is_finite.lane(*run)) {
                let first_s = R::get_mut(&mut self.not_finite_at_s, run);
                *first_s = if first_s.is_nan() {
                    row.time_s
                } else {
                    *first_s
                };
                lengthen(R::get_mut(&mut self.not_finite_s, run), row.dt_s);
            }
        }
    }

    /// The worst deficit of the runs that miss the trace.
    fn deficit(&mut self, row: &Row<R>, lacks: R::Mask, at_s: R) {
        let misses = |run| R::get(&row.flags, run).contains(Flags::FULL_LOAD);
        let lacks = lacks & at_s.mask_lanes(misses);
        let nm = row.deficit_w * row.wheel_torque_nm / row.wheel_power_w;
        self.worst_deficit_w = lacks.select(row.deficit_w, self.worst_deficit_w);
        self.worst_deficit_at_s = lacks.select(at_s, self.worst_deficit_at_s);
        self.worst_deficit_nm = lacks.select(nm, self.worst_deficit_nm);
    }

    // Numbers and no row, so that none has to be put together for this rare case.
    #[cold]
    #[inline(never)]
    fn impossible(
        &mut self,
        run: usize,
        flags: Flags,
        at_s: f64,
        engine_rad_s: f64,
        temps_k: [f64; HIGHEST_K.len()],
    ) {
        if flags.contains(Flags::OVERSPEED) {
            R::get_mut(&mut self.fastest_rad_s, run).see(engine_rad_s, at_s);
        }
        if flags.contains(Flags::TOO_HOT) {
            let hottest = R::get_mut(&mut self.hottest_k, run);
            for (extreme, temp_k) in hottest.iter_mut().zip(temps_k) {
                extreme.see(temp_k, at_s);
            }
        }
        let first_s = R::get_mut(&mut self.wrong_gear_at_s, run);
        if flags.contains(Flags::WRONG_GEAR) && first_s.is_nan() {
            *first_s = at_s;
        }
    }
}

/// Adds to a time that is one run's own.
#[physics]
fn lengthen(time_s: &mut f64, by_s: f64) {
    *time_s += by_s;
}

#[physics]
impl<R: Real> Recorder<R> for Totals<R> {
    // Within the loop, so that the parts of a row that no total looks at are never put together.
    fn record(&mut self, row: &Row<R>, terms: &EnergyTerms<R>) {
        let index = usize::from(row.phase).min(self.phases.len() - 1);
        let p = &mut self.phases[index];
        lengthen(&mut p.duration_s, row.dt_s);
        lengthen(&mut p.distance_m, row.distance_m);
        let fuel_kg = row.fuel_kg_s * row.dt_s;
        p.fuel_kg = p.fuel_kg + fuel_kg;
        let (last_kg_s, last_s) = self.last;
        if last_s > 0.0 {
            let change_kg = (row.fuel_kg_s - last_kg_s) * larger(row.dt_s, last_s);
            self.fuel_change_kg2 = self.fuel_change_kg2 + change_kg * change_kg;
        }
        self.last = (row.fuel_kg_s, row.dt_s);
        if row.rests() {
            p.standstill_fuel_kg = p.standstill_fuel_kg + fuel_kg;
        }
        p.wheel_positive_j = p.wheel_positive_j + row.wheel_work_positive_j;
        p.wheel_negative_j = p.wheel_negative_j + row.wheel_work_negative_j;
        for (s, w) in p.loss_j.iter_mut().zip(&row.loss_w) {
            *s = *s + *w * row.dt_s;
        }
        p.terms.add(terms, row.dt_s);
        for run in 0..R::LANES {
            if !row.rests() {
                let cause = *R::get(&row.clamp_cause, run) as usize;
                lengthen(
                    &mut R::get_mut(&mut self.clamp_cause_s, run)[cause],
                    row.dt_s,
                );
            }
            let mut left = R::get(&row.flags, run).0;
            while left != 0 {
                let bit = left.trailing_zeros() as usize; // flags are in the order of their bits
                if let Some(seconds) = R::get_mut(&mut self.flag_s, run).get_mut(bit) {
                    lengthen(seconds, row.dt_s);
                }
                left &= left - 1;
            }
            *R::get_mut(&mut self.evaluations, run) += u64::from(*R::get(&row.iterations, run));
        }
        self.rows += 1;
        self.extremes(row);
    }
}
