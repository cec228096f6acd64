//! The answer of a study as CSV files.

use cvtcycle_output::columns;
use cvtcycle_output::table::{Column, csv_bytes};

use super::{Answer, GridMatrix, OutputAnswer, Ranked};
use crate::execute::manifest::StudyManifest;
use crate::statistics::{
    Estimate, FactorIndices, Group, QUANTILES, RankFactor, SobolIndices, Tornado, TornadoBar,
    TornadoEnd,
};

/// Name and contents of every table that has rows. Numbers read back to the same `f64`; a missing one is an empty cell.
pub fn tables(answer: &Answer, outline: &StudyManifest) -> Vec<(String, Vec<u8>)> {
    let outputs: Vec<&OutputAnswer> = answer.outputs.iter().collect();
    let sobol_rows = sobol_rows(answer, outline);
    let files = [
        ("statistics.csv", csv_bytes(&statistics(), &outputs)),
        ("sobol_indices.csv", csv_bytes(&sobol(), &sobol_rows)),
        ("tornado.csv", csv_bytes(&tornado(), &tornado_rows(answer))),
        (
            "rank_correlation.csv",
            csv_bytes(&ranks(), &rank_rows(answer)),
        ),
        (
            "main_effects.csv",
            csv_bytes(&levels(), &level_rows(answer)),
        ),
        ("matrix.csv", csv_bytes(&matrix(), &matrix_rows(answer))),
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

/// An estimate and both ends of its interval.
fn estimate<R>(
    name: &str,
    get: impl Fn(&R) -> &Estimate + Copy + Send + Sync + 'static,
) -> Vec<Column<R>> {
    columns! { R;
        number name.to_owned(), "", "", r => get(r).value;
        optional format!("{name}_low95"), "", "", r => end(get(r).interval95, 0);
        optional format!("{name}_high95"), "", "", r => end(get(r).interval95, 1);
    }
}

fn statistics<'a>() -> Vec<Column<&'a OutputAnswer>> {
    let mut list = of_output_in_unit(|o: &&'a OutputAnswer| o);
    list.extend(columns! { &'a OutputAnswer;
        count "n", "", "", o => o.summary.n as u64;
        count "missing", "", "", o => o.summary.missing as u64;
        number "mean", "", "", o => o.summary.mean;
        optional "mean_low95", "", "", o => end(o.summary.mean_interval95, 0);
        optional "mean_high95", "", "", o => end(o.summary.mean_interval95, 1);
        number "sd", "", "", o => o.summary.sd;
        number "min", "", "", o => o.summary.min;
        number "max", "", "", o => o.summary.max;
    });
    list.extend(QUANTILES.iter().map(|p| {
        let quantile = |o: &&OutputAnswer| o.summary.quantile(*p);
        Column::number(format!("quantile_{p}"), "", "", quantile)
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

fn sobol<'a>() -> Vec<Column<SobolRow<'a>>> {
    let mut list = of_output(|r: &SobolRow<'a>| r.0);
    list.extend(columns! { SobolRow<'a>;
        count "samples", "", "", r => r.1.samples as u64;
        text "factor", "", "", r => r.2.to_owned();
    });
    list.extend(estimate("first", |r: &SobolRow| &r.3.first));
    list.extend(estimate("total", |r: &SobolRow| &r.3.total));
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

fn matrix<'a>() -> Vec<Column<MatrixRow<'a>>> {
    let mut list = of_output_in_unit(|r: &MatrixRow<'a>| r.0);
    list.extend(columns! { MatrixRow<'a>;
        text "row_factor", "", "", r => r.1.factors[0].clone();
        text "row", "", "", r => r.1.rows[r.2].clone();
        text "column_factor", "", "", r => r.1.factors[1].clone();
        text "column", "", "", r => r.1.columns[r.3].clone();
        optional "value", "", "", r => r.1.cells.get(r.2).and_then(|row| *row.get(r.3)?);
    });
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
    fn label(end: &Option<TornadoEnd>) -> String {
        end.as_ref()
            .map_or_else(String::new, |end| end.label.clone())
    }
    fn output(end: &Option<TornadoEnd>) -> Option<f64> {
        end.as_ref().map(|end| end.output)
    }
    let mut list = of_output_in_unit(|r: &TornadoRow<'a>| r.0);
    list.extend(columns! { TornadoRow<'a>;
        number "base", "", "", r => r.1.base;
        text "factor", "", "", r => r.2.name.clone();
        text "low", "", "", r => label(&r.2.low);
        optional "output_at_low", "", "", r => output(&r.2.low);
        text "high", "", "", r => label(&r.2.high);
        optional "output_at_high", "", "", r => output(&r.2.high);
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

fn ranks<'a>() -> Vec<Column<RankRow<'a>>> {
    let mut list = of_output(|r: &RankRow<'a>| r.0);
    list.extend(columns! { RankRow<'a>;
        count "n", "", "", r => r.1.of.n as u64;
        number "r_squared", "", "", r => r.1.of.r_squared;
        text "factor", "", "", r => r.2.to_owned();
    });
    list.extend(estimate("spearman", |r: &RankRow| &r.3.spearman));
    list.extend(estimate("regression", |r: &RankRow| &r.3.regression));
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
