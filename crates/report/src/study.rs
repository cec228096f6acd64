//! What a study says: as a section of a run's report, or as a report of its own.

use serde_json::Value;

use super::document::{Block, Document, Section, Table};
use super::found::StudyFound;
use super::number::{NONE, Quantity, degc, phase, words};
use super::run::unfinished;
use super::study_pictures::study_pictures;
use cvtcycle_config::Problem;
use cvtcycle_output::summary::{StartWord, Summary};
use cvtcycle_study::ambient::Matrix;
use cvtcycle_study::answer::{Comparison, OutputAnswer};
use cvtcycle_study::outputs::EXCESS;
use cvtcycle_study::plan::Design;

/// Factors told in words.
const TOLD: usize = 3;

/// In what a study is another case than a run; none if it is the same.
///
/// Ambient and start count only where no factor sets them.
#[must_use]
pub fn other_case(study: &StudyFound, run: &Summary) -> Option<String> {
    let (manifest, base) = (&study.manifest, &study.manifest["base"]);
    let free = |key: &str| {
        study
            .outline
            .plan
            .factors
            .iter()
            .all(|factor| factor.key != key)
    };
    let mut list = Vec::new();
    let cycles: Vec<&str> = manifest["cycles"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(|cycle| cycle["name"].as_str())
        .collect();
    if !cycles.contains(&run.cycle.as_str()) {
        list.push(format!(
            "cycle {} instead of {}",
            cycles.join(", "),
            run.cycle
        ));
    }
    let subject = run.runs.first().map_or("", |run| run.vehicle.as_str());
    let own = study.outline.cars.first().map_or("", String::as_str);
    if own != subject {
        list.push(format!("subject {own} instead of {subject}"));
    }
    if let Some(ambient) = base["ambient_degc"]
        .as_f64()
        .filter(|_| free("ambient_degc"))
        && (ambient - run.ambient_degc).abs() > 1e-9
    {
        list.push(format!(
            "ambient {} instead of {}",
            degc(ambient),
            degc(run.ambient_degc)
        ));
    }
    let start = match &run.start {
        StartWord::Word(word) => word.clone(),
        StartWord::Degc(degc) => degc.to_string(),
    };
    if free("start") && base["start"].as_str().is_some_and(|own| own != start) {
        list.push(format!(
            "start {} instead of {start}",
            text_of(&base["start"])
        ));
    }
    let set = |value: &Value| -> Vec<String> {
        value
            .as_array()
            .into_iter()
            .flatten()
            .filter_map(Value::as_str)
            .map(str::to_owned)
            .collect()
    };
    if set(&base["set"]) != run.settings.set || set(&base["set_all"]) != run.settings.set_all {
        list.push("other values set".to_owned());
    }
    (!list.is_empty()).then(|| list.join(", "))
}

/// The answer of a study in sentences.
#[must_use]
pub fn answers(study: &StudyFound) -> Vec<String> {
    let answer = &study.answer;
    if answer.points_done == 0 {
        return Vec::new();
    }
    if let Some(matrix) = &answer.matrix {
        return matrix_answers(matrix);
    }
    answer
        .comparisons
        .iter()
        .flat_map(|comparison| {
            [
                Some(compared(study, comparison)),
                decided(study, comparison),
            ]
        })
        .flatten()
        .collect()
}

/// In how many pairs the subject uses more, and how much more.
///
/// Points that nobody has drawn are no sample: of a grid the share says nothing beyond its own points.
fn compared(study: &StudyFound, of: &Comparison) -> String {
    let subject = study
        .outline
        .cars
        .first()
        .map_or("the subject", String::as_str);
    let (excess, worse) = (&of.excess_percent, &of.worse);
    let signed = |x: f64| Quantity::Percent.signed(x);
    if worse.n == 0 {
        return format!(
            "The study \u{201c}{}\u{201d} has no pair of good runs of {subject} and {}.",
            study.answer.title, of.baseline
        );
    }
    let head = format!(
        "In the study \u{201c}{}\u{201d} {subject} uses more fuel than {}",
        study.answer.title, of.baseline
    );
    if !study.outline.plan.design.is_sampled() {
        let mean = signed(excess.mean);
        return format!(
            "{head} at {} of {} points; the excess is {} to {}, {mean} on average.",
            worse.k,
            worse.n,
            signed(excess.min),
            signed(excess.max)
        );
    }
    let percent = |share: f64| Quantity::Percent.bare(100.0 * share);
    let [low, high] = worse.interval95;
    format!(
        "{head} in {} of {} pairs, {} % (95 % interval {} to {} %). The excess is {} on average with a standard deviation of {} points; 90 % of the pairs lie between {} and {}.",
        worse.k,
        worse.n,
        percent(worse.share),
        percent(low),
        percent(high),
        signed(excess.mean),
        Quantity::Percent.bare(excess.sd),
        signed(excess.quantile(0.05)),
        signed(excess.quantile(0.95))
    )
}

/// Which factors decide the excess.
fn decided(study: &StudyFound, of: &Comparison) -> Option<String> {
    let output = study
        .answer
        .outputs
        .iter()
        .find(|o| o.output == EXCESS && o.car == of.baseline)?;
    let (measure, mut ranked) = ranked(study, output)?;
    ranked.retain(|(_, x)| x.is_finite());
    ranked.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    let told: Vec<String> = ranked
        .iter()
        .take(TOLD)
        .map(|(name, x)| format!("{name} ({})", Quantity::Index.bare(*x)))
        .collect();
    (!told.is_empty()).then(|| format!("Most decided by {} [{measure}].", told.join(", ")))
}

fn ranked(study: &StudyFound, output: &OutputAnswer) -> Option<(&'static str, Vec<(String, f64)>)> {
    if let Some(indices) = output.sobol.last() {
        let factors = study.outline.plan.factors.iter().zip(&indices.factors);
        return Some((
            "total share of the variance",
            factors
                .map(|(factor, i)| (factor.name.clone(), i.total.value))
                .collect(),
        ));
    }
    if let Some(tornado) = &output.tornado {
        return Some((
            "swing in percentage points",
            tornado
                .bars
                .iter()
                .map(|bar| (bar.name.clone(), bar.swing))
                .collect(),
        ));
    }
    let rank = output.rank.as_ref()?;
    Some((
        "rank correlation",
        rank.factors
            .iter()
            .zip(&rank.of.factors)
            .map(|(name, f)| (name.clone(), f.spearman.value))
            .collect(),
    ))
}

/// The excess at the coldest and the warmest ambient, for each start.
fn matrix_answers(matrix: &Matrix) -> Vec<String> {
    let (Some(subject), Some(total)) = (matrix.cars.first(), matrix.fuel.first()) else {
        return Vec::new();
    };
    let mut order: Vec<usize> = (0..matrix.ambient_degc.len()).collect();
    order.sort_by(|a, b| matrix.ambient_degc[*a].total_cmp(&matrix.ambient_degc[*b]));
    let (Some(&cold), Some(&warm)) = (order.first(), order.last()) else {
        return Vec::new();
    };
    let at = |numbers: &[f64], k: usize| {
        Quantity::Percent.signed(numbers.get(k).copied().unwrap_or(f64::NAN))
    };
    let mut list = Vec::new();
    for (baseline, by_start) in matrix.cars.iter().skip(1).zip(&total.excess_percent) {
        let told: Vec<String> = matrix
            .starts
            .iter()
            .zip(by_start)
            .map(|(start, numbers)| {
                let (cold_degc, warm_degc) = (
                    degc(matrix.ambient_degc[cold]),
                    degc(matrix.ambient_degc[warm]),
                );
                format!(
                    "{} at {cold_degc} and {} at {warm_degc} (start {start})",
                    at(numbers, cold),
                    at(numbers, warm)
                )
            })
            .collect();
        list.push(format!(
            "Fuel of {subject} over {baseline}: {}.",
            told.join("; ")
        ));
    }
    list
}

/// The study as a section of a report.
///
/// # Errors
/// A part that cannot be read.
pub fn section(study: &StudyFound) -> Result<Section, Problem> {
    let mut section = details(study)?;
    let mut blocks = Vec::new();
    if !study.answer.question.is_empty() {
        blocks.push(Block::Text(study.answer.question.clone()));
    }
    blocks.extend(
        unfinished(study).map(|text| Block::Alert(format!("{text}; what follows is theirs."))),
    );
    blocks.push(Block::Text(extent(study)));
    blocks.extend(answers(study).into_iter().map(Block::Text));
    section.blocks.splice(0..0, blocks);
    Ok(section)
}

/// Tables and pictures of a study.
fn details(study: &StudyFound) -> Result<Section, Problem> {
    let answer = &study.answer;
    let mut section = match &answer.matrix {
        Some(_) => Section::new("ambient", "Ambient temperatures"),
        None => Section::new("uncertainty", &answer.title),
    };
    if answer.points_done == 0 {
        section.text("No part of the study is there yet.");
        section.blocks.push(Block::Folded(factors(study)));
        return Ok(section);
    }
    if let Some(matrix) = &answer.matrix {
        tables(&mut section, matrix);
    } else {
        section.table(outputs(study));
    }
    let frame = study.frame()?;
    for (name, picture) in study_pictures(answer, &frame, &study.warm_ups)? {
        let caption = caption(&name, study);
        section.figure(name, caption, picture);
    }
    section.blocks.push(Block::Folded(factors(study)));
    Ok(section)
}

fn caption(name: &str, study: &StudyFound) -> String {
    let of = &study.answer.title;
    match name.split('_').next().unwrap_or_default() {
        "distribution" => format!("How the output is distributed over the samples of \u{201c}{of}\u{201d}."),
        "sobol" => "Share of the variance that each factor explains, alone and with its interactions, with 95 % intervals.".to_owned(),
        "convergence" => "The same indices from growing parts of the samples: whether there are enough of them.".to_owned(),
        "tornado" => "What each factor does by itself, from its low to its high value.".to_owned(),
        "ranks" => "Rank correlation of the output with each factor, with 95 % intervals.".to_owned(),
        "effects" => "Mean output at each level of each factor.".to_owned(),
        "ambient" if name.contains("penalty") => "Fuel of the subject over that of each baseline, against ambient temperature.".to_owned(),
        "ambient" => "Fuel against ambient temperature, whole cycle and phases.".to_owned(),
        "warm" => "Oil temperatures over the cycle at each ambient temperature.".to_owned(),
        _ => format!("{} of \u{201c}{of}\u{201d}.", words(name)),
    }
}

/// How many points and runs, and how they ended.
fn extent(study: &StudyFound) -> String {
    let (answer, outline) = (&study.answer, &study.outline);
    let runs = outline.points * outline.cars.len() as u64;
    let mut text = format!(
        "{} points of {} factors, {runs} runs of {}.",
        answer.points,
        outline.plan.factors.len(),
        outline.cars.join(", ")
    );
    let bad = answer.runs.failed + answer.runs.not_run;
    if bad > 0 {
        let reasons: Vec<String> = answer
            .runs
            .reasons
            .iter()
            .take(3)
            .map(|(reason, n)| format!("{n} \u{d7} {reason}"))
            .collect();
        text += &format!(
            " {bad} runs have no good numbers and count in no statistics ({}).",
            reasons.join(", ")
        );
    }
    text
}

fn tables(section: &mut Section, matrix: &Matrix) {
    for part in &matrix.fuel {
        let name = if part.name == "total" {
            "whole cycle".to_owned()
        } else {
            phase(&part.name)
        };
        let fuel_columns = matrix
            .cars
            .iter()
            .map(|car| (car.clone(), Quantity::Fuel.unit().to_owned()));
        let excess = matrix
            .cars
            .iter()
            .skip(1)
            .map(|car| (format!("over {car}"), "%".to_owned()));
        let mut table = Table::of_numbers(
            &format!("Fuel, {name}"),
            "Start, ambient",
            fuel_columns.chain(excess),
        );
        for (s, start) in matrix.starts.iter().enumerate() {
            for (a, ambient) in matrix.ambient_degc.iter().enumerate() {
                let fuel = part
                    .l_per_100km
                    .iter()
                    .map(|by| Quantity::Fuel.bare(by[s][a]));
                let excess = part
                    .excess_percent
                    .iter()
                    .map(|by| Quantity::Percent.bare_signed(by[s][a]));
                table.row(
                    [format!("{start}, {}", degc(*ambient))]
                        .into_iter()
                        .chain(fuel)
                        .chain(excess),
                );
            }
        }
        section.table(table);
    }
    let columns = matrix.ends.iter().flat_map(|end| {
        matrix.cars.iter().map(move |car| {
            (
                format!("{car}, {}", end.name),
                Quantity::Degc.unit().to_owned(),
            )
        })
    });
    let mut table = Table::of_numbers("Temperatures at the end", "Start, ambient", columns);
    for (s, start) in matrix.starts.iter().enumerate() {
        for (a, ambient) in matrix.ambient_degc.iter().enumerate() {
            let cells = matrix
                .ends
                .iter()
                .flat_map(|end| end.degc.iter().map(|by| Quantity::Degc.bare(by[s][a])));
            table.row(
                [format!("{start}, {}", degc(*ambient))]
                    .into_iter()
                    .chain(cells),
            );
        }
    }
    section.blocks.push(Block::Folded(table));
}

fn outputs(study: &StudyFound) -> Table {
    // Of one factor at a time the base would count many times in everything but the extremes.
    let one_by_one = matches!(study.outline.plan.design, Design::OneAtATime { .. });
    let names: &[&str] = if one_by_one {
        &["runs", "least", "most"]
    } else {
        &["runs", "mean", "standard deviation", "5 %", "95 %"]
    };
    let columns = names.iter().map(|name| ((*name).to_owned(), String::new()));
    let mut table = Table::of_numbers("Outputs", "Output", columns);
    for output in &study.answer.outputs {
        let s = &output.summary;
        let digits = |x: f64| {
            if x.is_finite() {
                format!("{x:.3}").replace('-', "\u{2212}")
            } else {
                NONE.to_owned()
            }
        };
        let name = format!(
            "{}, {} [{}]",
            output_name(&output.output),
            output.car,
            output.unit
        );
        let numbers = if one_by_one {
            vec![s.min, s.max]
        } else {
            vec![s.mean, s.sd, s.quantile(0.05), s.quantile(0.95)]
        };
        table.row(
            [name, s.n.to_string()]
                .into_iter()
                .chain(numbers.into_iter().map(digits)),
        );
    }
    table
}

/// An output without its unit, which stands beside it.
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
    words(
        units
            .iter()
            .find_map(|unit| column.strip_suffix(unit))
            .unwrap_or(column),
    )
}

