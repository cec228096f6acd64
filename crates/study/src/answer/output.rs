//! Statistics of one output of a car, by the design of the study.

use super::levels::{label, numbers, values, words};
use super::{Column, GridMatrix, Information, Range, StudyTable, described, summary};
use crate::plan::{Design, Factor, FactorValue, Plan};
use crate::statistics::{
    Blocks, Bootstrap, Confidence, Groups, RankSensitivity, SobolIndices, Summary, Tornado,
    TornadoInput, group_means_over, rank_sensitivity, sobol_convergence, tornado,
};
use cvtcycle_config::Problem;
use serde::Serialize;

/// One output of one car.
#[derive(Clone, Debug, Serialize)]
pub struct OutputAnswer {
    /// Column.
    pub output: String,
    /// Unit of the output.
    pub unit: String,
    /// Car; for an excess the baseline.
    pub car: String,
    /// Description of draws; none where the points are no sample.
    pub summary: Option<Summary>,
    /// Ends of points that are no sample.
    pub range: Option<Range>,
    /// Sobol indices of growing numbers of samples, the last of all; of a Saltelli design.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sobol: Vec<SobolIndices>,
    /// Spread that remains when each factor is known; designs that sample.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub information: Option<Information>,
    /// Present in a one-at-a-time design.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tornado: Option<Tornado>,
    /// Present for numeric factors in designs that sample.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rank: Option<Ranked>,
    /// Means at the levels of factors: in grids of all, else of words.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub levels: Vec<(String, Groups)>,
    /// Present in a grid of two factors.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub matrix: Option<GridMatrix>,
}

impl OutputAnswer {
    /// Numbers of values and of points without one.
    pub fn counts(&self) -> [u64; 2] {
        let of_draws = self.summary.as_ref().map(|s| [s.n, s.missing]);
        let counts = of_draws.or(self.range.as_ref().map(|r| [r.n, r.missing]));
        counts.unwrap_or_default().map(|n| n as u64)
    }
}

/// Rank correlations with the factors that are drawn numbers.
#[derive(Clone, Debug, Serialize)]
pub struct Ranked {
    /// Names of the factors.
    pub factors: Vec<String>,
    /// Correlations, in their order.
    pub of: RankSensitivity,
}

/// Points from which rank correlations are computed at most: more would cost memory and tell nothing that can be seen.
const MAX_RANKED: usize = 1 << 16;

pub(super) fn output(
    frame: &StudyTable,
    (name, unit): &(String, String),
    car: usize,
    confidence: Confidence,
) -> Result<OutputAnswer, Problem> {
    let plan = &frame.outline.plan;
    let sample = plan.design.is_sampled().then_some(confidence);
    let points = frame.points();
    let drawn = described(frame, name, car)?;
    let mut answer = OutputAnswer {
        output: name.clone(),
        unit: unit.clone(),
        car: frame.outline.cars[car].clone(),
        summary: summary(&drawn, sample)?,
        range: Range::from_points(plan, &drawn)?,
        sobol: Vec::new(),
        information: None,
        tornado: None,
        rank: None,
        levels: Vec::new(),
        matrix: GridMatrix::from_points(plan, &drawn)?,
    };
    match plan.design {
        Design::Saltelli { .. } => {
            let found = frame.column(name, car, |_| true)?.all()?;
            answer.sobol = sobol(&found, plan.factors.len(), confidence);
            let of = answer.sobol.last().zip(Some(&drawn));
            let of = of.map(|(of, drawn)| Information::of_indices(plan, drawn, of, confidence));
            answer.information = of.transpose()?.flatten();
        }
        Design::OneAtATime { .. } => answer.tornado = Some(of_tornado(plan, &drawn.all()?)),
        _ => {
            let as_words =
                |f: &usize| plan.design == Design::Grid || !plan.factors[*f].values.are_numbers();
            let (levels, numbers): (Vec<usize>, Vec<usize>) =
                (0..plan.factors.len()).partition(as_words);
            let of = answer.summary.as_ref();
            let of = of.map(|of| Information::of_draws(plan, &drawn, of, confidence));
            answer.information = of.transpose()?.flatten();
            if !numbers.is_empty() {
                answer.rank = Some(ranked(plan, &numbers, &drawn, confidence)?);
            }
            for f in levels {
                let groups = group_means_over(|| words(plan, f, points), &drawn, sample)?;
                answer.levels.push((plan.factors[f].name.clone(), groups));
            }
        }
    }
    Ok(answer)
}

fn ranked(
    plan: &Plan,
    drawn: &[usize],
    found: &Column,
    confidence: Confidence,
) -> Result<Ranked, Problem> {
    let found = found.first(MAX_RANKED)?;
    let columns: Vec<Vec<f64>> = drawn
        .iter()
        .map(|&f| numbers(plan, f, found.len()))
        .collect();
    let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
    Ok(Ranked {
        factors: drawn
            .iter()
            .map(|&f| plan.factors[f].name.clone())
            .collect(),
        of: rank_sensitivity(&columns, &found, confidence),
    })
}

/// Splits the points of a Saltelli design into its blocks.
fn sobol(numbers: &[f64], factors: usize, confidence: Confidence) -> Vec<SobolIndices> {
    let width = factors + 2;
    let column = |k: usize| numbers.iter().skip(k).step_by(width).copied().collect();
    let columns: Vec<Vec<f64>> = (0..width).map(column).collect();
    let blocks = Blocks {
        a: &columns[0],
        b: &columns[1],
        ab: columns[2..].iter().map(Vec::as_slice).collect(),
    };
    let bootstrap = Bootstrap {
        confidence,
        ..Bootstrap::default()
    };
    sobol_convergence(&blocks, bootstrap)
}

/// Point 0 is the base; the others follow factor by factor.
fn of_tornado(plan: &Plan, numbers: &[f64]) -> Tornado {
    let input = |(f, factor): (usize, &Factor)| {
        let points = values(plan, f, numbers.len()).zip(numbers).skip(1);
        let entry = |(value, number): (Option<FactorValue>, &f64)| {
            Some((label(&value?, &factor.unit), *number))
        };
        TornadoInput {
            name: factor.name.clone(),
            entries: points.filter_map(entry).collect(),
        }
    };
    let inputs: Vec<TornadoInput> = plan.factors.iter().enumerate().map(input).collect();
    tornado(numbers.first().copied().unwrap_or(f64::NAN), &inputs)
}
