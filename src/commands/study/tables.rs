//! Results of a study as tables: the comparison first, then the underlying numbers.

use std::path::{Path, PathBuf};

use cvtcycle::analysis::words::between;
use cvtcycle::analysis::words::study::{fleet_range, sentences};
use cvtcycle::output::fleet_spread::DrivenOn;
use cvtcycle::report::results::StudyResults;
use cvtcycle::study::answer::ambient::Matrix;
use cvtcycle::study::answer::{Ended, OutputAnswer};
use cvtcycle::study::plan::Design;
use cvtcycle::study::statistics::{Summary, of_hundred};
use cvtcycle::study::{Answer, StudyManifest};

use super::effects::factors;
use crate::print::colour::Paint;
use crate::print::{bold, sections};
use cvtcycle::output::number::{fixed, plain, signed};
use cvtcycle::output::table::{TextColumns, TextTable, paragraphs, wrapped};

/// Maximum number of reasons of failed runs listed.
pub const MAX_REASONS: usize = 5;

/// Prints all results of a study.
pub fn tables(study: &StudyResults, paint: Paint) -> String {
    let (answer, outline) = (&study.answer, &study.outline);
    let said: String = sentences(answer, outline)
        .iter()
        .map(|line| wrapped(line, ""))
        .collect();
    let text = head(study, paint) + if said.is_empty() { "" } else { "\n" } + &said;
    if let Some(matrix) = &answer.matrix {
        return text + &matrix_tables(matrix, outline, paint);
    }
    let outputs = sections([("Outputs", outputs(answer))], paint);
    let factors = factors(answer, outline, paint);
    // Without a sample, the levels are the answer.
    match outline.plan.design.is_sampled() {
        true => text + &outputs + &factors,
        false => text + &factors + &outputs,
    }
}

/// Start and ambient temperature of a row, by index.
type MatrixRow = (usize, usize);

/// Fuel of each part of the cycle with the difference to the baselines, and the final temperature of the transmission oil.
fn matrix_tables(matrix: &Matrix, outline: &StudyManifest, paint: Paint) -> String {
    let rows = |columns: &TextColumns<MatrixRow>| {
        let ambients = matrix.ambient_degc.len();
        let of_start = |start| (0..ambients).map(move |ambient| (start, ambient));
        let rows: Vec<MatrixRow> = (0..matrix.starts.len()).flat_map(of_start).collect();
        columns.text(&rows)
    };
    let fuel = matrix.fuel.iter().map(|part| {
        let name = match part.name.as_str() {
            "total" => "whole cycle",
            name => name,
        };
        let mut columns = lead(matrix);
        for (car, numbers) in matrix.cars.iter().zip(&part.l_per_100km) {
            columns = columns.number(car, 2, |row| cell(numbers, row));
        }
        let baselines = (1..).zip(matrix.cars.iter().skip(1));
        for ((k, car), numbers) in baselines.zip(&part.excess_percent) {
            columns = columns.right(format!("over {car}"), |row| signed(cell(numbers, row), 1));
            let cycle = &outline.plan.base.cycle;
            let range = move |row: &MatrixRow| {
                let (degc, percent) = (matrix.ambient_degc[row.1], cell(numbers, row)?);
                let on = match part.name.as_str() {
                    "total" => DrivenOn::whole(cycle, degc),
                    _ => DrivenOn::part(cycle, degc),
                };
                Some(between(fleet_range(outline, k, percent, on)?.ends, "%"))
            };
            if range(&(0, 0)).is_some() {
                columns = columns.right("90 % of such cars", move |row| {
                    range(row).unwrap_or_default()
                });
            }
        }
        let title = format!("Fuel, {name}, L/100 km, and difference of the subject, %");
        (title, rows(&columns))
    });
    // Prints the sump only, on which the losses depend; files and JSON have the other temperatures.
    let sump = matrix.ends.iter().take(1).map(|part| {
        let mut columns = lead(matrix);
        for (car, numbers) in matrix.cars.iter().zip(&part.degc) {
            columns = columns.number(car, 1, |row| cell(numbers, row));
        }
        let title = format!("End temperature, {}, degC", part.name);
        (title, rows(&columns))
    });
    sections(fuel.chain(sump), paint)
}

fn cell(numbers: &[Vec<f64>], (start, ambient): &MatrixRow) -> Option<f64> {
    numbers.get(*start)?.get(*ambient).copied()
}

/// Columns of start and ambient temperature; a start is named in its first row.
fn lead(matrix: &Matrix) -> TextColumns<'_, MatrixRow> {
    let start = |(start, ambient): &MatrixRow| match ambient {
        0 => matrix.starts[*start].as_str(),
        _ => "",
    };
    TextColumns::new()
        .left("start", start)
        .right("ambient", |(_, ambient)| {
            plain(matrix.ambient_degc[*ambient])
        })
}