fn factors(study: &StudyFound) -> Table {
    let list = study.manifest["factors"]
        .as_array()
        .cloned()
        .unwrap_or_default();
    let mut table = Table::of_words(
        &format!("Factors of the study ({})", list.len()),
        &[
            "Factor",
            "Key",
            "Unit",
            "Cars",
            "How",
            "Values",
            "Status",
            "Where from",
        ],
    );
    let text = |value: &Value| match value {
        Value::String(text) => text.clone(),
        Value::Array(list) => list
            .iter()
            .map(|v| v.as_str().map_or_else(|| v.to_string(), str::to_owned))
            .collect::<Vec<_>>()
            .join(", "),
        Value::Null => String::new(),
        other => other.to_string(),
    };
    for factor in &list {
        table.row(
            [
                "name", "key", "unit", "cars", "acts", "values", "status", "source",
            ]
            .map(|key| text(&factor[key])),
        );
    }
    table
}

/// The report of a study.
///
/// # Errors
/// A part that cannot be read.
pub fn document(study: &StudyFound) -> Result<Document, Problem> {
    let answer = &study.answer;
    let mut first = Section::new("answer", "Answer");
    if !answer.question.is_empty() {
        first.blocks.push(Block::Lead(answer.question.clone()));
    }
    first.blocks.extend(
        unfinished(study)
            .map(|text| Block::Alert(format!("{text}; what follows is what they say."))),
    );
    first
        .blocks
        .extend(answers(study).into_iter().map(Block::Text));
    first.text(extent(study));
    let mut details = details(study)?;
    if answer.matrix.is_none() {
        details.title = "Outputs and factors".to_owned();
    }
    let sections = vec![first, conditions(study), details, reproduce(study)];
    Ok(Document {
        title: answer.title.clone(),
        subtitle: format!("study of {}", study.outline.cars.join(", ")),
        sections,
        warnings: unfinished(study).into_iter().collect(),
        ..Document::default()
    })
}

