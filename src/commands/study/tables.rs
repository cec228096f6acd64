//! Results of a study as tables: the comparison first, then the numbers behind it.

use std::path::{Path, PathBuf};

use cvtcycle::report::results::StudyResults;
use cvtcycle::report::study_answers::{Measure, ranked};
use cvtcycle::study::answer::ambient::Matrix;
use cvtcycle::study::answer::{Comparison, Ended, OutputAnswer};
use cvtcycle::study::execute::outputs::EXCESS;
use cvtcycle::study::plan::Design;
use cvtcycle::study::statistics::{
    Estimate, FactorIndices, Group, Groups, SobolIndices, Tornado, TornadoBar, TornadoEnd,
};
use cvtcycle::study::{Answer, StudyManifest};

use crate::print::colour::Paint;
use crate::print::sections;
use cvtcycle::output::number::{NONE, fixed, plain, signed};
use cvtcycle::output::table::{TextColumns, TextTable};

/// Number of factors that are listed for an output.
const MAX_FACTORS: usize = 10;
/// Number of reasons of failed runs that are listed.
const MAX_REASONS: usize = 5;
/// Rows and columns of a matrix that fit on a page.
const MATRIX: [usize; 2] = [40, 10];

/// All results of a study for people.
pub fn tables(study: &StudyResults, paint: Paint) -> String {
    let (answer, outline) = (&study.answer, &study.outline);
    let text = head(study, paint);
    if let Some(matrix) = &answer.matrix {
        return text + &matrix_tables(matrix, paint);
    }
    let sampled = outline.plan.design.is_sampled();
    let of = answer.comparisons.iter();
    let comparison: String = of.clone().map(|of| compared(of, answer, sampled)).collect();
    let strongest: String = of.filter_map(|of| strongest(of, answer, outline)).collect();
    let body = [
        ("Comparison", comparison + &strongest),
        ("Outputs", outputs(answer)),
    ];
    text + &sections(body, paint) + &factors(answer, outline, paint)
}

/// Start and ambient temperature of a row, by index.
type MatrixRow = (usize, usize);

/// Fuel of each part of the cycle with the difference to the baselines, and end temperatures.
fn matrix_tables(matrix: &Matrix, paint: Paint) -> String {
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
        for (car, numbers) in matrix.cars.iter().skip(1).zip(&part.excess_percent) {
            columns = columns.right(format!("over {car}"), |row| signed(cell(numbers, row), 1));
        }
        let title = format!("Fuel, {name}, L/100 km, and difference of the subject, %");
        (title, rows(&columns))
    });
    let ends = matrix.ends.iter().map(|part| {
        let mut columns = lead(matrix);
        for (car, numbers) in matrix.cars.iter().zip(&part.degc) {
            columns = columns.number(car, 1, |row| cell(numbers, row));
        }
        let title = format!("End temperature, {}, degC", part.name);
        (title, rows(&columns))
    });
    sections(fuel.chain(ends), paint)
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
    let mut text = format!("{}\n", paint.heading(&answer.title));
    if !answer.question.is_empty() {
        text += &format!("{}\n", answer.question);
    }
    let (points, cars) = (answer.points, outline.cars.join(", "));
    let (design, runs) = (design(outline), outline.points * outline.cars.len() as u64);
    text += &format!("{design}; {points} points, {runs} runs of {cars}\n");
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

/// Share of the pairs in which the subject uses more fuel, and the difference. For a grid the share describes its own points only.
fn compared(of: &Comparison, answer: &Answer, sampled: bool) -> String {
    let subject = answer.cars.first().map_or("the subject", String::as_str);
    let (s, worse, baseline) = (&of.excess_percent, &of.worse, &of.baseline);
    if worse.n == 0 {
        return format!("{subject} compared with {baseline}: no pair of good runs\n");
    }
    let (k, n, mean) = (worse.k, worse.n, signed(s.mean, 2));
    if !sampled {
        let [low, high] = [s.min, s.max].map(|x| signed(x, 1));
        return format!(
            "{subject} uses more fuel than {baseline} at {k} of {n} points; the difference is {low} to {high} %, {mean} % on average.\n"
        );
    }
    let percent = |x: f64| fixed(100.0 * x, if n >= 1000 { 1 } else { 0 });
    let (share, [low, high]) = (percent(worse.share), worse.interval95.map(percent));
    let [q5, q95, median] = [0.05, 0.95, 0.5].map(|p| signed(s.quantile(p), 1));
    let sd = fixed(s.sd, 2);
    format!(
        "{subject} uses more fuel than {baseline} in {k} of {n} pairs: {share} % (95 % interval {low} to {high} %).\n\
         The difference is {mean} % on average, sd {sd}; 90 % of the pairs are between {q5} and {q95} %, the median is {median} %.\n"
    )
}

