//! Pictures of the answer of a study.

use crate::charts::Picture;
use crate::charts::ambient::{ambient_fuel, ambient_penalty, warm_up};
use crate::charts::lever_strip;
use crate::charts::study::{
    DistributionSeries, EffectFactor, KnownValue, Shown, convergence_plot, distribution_plot,
    effects_plot, rank_plot, sobol_plot, tornado_plot,
};
use crate::document::plain;
use crate::results::StudyResults;
use cvtcycle_analysis::levers::LeverAnswer;
use cvtcycle_analysis::words::study::fleet_range;
use cvtcycle_config::{Problem, Problems};
use cvtcycle_output::escape::json_text;
use cvtcycle_output::fleet_spread::DrivenOn;
use cvtcycle_study::answer::ambient::{Matrix, WarmUp};
use cvtcycle_study::answer::{Column, OutputAnswer, described, tables};
use cvtcycle_study::execute::outputs::{EXCESS, FUEL};
use cvtcycle_study::statistics::{Confidence, Groups};
use cvtcycle_study::{Answer, StudyManifest, StudyTable};

/// Draws every picture that the answer has data for, with names that are valid file names: for a matrix of ambient temperatures fuel, excess
/// and, where traces were kept, warm-up; else for the outputs named in the plan, or for fuel and excess. `known` are numbers of the excess over
/// baselines by their names.
///
/// # Errors
/// A part of the study cannot be read.
pub fn study_pictures(
    answer: &Answer,
    frame: &StudyTable,
    warm_ups: &[WarmUp],
    known: &[(String, KnownValue)],
) -> Result<Vec<(String, Picture)>, Problem> {
    match &answer.matrix {
        Some(matrix) => Ok(matrix_pictures(matrix, warm_ups, frame.outline)),
        None => output_pictures(answer, frame, known),
    }
}

/// Numbers and figures of a study, by file name.
///
/// # Errors
/// A part of the study cannot be read.
pub fn study_files(found: &StudyResults) -> Result<Vec<(String, Vec<u8>)>, Problems> {
    let statistics = json_text(&found.answer)?.into_bytes();
    let mut files = vec![("statistics.json".to_owned(), statistics)];
    files.extend(tables(&found.answer, &found.outline));
    let pictures = study_pictures(&found.answer, &found.frame()?, &found.warm_ups, &[])?;
    let svg = pictures
        .into_iter()
        .map(|(name, picture)| (format!("{name}.svg"), picture.svg.into_bytes()));
    files.extend(svg);
    Ok(files)
}

/// Pictures of the levers' savings, for each car at each ambient temperature, with names that are valid file names.
pub fn lever_pictures(answer: &LeverAnswer) -> impl Iterator<Item = (String, Picture)> {
    answer.blocks.iter().map(|block| {
        let name = format!("levers_{}_{}", block.vehicle, block.ambient_degc);
        (plain(&name), lever_strip(answer, block))
    })
}

fn matrix_pictures(
    matrix: &Matrix,
    warm_ups: &[WarmUp],
    outline: &StudyManifest,
) -> Vec<(String, Picture)> {
    let title = &outline.title;
    let range = |baseline: usize, degc: f64, percent: f64| {
        let on = DrivenOn::whole(&outline.plan.base.cycle, degc);
        Some(fleet_range(outline, baseline, percent, on)?.ends)
    };
    let penalty = ambient_penalty(matrix, title, &range);
    let penalty = penalty.map(|picture| ("ambient_penalty".to_owned(), picture));
    let mut list: Vec<(String, Picture)> = penalty.into_iter().collect();
    list.push(("ambient_fuel".to_owned(), ambient_fuel(matrix, title)));
    if warm_ups.is_empty() {
        return list;
    }
    for (k, start) in matrix.starts.iter().enumerate() {
        let picture = warm_up(matrix, warm_ups, k, title);
        list.push((plain(&format!("warm_up_{start}")), picture));
    }
    list
}

fn output_pictures(
    answer: &Answer,
    frame: &StudyTable,
    known: &[(String, KnownValue)],
) -> Result<Vec<(String, Picture)>, Problem> {
    let outline = frame.outline;
    let mut list = Vec::new();
    let outputs = answer.outputs.iter();
    let pictured: Vec<&OutputAnswer> = outputs
        .filter(|output| is_pictured(&output.output, outline))
        .collect();
    for (k, output) in pictured.iter().enumerate() {
        let same = |other: &&&OutputAnswer| other.output == output.output;
        // For pairs the difference matters: two fuel distributions would hide that both vary together.
        let is_paired =
            output.output == FUEL && pictured.iter().any(|other| other.output == EXCESS);
        let is_first = !pictured[..k].iter().any(|other| same(&other));
        if outline.plan.design.is_sampled() && is_first && !is_paired {
            let same: Vec<&&OutputAnswer> = pictured.iter().filter(same).collect();
            let picture = distribution(frame, &same, answer.confidence, known)?;
            list.push((format!("distribution_{}", output.output), picture));
        }
        let name = |kind: &str| format!("{kind}_{}_{}", output.output, output.car);
        let own = pictures_of_output(output, outline, answer.confidence).into_iter();
        list.extend(own.map(|(kind, picture)| (name(kind), picture)));
    }
    Ok(list)
}