fn head(study: &StudyResults, paint: Paint) -> String {
    let (answer, outline) = (&study.answer, &study.outline);
    let mut text = bold(&answer.title, paint);
    if !answer.question.is_empty() {
        text += &paragraphs(&answer.question);
    }
    let (points, cars) = (answer.points, outline.cars.join(", "));
    let (design, runs) = (design(outline), outline.points * outline.cars.len() as u64);
    text += &wrapped(
        &format!("{design}; {points} points, {runs} runs of {cars}"),
        "",
    );
    let (present, all) = study.parts();
    if present < all {
        let done = answer.points_done;
        text += &format!(
            "not finished: results of {present} of {all} parts, {done} of {points} points\n"
        );
    }
    let (failed, not_run) = (answer.runs.failed, answer.runs.not_run);
    if failed + not_run > 0 {
        let bad = failed + not_run;
        text += &format!(
            "{bad} runs are left out ({failed} failed a check, {not_run} could not be run)\n"
        );
    }
    text.extend(answer.notes.iter().map(|note| wrapped(note, "note: ")));
    text
}

fn design(outline: &StudyManifest) -> String {
    let factors = match outline.plan.factors.len() {
        1 => "1 factor".to_owned(),
        n => format!("{n} factors"),
    };
    let design = match outline.plan.design {
        Design::Grid => "full grid".to_owned(),
        Design::OneAtATime { .. } => "one at a time".to_owned(),
        Design::LatinHypercube { seed, .. } => format!("Latin hypercube, seed {seed}"),
        Design::Sobol { seed, .. } => format!("Sobol sequence, seed {seed}"),
        Design::MonteCarlo { seed, .. } => format!("Monte Carlo, seed {seed}"),
        Design::Saltelli { samples, seed } => {
            format!("Saltelli blocks of {samples} samples, seed {seed}")
        }
    };
    format!("{factors}, {design}")
}

fn outputs(answer: &Answer) -> String {
    // Names and units appear once for all vehicles.
    let first = |o: &OutputAnswer, text: &str| {
        let mut all = answer.outputs.iter();
        let first = all.find(|other| other.output == o.output);
        match first.is_some_and(|first| first.car == o.car) {
            true => text.to_owned(),
            false => String::new(),
        }
    };
    if answer.outputs.iter().any(|o| o.range.is_some()) {
        return ranges(answer, first);
    }
    let statistic =
        |o: &OutputAnswer, number: &dyn Fn(&Summary) -> f64| o.summary.as_ref().map(number);
    let [low, high] = answer.confidence.ends();
    let [low_head, high_head] = [low, high].map(|p| format!("{} %", of_hundred(p)));
    TextColumns::new()
        .left("output", |o: &OutputAnswer| first(o, &o.output))
        .left("unit", |o| first(o, &o.unit))
        .left("car", |o| o.car.clone())
        .right("n", |o| o.counts()[0].to_string())
        .number("mean", 3, |o| statistic(o, &|s| s.mean))
        .number("sd", 3, |o| statistic(o, &|s| s.sd))
        .number(low_head, 3, |o| statistic(o, &|s| s.quantile(low)))
        .number(high_head, 3, |o| statistic(o, &|s| s.quantile(high)))
        .table(&answer.outputs)
        .indented()
        .text()
}

/// Minimum and maximum of each output with their levels, one line each.
fn ranges(answer: &Answer, first: impl Fn(&OutputAnswer, &str) -> String) -> String {
    let mut table = TextTable::new("llrlrl").indented();
    table.row(["output", "car", "n", "", "value", "at"]);
    for output in &answer.outputs {
        let Some(range) = &output.range else { continue };
        let value = |x: Option<f64>| fixed(x, 3);
        table.row([
            first(output, &output.output),
            output.car.clone(),
            range.n.to_string(),
            if range.is_one() { "" } else { "least" }.to_owned(),
            value(range.least),
            range.least_at.clone(),
        ]);
        if !range.is_one() {
            let largest = ["", "", "", "largest"].map(str::to_owned);
            let rest = [value(range.largest), range.largest_at.clone()];
            table.row(largest.into_iter().chain(rest));
        }
    }
    table.text()
}

/// One message about failed runs with their reasons; empty if all are good.
pub fn failures(runs: &Ended) -> Vec<String> {
    let bad = runs.failed + runs.not_run;
    if bad == 0 {
        return Vec::new();
    }
    let all = runs.ok + bad;
    let mut text = format!("{bad} of {all} runs failed; the table has the reason of each");
    for (reason, count) in runs.reasons.iter().take(MAX_REASONS) {
        text += &format!("\n  {count} x {reason}");
    }
    let more = runs.reasons.len().saturating_sub(MAX_REASONS);
    if more > 0 {
        text += &format!("\n  and {more} other reasons");
    }
    vec![text]
}

/// List of the files.
pub fn written(dir: &Path, files: &[PathBuf]) -> String {
    let names = files.iter().filter_map(|file| file.file_name());
    let names: Vec<_> = names.map(|name| name.to_string_lossy()).collect();
    format!(
        "\nFiles written in {}\n  parts/  {}\n",
        dir.display(),
        names.join("  ")
    )
}
