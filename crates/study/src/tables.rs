//! The answer of a study as CSV files.

use cvtcycle_output::columns;
use cvtcycle_output::table::{Column, csv_bytes};

use crate::answer::{Answer, OutputAnswer, Ranked};
use crate::manifest::StudyManifest;
use crate::statistics::{
    Estimate, FactorIndices, Group, QUANTILES, RankFactor, SobolIndices, Tornado, TornadoBar,
    TornadoEnd,
};

/// Name and contents of every table that has rows. Numbers read back to the same `f64`; a missing one is an empty cell.
#[must_use]
pub fn tables(answer: &Answer, outline: &StudyManifest) -> Vec<(String, Vec<u8>)> {
    let outputs: Vec<&OutputAnswer> = answer.outputs.iter().collect();
    let files = [
        ("statistics.csv", csv_bytes(&statistics(), &outputs)),
        (
            "sobol_indices.csv",
            csv_bytes(&sobol(), &sobol_rows(answer, outline)),
        ),
        ("tornado.csv", csv_bytes(&tornado(), &tornado_rows(answer))),
        (
            "rank_correlation.csv",
            csv_bytes(&ranks(), &rank_rows(answer)),
        ),
        (
            "main_effects.csv",
            csv_bytes(&levels(), &level_rows(answer)),
        ),
    ];
    let with_rows = files
        .into_iter()
        .filter_map(|(name, bytes)| Some((name.to_owned(), bytes?)));
    with_rows.collect()
}

fn low(interval: Option<[f64; 2]>) -> Option<f64> {
    interval.map(|ends| ends[0])
}

fn high(interval: Option<[f64; 2]>) -> Option<f64> {
    interval.map(|ends| ends[1])
}

/// An estimate and both ends of its interval.
fn estimate<R>(
    name: &str,
    get: impl Fn(&R) -> &Estimate + Copy + Send + Sync + 'static,
) -> Vec<Column<R>> {
    columns! { R;
        number name.to_owned(), "", "", r => get(r).value;
        optional format!("{name}_low95"), "", "", r => low(get(r).interval95);
        optional format!("{name}_high95"), "", "", r => high(get(r).interval95);
    }
}

fn statistics<'a>() -> Vec<Column<&'a OutputAnswer>> {
    let mut list = columns! { &'a OutputAnswer;
        text "output", "", "", o => o.output.clone();
        text "unit", "", "", o => o.unit.clone();
        text "car", "", "", o => o.car.clone();
        count "n", "", "", o => o.summary.n as u64;
        count "missing", "", "", o => o.summary.missing as u64;
        number "mean", "", "", o => o.summary.mean;
        optional "mean_low95", "", "", o => low(o.summary.mean_interval95);
        optional "mean_high95", "", "", o => high(o.summary.mean_interval95);
        number "sd", "", "", o => o.summary.sd;
        number "min", "", "", o => o.summary.min;
        number "max", "", "", o => o.summary.max;
    };
    list.extend(QUANTILES.iter().enumerate().map(|(k, p)| {
        Column::optional(format!("quantile_{p}"), "", "", move |o: &&OutputAnswer| {
            o.summary.quantiles.get(k).map(|quantile| quantile.value)
        })
    }));
    list
}

type SobolRow<'a> = (
    &'a OutputAnswer,
    &'a SobolIndices,
    &'a str,
    &'a FactorIndices,
);

fn sobol_rows<'a>(answer: &'a Answer, outline: &'a StudyManifest) -> Vec<SobolRow<'a>> {
    let mut rows = Vec::new();
    for output in &answer.outputs {
        for indices in &output.sobol {
            for (factor, found) in outline.plan.factors.iter().zip(&indices.factors) {
                rows.push((output, indices, factor.name.as_str(), found));
            }
        }
    }
    rows
}

