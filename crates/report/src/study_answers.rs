//! Results of a study in sentences.

use serde_json::Value;

use super::number::degc;
use super::results::StudyResults;
use cvtcycle_analysis::levers::{LeverAnswer, LeverBlock, answer_in_words, lever_answer};
use cvtcycle_analysis::words::study::sentences;
use cvtcycle_output::summary::Summary;

/// Differences between the cases of a study and of a run; `None` if they are equal.
///
/// Ambient and start count only if no factor sets them.
pub fn other_case(study: &StudyResults, run: &Summary) -> Option<String> {
    let (plan, base) = (&study.outline.plan, &study.manifest["base"]);
    let free = |key: &str| plan.factors.iter().all(|factor| factor.key != key);
    let mut list = Vec::new();
    let mut differ = |what: &str, own: &str, other: &str| {
        if own != other {
            list.push(format!("{what} {own} instead of {other}"));
        }
    };
    let cycles = study.manifest["cycles"].as_array().into_iter().flatten();
    let cycles: Vec<&str> = cycles.filter_map(|cycle| cycle["name"].as_str()).collect();
    if !cycles.contains(&run.cycle.as_str()) {
        differ("cycle", &cycles.join(", "), &run.cycle);
    }
    let subject = run.runs.first().map_or("", |run| run.vehicle.as_str());
    // Levers are driven in several cars and at several temperatures: one of each must match the run.
    let columns = study
        .outline
        .levers
        .as_ref()
        .map(|levers| &levers["columns"]);
    let columns = columns
        .and_then(Value::as_array)
        .map_or(&[][..], Vec::as_slice);
    let own = match columns.iter().find(|column| column["vehicle"] == subject) {
        Some(_) => subject,
        None => study.manifest["cars"][0]["name"]
            .as_str()
            .unwrap_or_default(),
    };
    differ("subject", own, subject);
    let is_own = |degc: &f64| (degc - run.ambient_degc).abs() <= 1e-9;
    let mut of_levers = columns
        .iter()
        .filter_map(|column| column["ambient_degc"].as_f64());
    let has_own = of_levers.any(|degc| is_own(&degc));
    let ambient = base["ambient_degc"].as_f64();
    let ambient = ambient.filter(|own| !is_own(own) && !has_own);
    if let Some(ambient) = ambient.filter(|_| free("ambient_degc")) {
        differ("ambient", &degc(ambient), &degc(run.ambient_degc));
    }
    let start = run.start.text();
    if let Some(own) = base["start"].as_str().filter(|_| free("start")) {
        differ("start", own, &start);
    }
    let same = |key: &str, own: &[String]| {
        let texts = base[key].as_array().into_iter().flatten();
        texts
            .filter_map(Value::as_str)
            .eq(own.iter().map(|text| &**text))
    };
    if !same("set", &run.settings.set) || !same("set_all", &run.settings.set_all) {
        list.push("other values set".to_owned());
    }
    (!list.is_empty()).then(|| list.join(", "))
}

/// Formats the answer of a study in sentences.
pub fn answers(study: &StudyResults) -> Vec<String> {
    sentences(&study.answer, &study.outline)
}

/// Levers for the car and the ambient temperature of a run, under its name in tables and figures. `None` for other studies, and if a part cannot
/// be read, which the section of the study reports.
pub fn levers_of_run(study: &StudyResults, run: &Summary) -> Option<(LeverAnswer, LeverBlock)> {
    study.outline.levers.as_ref()?;
    if other_case(study, run).is_some() {
        return None;
    }
    let mut answer = lever_answer(&study.frame().ok()?, study.answer.confidence).ok()?;
    let subject = run.runs.first().map_or("", |run| run.vehicle.as_str());
    let is_own = |block: &LeverBlock| {
        block.vehicle == subject && (block.ambient_degc - run.ambient_degc).abs() <= 1e-9
    };
    let own = answer.blocks.iter().position(is_own)?;
    let mut block = answer.blocks.swap_remove(own);
    block.vehicle = study.label(&block.vehicle);
    Some((answer, block))
}

/// Formats the answer of a study on the case of a run; for levers that of its car and ambient temperature.
pub fn answers_of_run(study: &StudyResults, run: &Summary) -> Vec<String> {
    if study.outline.levers.is_none() {
        return answers(study);
    }
    let own = levers_of_run(study, run);
    own.map_or_else(Vec::new, |(answer, block)| answer_in_words(&answer, &block))
}
