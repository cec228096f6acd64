//! Expected reduction of variance by knowing a factor: the choice of the next test.

use serde::Serialize;

use super::Column as Found;
use super::levels::value;
use crate::design::{Role, saltelli_role};
use crate::plan::{Factor, FactorValue, Plan};
use crate::statistics::{
    Column, Confidence, Estimate, Shares, SobolIndices, Summary, sd_left, shares as from_draws,
};
use cvtcycle_config::Problem;

/// Draws from which shares are computed at most: more would cost time and tell nothing that can be seen.
const MAX_DRAWS: usize = 1 << 13;

/// Spread of an output that remains when a factor is known.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Information {
    /// Number of draws, or of samples of a Saltelli design.
    pub n: usize,
    /// Standard deviation of the output.
    pub sd: f64,
    /// Share of the variance, found by groups of draws, that the largest of as many idle factors reaches.
    pub noise: f64,
    /// The factors, the largest share first.
    pub factors: Vec<KnownFactor>,
}

/// Effect of knowing one factor.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KnownFactor {
    /// Name of the factor.
    pub name: String,
    /// The test that would tell it, in the words of the plan; may be empty.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub test: String,
    /// Share of the variance that goes with it alone.
    pub share: Estimate,
    /// Standard deviation that would be left.
    pub sd_left: Estimate,
    /// True if its share is above the level that chance gives.
    pub above_chance: bool,
}

impl Information {
    /// Factors whose share is above what chance gives, the largest first.
    pub fn causes(&self) -> impl Iterator<Item = &KnownFactor> {
        self.factors.iter().filter(|factor| factor.above_chance)
    }

    /// Number of draws with which the largest share would be above chance, if it is what it seems; none where one is, and where
    /// none is seen.
    pub fn draws_needed(&self) -> Option<f64> {
        let (noise, first) = (self.noise, self.factors.first()?);
        let quiet = self.causes().next().is_none() && first.share.value > 0.0;
        // IN-2 of an idle factor falls with n^(-3/4): its deviation is sqrt(2 m) / n, m = sqrt n.
        let needed = self.n as f64 * (noise / first.share.value).powf(4.0 / 3.0);
        (quiet && needed.is_finite()).then_some(needed)
    }

    /// From a sample of an output with a number for each point of the plan, NaN where there is none; none of an output that does not vary,
    /// and of too few draws.
    pub fn of_sample(plan: &Plan, found: &[f64], confidence: Confidence) -> Option<Self> {
        let found = &found[..found.len().min(MAX_DRAWS)];
        let points: Vec<u64> = (0..found.len() as u64).collect();
        let of = chance(plan, &points, found, confidence)?;
        let sd = Summary::new(found, confidence).sd;
        let share = |k: usize| Estimate {
            value: of.shares[k],
            interval: None,
        };
        let above = |k: usize| of.shares[k] > of.noise;
        Some(Self::new(plan, (of.n, sd, of.noise), share, above))
    }

    /// From any sample of an output; none of an output that does not vary, and of too few draws.
    pub(super) fn of_draws(
        plan: &Plan,
        found: &Found,
        summary: &Summary,
        confidence: Confidence,
    ) -> Result<Option<Self>, Problem> {
        let found = found.first(MAX_DRAWS)?;
        let of = Self::of_sample(plan, &found, confidence);
        // The deviation is that of all draws.
        Ok(of.map(|of| of.with_sd(summary.sd)))
    }

    /// From the indices of a Saltelli design, and what it found in its first two blocks, a sample that shows what chance gives; none of an
    /// output that does not vary, and of too few draws.
    pub(super) fn of_indices(
        plan: &Plan,
        drawn: &Found,
        indices: &SobolIndices,
        confidence: Confidence,
    ) -> Result<Option<Self>, Problem> {
        let factors = plan.factors.len();
        let is_draw = |point: &u64| matches!(saltelli_role(factors, *point).1, Role::A | Role::B);
        let found = drawn.first(MAX_DRAWS)?;
        let points: Vec<u64> = (0..).filter(is_draw).take(found.len()).collect();
        let of = chance(plan, &points, &found, confidence);
        Ok(of.map(|of| {
            let first = |k: usize| indices.factors[k].first;
            let above = |k: usize| {
                of.shares[k] > of.noise && first(k).interval.is_some_and(|[low, _]| low > 0.0)
            };
            let head = (indices.samples, indices.variance.sqrt(), of.noise);
            Self::new(plan, head, first, above)
        }))
    }

    fn new(
        plan: &Plan,
        (n, sd, noise): (usize, f64, f64),
        share: impl Fn(usize) -> Estimate,
        above: impl Fn(usize) -> bool,
    ) -> Self {
        let left = |share: f64| sd_left(sd, share);
        let known = |(k, factor): (usize, &Factor)| {
            let share = share(k);
            KnownFactor {
                name: factor.name.clone(),
                test: factor.test.clone(),
                share,
                sd_left: Estimate {
                    value: left(share.value),
                    interval: share.interval.map(|[low, high]| [left(high), left(low)]),
                },
                above_chance: above(k),
            }
        };
        let factors = plan.factors.iter().enumerate().map(known).collect();
        let information = Information {
            n,
            sd,
            noise,
            factors,
        };
        information.sorted()
    }

    /// As it is, of an output with another deviation.
    fn with_sd(mut self, sd: f64) -> Self {
        for factor in &mut self.factors {
            factor.sd_left.value = sd_left(sd, factor.share.value);
        }
        Information { sd, ..self }
    }

    /// The largest share first, those without one last.
    fn sorted(mut self) -> Self {
        let share = |factor: &KnownFactor| factor.share.value;
        self.factors.sort_by(|a, b| {
            let last = share(a).is_nan().cmp(&share(b).is_nan());
            last.then(share(b).total_cmp(&share(a)))
        });
        self
    }
}

/// Shares from what some points found that are draws; none where nothing can be said.
fn chance(plan: &Plan, points: &[u64], found: &[f64], confidence: Confidence) -> Option<Shares> {
    let columns = (0..plan.factors.len()).map(|f| column(plan, f, points));
    let columns: Vec<Column> = columns.collect();
    let of = from_draws(&columns, found, confidence);
    of.noise.is_finite().then_some(of)
}

/// The values of a factor at some points.
fn column(plan: &Plan, factor: usize, points: &[u64]) -> Column {
    let of = &plan.factors[factor];
    let values = points.iter().map(|point| value(plan, factor, *point));
    if of.values.are_numbers() {
        let number = |value: Option<FactorValue>| value.and_then(|x| x.number());
        return Column::Numbers(values.map(|x| number(x).unwrap_or(f64::NAN)).collect());
    }
    Column::Words(
        values
            .map(|value| value.map(|value| of.entry_of(&value)))
            .collect(),
    )
}
