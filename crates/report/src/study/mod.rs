//! Results of a study, as a section of a run's report or as a separate report.

mod conditions;
pub(super) mod levers;

use serde_json::Value;

use self::conditions::{conditions, reproduce};
use crate::charts::decision::information;
use crate::charts::study::KnownValue;
use crate::document::{Block, Document, ReportTable, Section};
use crate::number::{Quantity, degc, grouped, phase, sign, words};
use crate::results::StudyResults;
use crate::study_answers::answers;
use crate::study_pictures::study_pictures;
use cvtcycle_analysis::words::decimals;
use cvtcycle_config::Problem;
use cvtcycle_output::number::fixed;
use cvtcycle_study::answer::ambient::Matrix;
use cvtcycle_study::answer::{Ended, Information, KnownFactor, OutputAnswer};
use cvtcycle_study::execute::outputs::EXCESS;
use cvtcycle_study::statistics::of_hundred;

/// Builds the section of a study; `known` are numbers of its differences from other sources than its runs, by baseline.
///
/// # Errors
/// A part cannot be read.
pub fn section(study: &StudyResults, known: &[(String, KnownValue)]) -> Result<Section, Problem> {
    if study.outline.levers.is_some() {
        return levers::section(study);
    }
    let mut section = details(study, known)?;
    let mut blocks = Vec::new();
    if !study.answer.question.is_empty() {
        blocks.push(Block::Text(study.answer.question.clone()));
    }
    blocks.extend(unfinished(study, "what follows is theirs"));
    blocks.push(Block::Text(extent(study)));
    blocks.extend(answers(study).into_iter().map(Block::Text));
    section.blocks.splice(0..0, blocks);
    fold(
        &mut section,
        &["ambient_penalty", "distribution_subject_excess_percent"],
    );
    if let Some((of, _)) = cause(study) {
        let title = &study.answer.title;
        let caption = format!(
            "Spread of the difference to the first baseline over the runs of \u{201c}{title}\u{201d}, as it is and with one value known: the next test."
        );
        section.figure("information", caption, information(of, "points", title));
    }
    Ok(section)
}

/// Statistically significant cause with the largest share in the difference to a baseline.
pub(crate) fn cause(study: &StudyResults) -> Option<(&Information, &KnownFactor)> {
    let mut outputs = study.answer.outputs.iter();
    let of = outputs.find(|of| of.output == EXCESS && of.information.is_some())?;
    let of = of.information.as_ref()?;
    Some((of, of.causes().next()?))
}

/// Keeps text, the first table and some figures in the body; moves all others to the full report.
fn fold(section: &mut Section, kept: &[&str]) {
    let mut tables = 0;
    let is_body = |block: &Block| match block {
        Block::Figure(figure) => kept.contains(&figure.name.as_str()),
        Block::Table(_) => {
            tables += 1;
            tables == 1
        }
        Block::Folded(_) => false,
        _ => true,
    };
    let (body, more) = std::mem::take(&mut section.blocks)
        .into_iter()
        .partition(is_body);
    section.blocks = body;
    section.more = more;
}

/// Warning about missing parts of the study.
pub(super) fn unfinished(study: &StudyResults, what: &str) -> Option<Block> {
    let alert = |text| Block::Alert(format!("{text}; {what}."));
    study.unfinished().map(alert)
}

/// Tables and pictures of a study.
fn details(study: &StudyResults, known: &[(String, KnownValue)]) -> Result<Section, Problem> {
    let answer = &study.answer;
    let mut section = match &answer.matrix {
        Some(_) => Section::new("ambient", "Ambient temperatures"),
        None => Section::new("uncertainty", &answer.title),
    };
    if answer.points_done == 0 {
        section.text("No part of the study is there yet.");
        section.folded(factors(study));
        return Ok(section);
    }
    if let Some(matrix) = &answer.matrix {
        tables(&mut section, matrix);
    } else {
        section.table(outputs(study));
    }
    let frame = study.frame()?;
    for (name, picture) in study_pictures(answer, &frame, &study.warm_ups, known)? {
        let caption = caption(&name, study);
        section.figure(name, caption, picture);
    }
    for output in answer.outputs.iter().filter(|of| of.output == EXCESS) {
        section.blocks.extend(pairs(output).map(Block::Table));
    }
    section.folded(factors(study));
    Ok(section)
}