fn text_of(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Null => NONE.to_owned(),
        Value::Array(list) if list.is_empty() => NONE.to_owned(),
        Value::Array(list) => list.iter().map(text_of).collect::<Vec<_>>().join(", "),
        Value::Number(x) => x.as_f64().map_or_else(
            || x.to_string(),
            |x| format!("{x}").replace('-', "\u{2212}"),
        ),
        other => other.to_string(),
    }
}

fn conditions(study: &StudyFound) -> Section {
    let mut section = Section::new("conditions", "Conditions");
    let base = &study.manifest["base"];
    let names = [
        ("cycle", "Cycle"),
        ("ambient_degc", "Ambient [\u{b0}C], where no factor sets it"),
        ("start", "Start, where no factor sets it"),
        ("vehicle", "Subject"),
        ("baselines", "Baselines"),
        ("lubricant", "Transmission oil of the subject"),
        ("engine_oil", "Engine oil"),
        ("set", "Set for the subject"),
        ("set_all", "Set for all cars"),
        ("dt_s", "Longest step [s]"),
        ("formulation", "Belt model"),
    ];
    let told = names.iter().filter(|(key, _)| !base[*key].is_null());
    section.blocks.push(Block::Facts(
        told.map(|(key, name)| ((*name).to_owned(), text_of(&base[*key])))
            .collect(),
    ));
    let mut table = Table::of_words(
        "Cars",
        &[
            "Car",
            "Role",
            "What it is",
            "Transmission oil",
            "Engine oil",
        ],
    );
    for car in study.manifest["cars"].as_array().into_iter().flatten() {
        table.row(
            ["name", "role", "title", "lubricant", "engine_oil"].map(|key| text_of(&car[key])),
        );
    }
    section.table(table);
    section
}

fn reproduce(study: &StudyFound) -> Section {
    let mut section = Section::new("reproducibility", "Reproducibility");
    let manifest = &study.manifest;
    let design = &manifest["design"];
    let mut facts = vec![
        (
            "Program of the study".to_owned(),
            text_of(&manifest["program"]),
        ),
        (
            "Plan".to_owned(),
            "plan.toml in the directory of the study, run again by: cvtcycle study plan.toml"
                .to_owned(),
        ),
        (
            "Plan, SHA-256".to_owned(),
            text_of(&manifest["plan_sha256"]),
        ),
        ("Design".to_owned(), words(&text_of(&design["kind"]))),
    ];
    for key in ["samples", "seed", "quantile"] {
        if !design[key].is_null() {
            facts.push((format!("Design, {key}"), text_of(&design[key])));
        }
    }
    for (list, key) in [("cycles", "Cycle"), ("cars", "Car")] {
        for one in manifest[list].as_array().into_iter().flatten() {
            facts.push((
                format!("{key} {}, SHA-256", text_of(&one["name"])),
                text_of(&one["sha256"]),
            ));
        }
    }
    section.blocks.push(Block::Facts(facts));
    section
}