fn sobol<'a>() -> Vec<Column<SobolRow<'a>>> {
    let mut list = columns! { SobolRow<'a>;
        text "output", "", "", r => r.0.output.clone();
        text "car", "", "", r => r.0.car.clone();
        count "samples", "", "", r => r.1.samples as u64;
        text "factor", "", "", r => r.2.to_owned();
    };
    list.extend(estimate("first", |r: &SobolRow| &r.3.first));
    list.extend(estimate("total", |r: &SobolRow| &r.3.total));
    list
}

type TornadoRow<'a> = (&'a OutputAnswer, &'a Tornado, &'a TornadoBar);

fn tornado_rows(answer: &Answer) -> Vec<TornadoRow<'_>> {
    let with = answer
        .outputs
        .iter()
        .filter_map(|output| Some((output, output.tornado.as_ref()?)));
    with.flat_map(|(output, tornado)| tornado.bars.iter().map(move |bar| (output, tornado, bar)))
        .collect()
}

fn tornado<'a>() -> Vec<Column<TornadoRow<'a>>> {
    fn label(end: Option<&TornadoEnd>) -> String {
        end.map_or_else(String::new, |end| end.label.clone())
    }
    fn output(end: Option<&TornadoEnd>) -> Option<f64> {
        end.map(|end| end.output)
    }
    columns! { TornadoRow<'a>;
        text "output", "", "", r => r.0.output.clone();
        text "unit", "", "", r => r.0.unit.clone();
        text "car", "", "", r => r.0.car.clone();
        number "base", "", "", r => r.1.base;
        text "factor", "", "", r => r.2.name.clone();
        text "low", "", "", r => label(r.2.low.as_ref());
        optional "output_at_low", "", "", r => output(r.2.low.as_ref());
        text "high", "", "", r => label(r.2.high.as_ref());
        optional "output_at_high", "", "", r => output(r.2.high.as_ref());
        number "swing", "", "", r => r.2.swing;
    }
}

type RankRow<'a> = (&'a OutputAnswer, &'a Ranked, &'a str, &'a RankFactor);

fn rank_rows(answer: &Answer) -> Vec<RankRow<'_>> {
    let with = answer
        .outputs
        .iter()
        .filter_map(|output| Some((output, output.rank.as_ref()?)));
    let mut list = Vec::new();
    for (output, rank) in with {
        for (name, found) in rank.factors.iter().zip(&rank.of.factors) {
            list.push((output, rank, name.as_str(), found));
        }
    }
    list
}

fn ranks<'a>() -> Vec<Column<RankRow<'a>>> {
    let mut list = columns! { RankRow<'a>;
        text "output", "", "", r => r.0.output.clone();
        text "car", "", "", r => r.0.car.clone();
        count "n", "", "", r => r.1.of.n as u64;
        number "r_squared", "", "", r => r.1.of.r_squared;
        text "factor", "", "", r => r.2.to_owned();
    };
    list.extend(estimate("spearman", |r: &RankRow| &r.3.spearman));
    list.extend(estimate("regression", |r: &RankRow| &r.3.regression));
    list
}

type LevelRow<'a> = (&'a OutputAnswer, &'a str, &'a Group);

fn level_rows(answer: &Answer) -> Vec<LevelRow<'_>> {
    let mut rows = Vec::new();
    for output in &answer.outputs {
        for (factor, groups) in &output.levels {
            rows.extend(
                groups
                    .groups
                    .iter()
                    .map(|group| (output, factor.as_str(), group)),
            );
        }
    }
    rows
}

fn levels<'a>() -> Vec<Column<LevelRow<'a>>> {
    columns! { LevelRow<'a>;
        text "output", "", "", r => r.0.output.clone();
        text "unit", "", "", r => r.0.unit.clone();
        text "car", "", "", r => r.0.car.clone();
        text "factor", "", "", r => r.1.to_owned();
        text "level", "", "", r => r.2.label.clone();
        count "n", "", "", r => r.2.n as u64;
        count "missing", "", "", r => r.2.missing as u64;
        number "mean", "", "", r => r.2.mean;
        number "sd", "", "", r => r.2.sd;
        number "min", "", "", r => r.2.min;
        number "max", "", "", r => r.2.max;
    }
}