/// Choices of a matrix against each other, condition by condition.
fn pairs(output: &OutputAnswer) -> Option<ReportTable> {
    let matrix = output.matrix.as_ref()?;
    let [conditions, _] = matrix.conditions()?;
    let ranges = match matrix.ends.is_empty() {
        true => "",
        false => ", with what is known of the frictions",
    };
    let caption = format!(
        "{} of {}: A less B, {}{ranges}",
        output.output, output.car, output.unit
    );
    let mut heads = vec!["A", "B"];
    heads.extend(conditions.iter().map(String::as_str));
    let mut table = ReportTable::textual(&caption, &heads);
    for pair in &matrix.pairs {
        let cell = |(x, ends): (&Option<f64>, &Option<[f64; 2]>)| match ends {
            Some([low, high]) => {
                let [low, high] = [low, high].map(|x| fixed(*x, 2));
                format!("{} ({low} to {high})", fixed(*x, 2))
            }
            None => fixed(*x, 2),
        };
        let cells = pair.differences.iter().zip(&pair.ends).map(cell);
        table.row(pair.choices.iter().cloned().chain(cells));
    }
    Some(table)
}

fn caption(name: &str, study: &StudyResults) -> String {
    let (of, level) = (&study.answer.title, study.answer.confidence.percent());
    match name.split('_').next().unwrap_or_default() {
        "distribution" => {
            format!("How the output is distributed over the runs of \u{201c}{of}\u{201d}.")
        }
        "sobol" => format!(
            "Share of the variance that each factor explains, alone and with its interactions, with {level} % intervals."
        ),
        "convergence" => {
            "The same indices from growing parts of the samples: whether there are enough of them."
                .to_owned()
        }
        "tornado" => "What each factor does by itself, level by level.".to_owned(),
        "ranks" => {
            format!("Rank correlation of the output with each factor, with {level} % intervals.")
        }
        "effects" => "Mean output at each level of each factor.".to_owned(),
        "ambient" if name.contains("penalty") => {
            "Fuel of the subject over that of each baseline, against ambient temperature."
                .to_owned()
        }
        "ambient" => "Fuel against ambient temperature, whole cycle and phases.".to_owned(),
        "warm" => "Oil temperatures over the cycle at each ambient temperature.".to_owned(),
        _ => format!("{} of \u{201c}{of}\u{201d}.", words(name)),
    }
}

/// Numbers of points and runs, with their outcomes.
fn extent(study: &StudyResults) -> String {
    let (answer, outline) = (&study.answer, &study.outline);
    let runs = outline.points * outline.cars.len() as u64;
    let mut text = format!(
        "{} points of {} factors, {runs} runs of {}.",
        answer.points,
        outline.plan.factors.len(),
        outline.cars.join(", ")
    );
    for note in &answer.notes {
        text += &format!(" Note: {note}.");
    }
    text + &ended_badly(&answer.runs)
}

/// Sentence continuation on runs without good numbers, with the reasons; empty if there are none.
pub(super) fn ended_badly(runs: &Ended) -> String {
    let bad = runs.failed + runs.not_run;
    if bad == 0 {
        return String::new();
    }
    let reasons = runs.reasons.iter().take(3);
    let reasons: Vec<String> = reasons
        .map(|(reason, n)| format!("{n} \u{d7} {reason}"))
        .collect();
    let reasons = reasons.join(", ");
    format!(" {bad} runs have no good numbers and count in no statistics ({reasons}).")
}

fn tables(section: &mut Section, matrix: &Matrix) {
    for part in &matrix.fuel {
        let name = match part.name.as_str() {
            "total" => "whole cycle".to_owned(),
            name => phase(name),
        };
        let cars = matrix.cars.iter();
        let fuel = cars.clone().map(|car| (car.clone(), Quantity::Fuel.unit()));
        let excess = cars.skip(1).map(|car| (format!("over {car}"), "%"));
        let caption = format!("Fuel, {name}");
        let has_excess = matrix.cars.len() > 1 && part.name == "total";
        let mut table = by_case(matrix, &caption, fuel.chain(excess), |s, a| {
            let fuel = part.l_per_100km.iter();
            let fuel = fuel.map(|by| Quantity::Fuel.bare(by[s][a]));
            let excess = part.excess_percent.iter();
            let excess = excess.map(|by| Quantity::Percent.bare_signed(by[s][a]));
            fuel.chain(excess).collect()
        });
        if has_excess {
            table.note = "Differences of the cars as they are computed: each has the range of measured cars that the sentences above give \
                in brackets, a wider one below 10 \u{b0}C, where measured cold starts decide. A difference between two rows is that of one car, \
                and has no part in that range."
                .to_owned();
        }
        section.table(table);
    }
    let columns = matrix.ends.iter().flat_map(|end| {
        let name = |car: &String| (format!("{car}, {}", end.name), Quantity::Degc.unit());
        matrix.cars.iter().map(name).collect::<Vec<_>>()
    });
    section.folded(by_case(
        matrix,
        "Temperatures at the end",
        columns,
        |s, a| {
            let ends = matrix.ends.iter().flat_map(|end| &end.degc);
            ends.map(|by| Quantity::Degc.bare(by[s][a])).collect()
        },
    ));
}

