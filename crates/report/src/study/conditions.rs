//! Inputs of a study, and instructions to repeat it.

use std::collections::BTreeSet;

use crate::document::{ReportTable, Section};
use crate::number::{NONE, minus, words};
use crate::results::StudyResults;
use serde_json::Value;

fn text_of(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Null => NONE.to_owned(),
        Value::Array(list) if list.is_empty() => NONE.to_owned(),
        Value::Array(list) => list.iter().map(text_of).collect::<Vec<_>>().join(", "),
        Value::Number(x) => minus(&x.as_f64().map_or_else(|| x.to_string(), |x| x.to_string())),
        other => other.to_string(),
    }
}

/// Names of the cars with their entries in the manifest; for a study of levers the unchanged cars.
fn cars(study: &StudyResults) -> impl Iterator<Item = (String, &Value)> {
    let levers = study.outline.levers.as_ref();
    let mut seen = BTreeSet::new();
    let cars = study.manifest["cars"].as_array().into_iter().flatten();
    cars.enumerate().filter_map(move |(k, car)| {
        let name = match levers {
            Some(_) if car["role"] != "reference" => return None,
            Some(levers) => text_of(&levers["columns"][k]["vehicle"]),
            None => text_of(&car["name"]),
        };
        seen.insert(name.clone()).then_some((name, car))
    })
}

/// Conditions common to all runs, and the cars.
pub(super) fn conditions(study: &StudyResults) -> Section {
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
    // Levers are driven at several ambient temperatures, which their tables name.
    let left_out = |key: &str| key == "ambient_degc" && study.outline.levers.is_some();
    let known = names
        .iter()
        .filter(|(key, _)| !base[*key].is_null() && !left_out(key));
    let fact = |(key, name): &(&str, &str)| ((*name).to_owned(), text_of(&base[*key]));
    section.facts(known.map(fact).collect());
    let columns = [
        "Car",
        "Role",
        "What it is",
        "Transmission oil",
        "Engine oil",
    ];
    let mut table = ReportTable::textual("Cars", &columns);
    for (name, car) in cars(study) {
        let keys = ["role", "title", "lubricant", "engine_oil"];
        table.row(std::iter::once(name).chain(keys.map(|key| text_of(&car[key]))));
    }
    section.table(table);
    section
}

/// Information needed to repeat the study.
pub(super) fn reproduce(study: &StudyResults) -> Section {
    let mut section = Section::new("reproducibility", "Reproducibility");
    let manifest = &study.manifest;
    let design = &manifest["design"];
    let plan = "plan.toml in the directory of the study, run again by: cvtcycle study plan.toml";
    let mut facts = vec![
        (
            "Program of the study".to_owned(),
            text_of(&manifest["program"]),
        ),
        ("Plan".to_owned(), plan.to_owned()),
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
    let cycles = manifest["cycles"].as_array().into_iter().flatten();
    let cycles = cycles.map(|one| (format!("Cycle {}", text_of(&one["name"])), one));
    let cars = cars(study).map(|(name, one)| (format!("Car {name}"), one));
    for (name, one) in cycles.chain(cars) {
        facts.push((format!("{name}, SHA-256"), text_of(&one["sha256"])));
    }
    section.facts(facts);
    section
}
