//! The answer of a study as CSV files.

use cvtcycle_output::columns;
use cvtcycle_output::table::{Column, csv_bytes};

use super::{
    Answer, ChoicePair, GridMatrix, Information, KnownFactor, OutputAnswer, Range, Ranked,
};
use crate::execute::manifest::StudyManifest;
use crate::statistics::{
    Confidence, Estimate, FactorIndices, Group, RankFactor, SobolIndices, Spread, Tornado,
    TornadoBar, TornadoEnd,
};

/// Name and contents of every table that has rows. Numbers read back to the same `f64`; a missing one is an empty cell.
pub fn tables(answer: &Answer, outline: &StudyManifest) -> Vec<(String, Vec<u8>)> {
    let outputs: Vec<&OutputAnswer> = answer.outputs.iter().collect();
    let sobol_rows = sobol_rows(answer, outline);
    let of = answer.confidence;
    let files = [
        ("statistics.csv", csv_bytes(&statistics(of), &outputs)),
        ("sobol_indices.csv", csv_bytes(&sobol(of), &sobol_rows)),
        (
            "information.csv",
            csv_bytes(&information(of), &information_rows(answer)),
        ),
        ("tornado.csv", csv_bytes(&tornado(), &tornado_rows(answer))),
        (
            "rank_correlation.csv",
            csv_bytes(&ranks(of), &rank_rows(answer)),
        ),
        (
            "main_effects.csv",
            csv_bytes(&levels(), &level_rows(answer)),
        ),
        ("matrix.csv", csv_bytes(&matrix(), &matrix_rows(answer))),
        ("pairs.csv", csv_bytes(&pairs(), &pair_rows(answer))),
    ];
    let with_rows = |(name, bytes): (&str, Option<Vec<u8>>)| Some((name.to_owned(), bytes?));
    files.into_iter().filter_map(with_rows).collect()
}

/// Output and car of a row.
fn of_output<R>(
    output: impl Fn(&R) -> &OutputAnswer + Copy + Send + Sync + 'static,
) -> Vec<Column<R>> {
    columns! { R;
        text "output", "", "", r => output(r).output.clone();
        text "car", "", "", r => output(r).car.clone();
    }
}

/// Output, its unit, and car of a row.
fn of_output_in_unit<R>(
    output: impl Fn(&R) -> &OutputAnswer + Copy + Send + Sync + 'static,
) -> Vec<Column<R>> {
    let mut list = of_output(output);
    let unit = move |r: &R| output(r).unit.clone();
    list.insert(1, Column::text("unit", "", "", unit));
    list
}

/// One end of an interval.
fn end(interval: Option<[f64; 2]>, end: usize) -> Option<f64> {
    interval.map(|ends| ends[end])
}

/// Names of the two ends of an interval, with its confidence: `mean_low95` and `mean_high95`.
fn ends(name: &str, confidence: Confidence) -> [String; 2] {
    let level = confidence.percent();
    ["low", "high"].map(|end| format!("{name}_{end}{level}"))
}

/// An estimate and both ends of its interval.
fn estimate<R>(
    name: &str,
    confidence: Confidence,
    get: impl Fn(&R) -> &Estimate + Copy + Send + Sync + 'static,
) -> Vec<Column<R>> {
    let [low, high] = ends(name, confidence);
    columns! { R;
        number name.to_owned(), "", "", r => get(r).value;
        optional low, "", "", r => end(get(r).interval, 0);
        optional high, "", "", r => end(get(r).interval, 1);
    }
}