/// Factors with the largest effect on the difference to a baseline.
fn strongest(of: &Comparison, answer: &Answer, outline: &StudyManifest) -> Option<String> {
    let mut outputs = answer.outputs.iter();
    let output = outputs.find(|o| o.output == EXCESS && o.car == of.baseline)?;
    let (measure, ranked) = ranked(output, outline)?;
    let name = |(name, x): &(String, f64)| format!("{name} ({})", fixed(*x, 2));
    let first: Vec<String> = ranked.iter().take(3).map(name).collect();
    let measure = match measure {
        Measure::Variance => "share of the variance, with interactions",
        Measure::Swing => "swing, points",
        Measure::Rank => "rank correlation",
    };
    let (baseline, first) = (&of.baseline, first.join(", "));
    Some(format!(
        "Largest effects on the difference to {baseline}: {first} [{measure}].\n"
    ))
}

fn outputs(answer: &Answer) -> String {
    // Name and unit are shown once for all vehicles.
    let first = |o: &OutputAnswer, text: &str| {
        let mut all = answer.outputs.iter();
        let first = all.find(|other| other.output == o.output);
        match first.is_some_and(|first| first.car == o.car) {
            true => text.to_owned(),
            false => String::new(),
        }
    };
    TextColumns::new()
        .left("output", |o: &OutputAnswer| first(o, &o.output))
        .left("unit", |o| first(o, &o.unit))
        .left("car", |o| o.car.clone())
        .right("n", |o| o.summary.n.to_string())
        .number("mean", 3, |o| o.summary.mean)
        .number("sd", 3, |o| o.summary.sd)
        .number("5 %", 3, |o| o.summary.quantile(0.05))
        .number("95 %", 3, |o| o.summary.quantile(0.95))
        .table(&answer.outputs)
        .indented()
        .text()
}

/// Factors of the first output of the subject, and of the difference to each baseline.
fn factors(answer: &Answer, outline: &StudyManifest, paint: Paint) -> String {
    let Some(first) = answer.outputs.first() else {
        return String::new();
    };
    let is_first = |o: &OutputAnswer| o.output == first.output && o.car == first.car;
    let is_shown = |o: &&OutputAnswer| o.output == EXCESS || is_first(o);
    let section = |o: &OutputAnswer| {
        let heading = format!("Effects on {} ({}), {}", o.output, o.unit, o.car);
        (heading, effects(o, outline))
    };
    sections(answer.outputs.iter().filter(is_shown).map(section), paint)
}

fn effects(output: &OutputAnswer, outline: &StudyManifest) -> String {
    match (output.sobol.last(), &output.tornado) {
        (Some(indices), _) => sobol(output, outline, indices),
        (None, Some(of)) => tornado(of),
        (None, None) => grid(output) + &rank(output) + &levels(output),
    }
}

/// The matrix of a grid of two factors, its smallest number marked.
fn grid(output: &OutputAnswer) -> String {
    let Some(matrix) = &output.matrix else {
        return String::new();
    };
    let [of_rows, of_columns] = &matrix.factors;
    let (high, wide) = (matrix.rows.len(), matrix.columns.len());
    if wide > MATRIX[1] || high > MATRIX[0] {
        return format!("  {of_rows} by {of_columns}: {high} by {wide} numbers, in matrix.csv\n");
    }
    let mut table = TextTable::new(&("l".to_owned() + &"r".repeat(wide))).indented();
    let columns = matrix.columns.iter().cloned();
    table.row(
        [format!("{of_rows} \\ {of_columns}")]
            .into_iter()
            .chain(columns),
    );
    let least = matrix.least();
    for (i, (name, row)) in matrix.rows.iter().zip(&matrix.cells).enumerate() {
        let cell = |(k, x): (usize, &Option<f64>)| {
            let mark = if least == Some((i, k)) { "*" } else { "" };
            format!("{mark}{}", fixed(*x, 3))
        };
        let cells = row.iter().enumerate().map(cell);
        table.row([name.clone()].into_iter().chain(cells));
    }
    table.text() + "  * least\n"
}