/// Table with a row for each start and ambient temperature, whose indices are passed to `cells`.
fn by_case(
    matrix: &Matrix,
    caption: &str,
    columns: impl Iterator<Item = (String, &'static str)>,
    cells: impl Fn(usize, usize) -> Vec<String>,
) -> ReportTable {
    let mut table = ReportTable::numeric(caption, "Start, ambient", columns);
    for (s, start) in matrix.starts.iter().enumerate() {
        for (a, ambient) in matrix.ambient_degc.iter().enumerate() {
            table.named(format!("{start}, {}", degc(*ambient)), cells(s, a));
        }
    }
    table
}

/// Moments and quantiles of draws; for points that are not a sample the extremes with their places.
fn outputs(study: &StudyResults) -> ReportTable {
    let ends = study.answer.confidence.ends();
    let [low, high] = ends.map(|p| format!("{} %", of_hundred(p)));
    let sampled = study.outline.plan.design.is_sampled();
    let names = match sampled {
        true => ["runs", "mean", "standard deviation", &low, &high],
        false => ["runs", "least", "at", "most", "at that"],
    };
    let columns = names.iter().map(|name| (name.to_string(), ""));
    let mut table = ReportTable::numeric("Outputs", "Output", columns);
    for at in [3, 5].into_iter().filter(|_| !sampled) {
        table.columns[at].number = false;
    }
    for output in &study.answer.outputs {
        let mut cells = vec![output.counts()[0].to_string()];
        if let Some(s) = &output.summary {
            let [low, high] = ends.map(|p| s.quantile(p));
            let digits = decimals([low, high]);
            let numbers = [
                (s.mean, digits),
                (s.sd, digits + 1),
                (low, digits),
                (high, digits),
            ];
            cells.extend(numbers.map(|(x, digits)| grouped(x, digits)));
        }
        if let Some(range) = &output.range {
            let [least, most] =
                [range.least, range.largest].map(|x| grouped(x.unwrap_or(f64::NAN), 3));
            cells.extend([
                least,
                range.least_at.clone(),
                most,
                range.largest_at.clone(),
            ]);
        }
        let name = output_name(&output.output);
        table.named(
            format!("{name}, {} [{}]", output.car, sign(&output.unit)),
            cells,
        );
    }
    table
}

/// Name of an output without its unit.
fn output_name(column: &str) -> String {
    let units = [
        "_l_per_100km",
        "_percent",
        "_g_per_km",
        "_kj",
        "_km",
        "_kg",
        "_degc",
        "_s",
    ];
    let stem = units.iter().find_map(|unit| column.strip_suffix(unit));
    words(stem.unwrap_or(column))
}

/// Manifest keys of a factor, and heads of their columns.
const FACTOR: [(&str, &str); 8] = [
    ("name", "Factor"),
    ("key", "Key"),
    ("unit", "Unit"),
    ("cars", "Cars"),
    ("acts", "How"),
    ("values", "Values"),
    ("status", "Status"),
    ("source", "Where from"),
];

fn factors(study: &StudyResults) -> ReportTable {
    let list = study.manifest["factors"].as_array();
    let list = list.map_or(&[][..], Vec::as_slice);
    let caption = format!("Factors of the study ({})", list.len());
    let mut table = ReportTable::textual(&caption, &FACTOR.map(|(_, head)| head));
    let text = |value: &Value| match value {
        Value::String(text) => text.clone(),
        Value::Array(list) => {
            let word = |v: &Value| v.as_str().map_or_else(|| v.to_string(), str::to_owned);
            list.iter().map(word).collect::<Vec<_>>().join(", ")
        }
        Value::Null => String::new(),
        other => other.to_string(),
    };
    for factor in list {
        table.row(FACTOR.map(|(key, _)| text(&factor[key])));
    }
    table
}

/// Builds the report of a study.
///
/// # Errors
/// A part cannot be read.
pub fn document(study: &StudyResults) -> Result<Document, Problem> {
    if study.outline.levers.is_some() {
        return levers::document(study);
    }
    let answer = &study.answer;
    let mut first = Section::new("answer", "Answer");
    if !answer.question.is_empty() {
        first.blocks.push(Block::Lead(answer.question.clone()));
    }
    let alert = unfinished(study, "what follows is what they say");
    let answers = answers(study).into_iter().map(Block::Text);
    first.blocks.extend(alert.into_iter().chain(answers));
    first.text(extent(study));
    let mut details = details(study, &[])?;
    if answer.matrix.is_none() {
        details.title = "Outputs and factors".to_owned();
    }
    let sections = vec![first, conditions(study), details, reproduce(study)];
    Ok(Document {
        title: answer.title.clone(),
        subtitle: format!("study of {}", study.outline.cars.join(", ")),
        sections,
        warnings: study.unfinished().into_iter().collect(),
        ..Document::default()
    })
}