/// Moments and quantiles of draws, ends of what is no sample.
fn statistics<'a>(confidence: Confidence) -> Vec<Column<&'a OutputAnswer>> {
    let mut list = of_output_in_unit(|o: &&'a OutputAnswer| o);
    let [low, high] = ends("mean", confidence);
    fn spread(o: &OutputAnswer, of: fn(&Spread) -> f64) -> Option<f64> {
        o.summary.as_ref().map(|s| of(&s.spread))
    }
    fn mean(o: &OutputAnswer, k: usize) -> Option<f64> {
        end(o.summary.as_ref()?.mean_interval, k)
    }
    fn range(o: &OutputAnswer, of: fn(&Range) -> Option<f64>) -> Option<f64> {
        o.range.as_ref().and_then(of)
    }
    fn at(o: &OutputAnswer, of: fn(&Range) -> &String) -> String {
        o.range
            .as_ref()
            .map_or_else(String::new, |range| of(range).clone())
    }
    list.extend(columns! { &'a OutputAnswer;
        count "n", "", "", o => o.counts()[0];
        count "missing", "", "", o => o.counts()[1];
        optional "mean", "", "", o => spread(o, |s| s.mean);
        optional low, "", "", o => mean(o, 0);
        optional high, "", "", o => mean(o, 1);
        optional "sd", "", "", o => spread(o, |s| s.sd);
        optional "min", "", "", o => spread(o, |s| s.min).or(range(o, |r| r.least));
        optional "max", "", "", o => spread(o, |s| s.max).or(range(o, |r| r.largest));
        text "min_at", "", "", o => at(o, |r| &r.least_at);
        text "max_at", "", "", o => at(o, |r| &r.largest_at);
    });
    list.extend(confidence.quantiles().into_iter().map(|p| {
        let quantile = move |o: &&OutputAnswer| o.summary.as_ref().map(|s| s.quantile(p));
        Column::optional(format!("quantile_{p}"), "", "", quantile)
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
            let factors = outline.plan.factors.iter().zip(&indices.factors);
            rows.extend(factors.map(|(factor, of)| (output, indices, factor.name.as_str(), of)));
        }
    }
    rows
}

fn sobol<'a>(confidence: Confidence) -> Vec<Column<SobolRow<'a>>> {
    let mut list = of_output(|r: &SobolRow<'a>| r.0);
    list.extend(columns! { SobolRow<'a>;
        count "samples", "", "", r => r.1.samples as u64;
        text "factor", "", "", r => r.2.to_owned();
    });
    list.extend(estimate("first", confidence, |r: &SobolRow| &r.3.first));
    list.extend(estimate("total", confidence, |r: &SobolRow| &r.3.total));
    list
}

/// Output, what is worth knowing of it, and a factor.
type InformationRow<'a> = (&'a OutputAnswer, &'a Information, &'a KnownFactor);

fn information_rows(answer: &Answer) -> Vec<InformationRow<'_>> {
    let mut rows = Vec::new();
    for output in &answer.outputs {
        if let Some(of) = &output.information {
            rows.extend(of.factors.iter().map(|factor| (output, of, factor)));
        }
    }
    rows
}

fn information<'a>(confidence: Confidence) -> Vec<Column<InformationRow<'a>>> {
    let mut list = of_output_in_unit(|r: &InformationRow<'a>| r.0);
    list.extend(columns! { InformationRow<'a>;
        count "n", "", "", r => r.1.n as u64;
        number "sd", "", "", r => r.1.sd;
        number "noise", "", "", r => r.1.noise;
        text "factor", "", "", r => r.2.name.clone();
    });
    list.extend(estimate("share", confidence, |r: &InformationRow| {
        &r.2.share
    }));
    list.extend(estimate("sd_left", confidence, |r: &InformationRow| {
        &r.2.sd_left
    }));
    list.extend(columns! { InformationRow<'a>;
        text "above_chance", "", "", r => r.2.above_chance.to_string();
        text "next_test", "", "", r => r.2.test.clone();
    });
    list
}

/// Output, its matrix, row and column.
type MatrixRow<'a> = (&'a OutputAnswer, &'a GridMatrix, usize, usize);

fn matrix_rows(answer: &Answer) -> Vec<MatrixRow<'_>> {
    let mut rows = Vec::new();
    for output in &answer.outputs {
        if let Some(matrix) = &output.matrix {
            let row = |i: usize| (0..matrix.columns.len()).map(move |k| (output, matrix, i, k));
            rows.extend((0..matrix.rows.len()).flat_map(row));
        }
    }
    rows
}

/// An end of a cell over what is known of the frictions; none where nothing spans it.
fn end_of(row: &MatrixRow<'_>, end: usize) -> Option<f64> {
    let (_, matrix, i, k) = row;
    let ends = (*matrix.ends.get(*i)?.get(*k)?)?;
    Some(ends[end])
}

fn matrix<'a>() -> Vec<Column<MatrixRow<'a>>> {
    let mut list = of_output_in_unit(|r: &MatrixRow<'a>| r.0);
    list.extend(columns! { MatrixRow<'a>;
        text "row_factor", "", "", r => r.1.factors[0].clone();
        text "row", "", "", r => r.1.rows[r.2].clone();
        text "column_factor", "", "", r => r.1.factors[1].clone();
        text "column", "", "", r => r.1.columns[r.3].clone();
        optional "value", "", "", r => r.1.cells.get(r.2).and_then(|row| *row.get(r.3)?);
        optional "low", "", "", r => end_of(r, 0);
        optional "high", "", "", r => end_of(r, 1);
    });
    list
}

/// Output, its matrix, two choices, and a condition.
type PairRow<'a> = (&'a OutputAnswer, &'a GridMatrix, &'a ChoicePair, usize);

fn pair_rows(answer: &Answer) -> Vec<PairRow<'_>> {
    let mut rows = Vec::new();
    for output in &answer.outputs {
        let Some(matrix) = &output.matrix else {
            continue;
        };
        for pair in &matrix.pairs {
            rows.extend((0..pair.differences.len()).map(|at| (output, matrix, pair, at)));
        }
    }
    rows
}

