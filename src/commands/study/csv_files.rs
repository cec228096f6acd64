//! The answer of a study as tables for other programs.

use cvtcycle::study::statistics::{Estimate, QUANTILES};
use cvtcycle::study::{Answer, Outline};

/// A file in the making.
pub struct Table {
    writer: csv::Writer<Vec<u8>>,
    rows: usize,
}

impl Table {
    /// With its column names.
    pub fn new(heads: &[&str]) -> Self {
        let mut table = Table {
            writer: csv::Writer::from_writer(Vec::new()),
            rows: 0,
        };
        table.row(heads.iter().map(|head| (*head).to_owned()).collect());
        table.rows = 0;
        table
    }

    /// Adds a row.
    pub fn row(&mut self, cells: Vec<String>) {
        // Into memory, and with as many cells as heads: it cannot fail.
        let written = self.writer.write_record(cells);
        debug_assert!(written.is_ok());
        self.rows += 1;
    }

    /// The file, if it has rows.
    pub fn file(self, name: &str) -> Option<(String, Vec<u8>)> {
        let rows = self.rows;
        self.writer
            .into_inner()
            .ok()
            .filter(|_| rows > 0)
            .map(|bytes| (name.to_owned(), bytes))
    }
}

/// Shortest text that reads back to the same number; empty for none.
pub fn number(x: f64) -> String {
    if x.is_finite() {
        format!("{}", x + 0.0)
    } else {
        String::new()
    }
}

fn ends(interval: Option<[f64; 2]>) -> [String; 2] {
    interval.map_or([String::new(), String::new()], |ends| ends.map(number))
}

fn estimate(e: &Estimate) -> [String; 3] {
    let [low, high] = ends(e.interval95);
    [number(e.value), low, high]
}

/// Every table that the answer has something for.
pub fn all(answer: &Answer, outline: &Outline) -> Vec<(String, Vec<u8>)> {
    let names: Vec<&str> = outline
        .plan
        .factors
        .iter()
        .map(|factor| factor.name.as_str())
        .collect();
    [
        statistics(answer),
        sobol(answer, &names),
        tornado(answer),
        ranks(answer),
        levels(answer),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn statistics(answer: &Answer) -> Option<(String, Vec<u8>)> {
    let quantiles: Vec<String> = QUANTILES.iter().map(|p| format!("quantile_{p}")).collect();
    let mut heads = vec![
        "output",
        "unit",
        "car",
        "n",
        "missing",
        "mean",
        "mean_low95",
        "mean_high95",
        "sd",
        "min",
        "max",
    ];
    heads.extend(quantiles.iter().map(String::as_str));
    let mut table = Table::new(&heads);
    for output in &answer.outputs {
        let s = &output.summary;
        let [low, high] = ends(s.mean_interval95);
        let mut row = vec![
            output.output.clone(),
            output.unit.clone(),
            output.car.clone(),
            s.n.to_string(),
            s.missing.to_string(),
        ];
        row.extend([
            number(s.mean),
            low,
            high,
            number(s.sd),
            number(s.min),
            number(s.max),
        ]);
        row.extend(s.quantiles.iter().map(|q| number(q.value)));
        table.row(row);
    }
    table.file("statistics.csv")
}

fn sobol(answer: &Answer, names: &[&str]) -> Option<(String, Vec<u8>)> {
    let heads = [
        "output",
        "car",
        "samples",
        "factor",
        "first",
        "first_low95",
        "first_high95",
        "total",
        "total_low95",
        "total_high95",
    ];
    let mut table = Table::new(&heads);
    for output in &answer.outputs {
        for indices in &output.sobol {
            for (name, factor) in names.iter().zip(&indices.factors) {
                let mut row = vec![
                    output.output.clone(),
                    output.car.clone(),
                    indices.samples.to_string(),
                    (*name).to_owned(),
                ];
                row.extend(estimate(&factor.first));
                row.extend(estimate(&factor.total));
                table.row(row);
            }
        }
    }
    table.file("sobol_indices.csv")
}

fn tornado(answer: &Answer) -> Option<(String, Vec<u8>)> {
    let heads = [
        "output",
        "unit",
        "car",
        "base",
        "factor",
        "low",
        "output_at_low",
        "high",
        "output_at_high",
        "swing",
    ];
    let mut table = Table::new(&heads);
    for output in &answer.outputs {
        let Some(tornado) = &output.tornado else {
            continue;
        };
        for bar in &tornado.bars {
            let end = |end: &Option<cvtcycle::study::statistics::TornadoEnd>| {
                end.as_ref().map_or([String::new(), String::new()], |end| {
                    [end.label.clone(), number(end.output)]
                })
            };
            let mut row = vec![
                output.output.clone(),
                output.unit.clone(),
                output.car.clone(),
                number(tornado.base),
                bar.name.clone(),
            ];
            row.extend(end(&bar.low));
            row.extend(end(&bar.high));
            row.push(number(bar.swing));
            table.row(row);
        }
    }
    table.file("tornado.csv")
}

fn ranks(answer: &Answer) -> Option<(String, Vec<u8>)> {
    let heads = [
        "output",
        "car",
        "n",
        "r_squared",
        "factor",
        "spearman",
        "spearman_low95",
        "spearman_high95",
        "regression",
        "regression_low95",
        "regression_high95",
    ];
    let mut table = Table::new(&heads);
    for output in &answer.outputs {
        let Some(rank) = &output.rank else { continue };
        for (name, factor) in rank.factors.iter().zip(&rank.of.factors) {
            let mut row = vec![
                output.output.clone(),
                output.car.clone(),
                rank.of.n.to_string(),
                number(rank.of.r_squared),
                name.clone(),
            ];
            row.extend(estimate(&factor.spearman));
            row.extend(estimate(&factor.regression));
            table.row(row);
        }
    }
    table.file("rank_correlation.csv")
}

fn levels(answer: &Answer) -> Option<(String, Vec<u8>)> {
    let mut table = Table::new(&[
        "output", "unit", "car", "factor", "level", "n", "missing", "mean", "sd", "min", "max",
    ]);
    for output in &answer.outputs {
        for (factor, groups) in &output.levels {
            for group in &groups.groups {
                let mut row = vec![
                    output.output.clone(),
                    output.unit.clone(),
                    output.car.clone(),
                    factor.clone(),
                    group.label.clone(),
                ];
                row.extend([group.n.to_string(), group.missing.to_string()]);
                row.extend([group.mean, group.sd, group.min, group.max].map(number));
                table.row(row);
            }
        }
    }
    table.file("main_effects.csv")
}