fn tornado(tornado: &Tornado) -> String {
    let label = |end: &Option<TornadoEnd>| match end {
        Some(end) => end.label.clone(),
        None => NONE.to_owned(),
    };
    let effect = |end: &Option<TornadoEnd>| signed(end.as_ref().map(|end| end.effect), 3);
    let table = TextColumns::new()
        .left("factor", |bar: &TornadoBar| bar.name.clone())
        .right("low", |bar| label(&bar.low))
        .right("effect", |bar| effect(&bar.low))
        .right("high", |bar| label(&bar.high))
        .right("effect", |bar| effect(&bar.high))
        .number("swing", 3, |bar| bar.swing)
        .table(&tornado.bars);
    let base = fixed(tornado.base, 3);
    format!("  base {base}\n{}", table.indented().text())
}

fn rank(output: &OutputAnswer) -> String {
    let Some(rank) = &output.rank else {
        return String::new();
    };
    let factors = rank.factors.iter().zip(&rank.of.factors);
    let mut list: Vec<(&String, &Estimate)> =
        factors.map(|(name, f)| (name, &f.spearman)).collect();
    list.sort_by(|a, b| b.1.value.abs().total_cmp(&a.1.value.abs()));
    let end = |e: &Estimate, k: usize| signed(e.interval95.map(|ends| ends[k]), 2);
    TextColumns::new()
        .left("factor", |(name, _): &(&String, &Estimate)| (*name).clone())
        .right("rank correlation", |(_, e)| signed(e.value, 2))
        .right("from", |(_, e)| end(e, 0))
        .right("to", |(_, e)| end(e, 1))
        .table(list.iter().take(MAX_FACTORS))
        .indented()
        .text()
}

fn levels(output: &OutputAnswer) -> String {
    let table = |(name, levels): &(String, Groups)| {
        TextColumns::new()
            .left(name, |g: &Group| g.label.clone())
            .right("n", |g| g.n.to_string())
            .number("mean", 3, |g| g.mean)
            .number("min", 3, |g| g.min)
            .number("max", 3, |g| g.max)
            .table(&levels.groups)
            .indented()
            .text()
    };
    output.levels.iter().map(table).collect()
}

fn sobol(output: &OutputAnswer, outline: &StudyManifest, indices: &SobolIndices) -> String {
    let Some((_, ranked)) = ranked(output, outline) else {
        return "  the output does not vary\n".to_owned();
    };
    let span = |e: &Estimate| match e.interval95 {
        Some([a, b]) => format!("{} .. {}", fixed(a, 3), fixed(b, 3)),
        None => NONE.to_owned(),
    };
    let of_factor = |(name, _): &(String, f64)| {
        let mut factors = outline.plan.factors.iter();
        let place = factors.position(|factor| factor.name == *name)?;
        Some((name.clone(), &indices.factors[place]))
    };
    let first = ranked.iter().take(MAX_FACTORS);
    let rows: Vec<(String, &FactorIndices)> = first.filter_map(of_factor).collect();
    let mut text = TextColumns::new()
        .left("factor", |(name, _): &(String, &FactorIndices)| {
            name.clone()
        })
        .number("first order", 3, |(_, f)| f.first.value)
        .right("95 % interval", |(_, f)| span(&f.first))
        .number("total", 3, |(_, f)| f.total.value)
        .right("95 % interval", |(_, f)| span(&f.total))
        .table(&rows)
        .indented()
        .text();
    let rest = ranked.len().saturating_sub(MAX_FACTORS);
    if rest > 0 {
        text += &format!("  {rest} more factors have a smaller total index\n");
    }
    let sum = fixed(indices.sum_first.value, 3);
    text + &format!("  sum of first-order indices {sum}\n")
}

/// Failed runs with their reasons, as one message; none if all are good.
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