fn pairs<'a>() -> Vec<Column<PairRow<'a>>> {
    let mut list = of_output_in_unit(|r: &PairRow<'a>| r.0);
    list.extend(columns! { PairRow<'a>;
        text "condition", "", "", r => r.1.conditions().map_or_else(String::new, |[own, _]| own[r.3].clone());
        text "choice", "", "", r => r.2.choices[0].clone();
        text "less", "", "", r => r.2.choices[1].clone();
        optional "difference", "", "", r => r.2.differences[r.3];
        optional "low", "", "", r => r.2.ends[r.3].map(|ends| ends[0]);
        optional "high", "", "", r => r.2.ends[r.3].map(|ends| ends[1]);
    });
    list
}

/// Output, its tornado, factor and level.
type TornadoRow<'a> = (
    &'a OutputAnswer,
    &'a Tornado,
    &'a TornadoBar,
    &'a TornadoEnd,
);

fn tornado_rows(answer: &Answer) -> Vec<TornadoRow<'_>> {
    let mut rows = Vec::new();
    for output in &answer.outputs {
        if let Some(tornado) = &output.tornado {
            for bar in &tornado.bars {
                rows.extend(
                    bar.entries
                        .iter()
                        .map(|entry| (output, tornado, bar, entry)),
                );
            }
        }
    }
    rows
}

fn tornado<'a>() -> Vec<Column<TornadoRow<'a>>> {
    /// Names the end of the bar that the level is at; empty if neither.
    fn end((_, _, bar, level): &TornadoRow) -> &'static str {
        match (&bar.low, &bar.high) {
            (Some(low), _) if low == *level => "low",
            (_, Some(high)) if high == *level => "high",
            _ => "",
        }
    }
    let mut list = of_output_in_unit(|r: &TornadoRow<'a>| r.0);
    list.extend(columns! { TornadoRow<'a>;
        number "base", "", "", r => r.1.base;
        text "factor", "", "", r => r.2.name.clone();
        text "level", "", "", r => r.3.label.clone();
        number "value", "", "", r => r.3.output;
        number "effect", "", "", r => r.3.effect;
        text "end", "", "", r => end(r).to_owned();
        number "swing", "", "", r => r.2.swing;
    });
    list
}

type RankRow<'a> = (&'a OutputAnswer, &'a Ranked, &'a str, &'a RankFactor);

fn rank_rows(answer: &Answer) -> Vec<RankRow<'_>> {
    let mut rows = Vec::new();
    for output in &answer.outputs {
        let ranks = output.rank.iter();
        rows.extend(ranks.flat_map(|rank| {
            let factors = rank.factors.iter().zip(&rank.of.factors);
            factors.map(move |(name, found)| (output, rank, name.as_str(), found))
        }));
    }
    rows
}

fn ranks<'a>(confidence: Confidence) -> Vec<Column<RankRow<'a>>> {
    let mut list = of_output(|r: &RankRow<'a>| r.0);
    list.extend(columns! { RankRow<'a>;
        count "n", "", "", r => r.1.of.n as u64;
        number "r_squared", "", "", r => r.1.of.r_squared;
        text "factor", "", "", r => r.2.to_owned();
    });
    list.extend(estimate("spearman", confidence, |r: &RankRow| {
        &r.3.spearman
    }));
    list.extend(estimate("regression", confidence, |r: &RankRow| {
        &r.3.regression
    }));
    list
}

type LevelRow<'a> = (&'a OutputAnswer, &'a str, &'a Group);

fn level_rows(answer: &Answer) -> Vec<LevelRow<'_>> {
    let mut rows = Vec::new();
    for output in &answer.outputs {
        for (factor, groups) in &output.levels {
            let groups = groups.groups.iter();
            rows.extend(groups.map(|group| (output, factor.as_str(), group)));
        }
    }
    rows
}

fn levels<'a>() -> Vec<Column<LevelRow<'a>>> {
    let mut list = of_output_in_unit(|r: &LevelRow<'a>| r.0);
    list.extend(columns! { LevelRow<'a>;
        text "factor", "", "", r => r.1.to_owned();
        text "level", "", "", r => r.2.label.clone();
        count "n", "", "", r => r.2.n as u64;
        count "missing", "", "", r => r.2.missing as u64;
        number "mean", "", "", r => r.2.mean;
        number "sd", "", "", r => r.2.sd;
        number "min", "", "", r => r.2.min;
        number "max", "", "", r => r.2.max;
    });
    list
}