fn is_pictured(output: &str, outline: &StudyManifest) -> bool {
    !outline.plan.analyse.is_empty() || [FUEL, EXCESS].contains(&output)
}

/// Name of an output for people.
fn named(output: &OutputAnswer, outline: &StudyManifest) -> String {
    let subject = outline.cars.first().map_or("", String::as_str);
    let stem = output.output.trim_end_matches("_percent");
    let words = stem.trim_end_matches("_l_per_100km").replace('_', " ");
    match output.output.as_str() {
        FUEL => format!("fuel of {}", output.car),
        EXCESS => format!("excess fuel of {subject} over {}", output.car),
        _ => format!("{words}, {}", output.car),
    }
}

fn distribution(
    frame: &StudyTable,
    outputs: &[&&OutputAnswer],
    confidence: Confidence,
    known: &[(String, KnownValue)],
) -> Result<Picture, Problem> {
    let outline = frame.outline;
    let mut values = Vec::new();
    for output in outputs {
        let car = outline.cars.iter().position(|car| *car == output.car);
        values.push(described(frame, &output.output, car.unwrap_or(0))?);
    }
    let first = outputs.first().map_or("", |output| output.output.as_str());
    let excess = first.starts_with("subject_excess_");
    let over = if excess { "over " } else { "" };
    let names = outputs.iter().map(|output| format!("{over}{}", output.car));
    let names: Vec<String> = names.collect();
    let known = outputs.iter().map(|output| {
        let mut own = known.iter().filter(|(car, _)| *car == output.car);
        let own = own.next().filter(|_| first == EXCESS);
        own.map_or_else(KnownValue::default, |(_, known)| *known)
    });
    let series = names.iter().zip(&values).zip(known);
    let series = series.map(|((name, values), known)| DistributionSeries {
        name,
        values,
        known,
    });
    let series: Vec<DistributionSeries<Column>> = series.collect();
    let title = match first {
        FUEL => "fuel".to_owned(),
        output if excess => {
            let subject = outline.cars.first().map_or("", String::as_str);
            format!("excess fuel of {subject}{}", tail(output))
        }
        output => output.replace('_', " "),
    };
    let unit = outputs.first().map_or("", |output| output.unit.as_str());
    let shown = Shown {
        output: &title,
        unit,
        subject: &outline.title,
        confidence,
    };
    distribution_plot(&shown, &series, excess)
}

/// Phase of an excess over a phase, as a suffix.
fn tail(output: &str) -> String {
    let phase = output
        .strip_prefix("subject_excess_")
        .and_then(|rest| rest.strip_suffix("_percent"));
    phase.map_or_else(String::new, |phase| {
        format!(" in {}", phase.replace('_', " "))
    })
}

fn pictures_of_output(
    output: &OutputAnswer,
    outline: &StudyManifest,
    confidence: Confidence,
) -> Vec<(&'static str, Picture)> {
    let name = named(output, outline);
    let shown = Shown {
        output: &name,
        unit: &output.unit,
        subject: &outline.title,
        confidence,
    };
    let factors = outline.plan.factors.iter();
    let names: Vec<String> = factors.map(|factor| factor.name.clone()).collect();
    let mut list = Vec::new();
    if let Some(indices) = output.sobol.last() {
        list.push(("sobol", sobol_plot(&shown, &names, indices)));
        list.push((
            "convergence",
            convergence_plot(&shown, &names, &output.sobol),
        ));
    }
    if let Some(tornado) = &output.tornado {
        list.push(("tornado", tornado_plot(&shown, tornado)));
    }
    if let Some(rank) = &output.rank {
        list.push(("ranks", rank_plot(&shown, &rank.factors, &rank.of)));
    }
    if !output.levels.is_empty() {
        let levels = output.levels.iter();
        let factors = levels.map(|(name, groups)| effect(name, groups, outline));
        list.push((
            "effects",
            effects_plot(&shown, &factors.collect::<Vec<_>>()),
        ));
    }
    list
}

/// Levels of a factor: at their numbers, or evenly spaced for words.
fn effect<'a>(name: &'a str, groups: &'a Groups, outline: &'a StudyManifest) -> EffectFactor<'a> {
    let mut factors = outline.plan.factors.iter();
    let factor = factors.find(|factor| factor.name == name);
    let unit = factor.map_or("", |factor| factor.unit.as_str());
    let levels = groups.groups.iter();
    let at: Option<Vec<f64>> = levels.map(|group| group.label.parse().ok()).collect();
    EffectFactor {
        name,
        unit,
        at: at.unwrap_or_default(),
        groups,
    }
}
