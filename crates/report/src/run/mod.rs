//! The report of a run: results first, then details.

mod answer;
mod conditions;
mod doubts;
mod energy;
mod figures;
mod reproduce;
mod values;

use super::document::{Document, Section};
use super::number::{degc, list_of, words};
use super::results::RunResults;
use super::{study, study_answers, validation};
use crate::charts::study::KnownValue;
use cvtcycle_config::Problem;
use cvtcycle_output::Component;
use cvtcycle_output::history::History;
use cvtcycle_output::record::{CarRecord, Record};
use cvtcycle_output::summary::{Comparison, RunSummary, StartWord, Summary};

pub(crate) use answer::{brief, strip};
pub(super) use conditions::change_table;
pub(crate) use energy::per_km;
pub use reproduce::hashes;

/// A car of a run with all its data.
#[derive(Clone, Copy)]
pub struct Car<'a> {
    /// Summary.
    pub run: &'a RunSummary,
    /// Inputs.
    pub record: Option<&'a CarRecord>,
    /// Trace.
    pub history: Option<&'a History>,
}

impl Car<'_> {
    /// Losses of the transmission, kJ, in the order of the power flow.
    pub fn losses_kj(&self) -> Vec<(Component, f64)> {
        let loss = |c: Component| Some((c, self.run.loss_kj.get(c.name())?));
        Component::ALL.into_iter().filter_map(loss).collect()
    }
}

/// Cars of a run, the subject first.
pub fn cars<'a>(found: &'a RunResults) -> Vec<Car<'a>> {
    let runs = found.summary.runs.iter().zip(&found.histories);
    let records = found.record.as_ref().map_or(&[][..], |record| &record.cars);
    let car = |(run, history): (&'a RunSummary, &'a Option<History>)| Car {
        run,
        record: records.iter().find(|car| car.name == run.vehicle),
        history: history.as_ref(),
    };
    runs.map(car).collect()
}

/// Builds the report of a run.
///
/// # Errors
/// A part of a study cannot be read.
pub fn document(found: &RunResults) -> Result<Document, Problem> {
    let cars = cars(found);
    let mut document = Document {
        title: title(&found.summary),
        subtitle: format!(
            "{}; {}",
            cycle_title(&found.summary, found.record.as_ref()),
            conditions_line(&found.summary)
        ),
        warnings: found.missing.clone(),
        ..Document::default()
    };
    let cycle = cycle_title(&found.summary, found.record.as_ref());
    document.running = format!(
        "{}, {}",
        answer::brief(&cycle),
        degc(found.summary.ambient_degc)
    );
    let of_run = |study| study_answers::levers_of_run(study, &found.summary);
    let options = found.studies.iter().find_map(of_run);
    let options = options.or_else(|| answer::computed_options(found));
    let mut sections = vec![
        answer::section(found, &cars, &options),
        doubts::section(found, &cars),
        conditions::section(found, &cars),
    ];
    sections.extend(figures::sections(found, &cars));
    if let (Some(answer), Some((_, block))) = (&found.answer, &options) {
        sections.push(study::levers::computed(answer, block));
    }
    for (k, own) in found.studies.iter().enumerate() {
        let known = match study_answers::other_case(own, &found.summary) {
            None => known(&found.summary),
            Some(_) => Vec::new(),
        };
        let mut section = study::section(own, &known)?;
        // The first of several studies of a kind keeps the unnumbered name.
        let same = |other: &Section| other.id == section.id;
        if sections.iter().any(same) {
            section.id = format!("{}-{k}", section.id);
        }
        document.warnings.extend(own.unfinished());
        sections.push(section);
    }
    sections.extend(values::section(found, &cars));
    sections.extend(found.validation.as_ref().map(validation::section));
    sections.push(reproduce::section(found, &cars));
    document.sections = sections;
    document.answer = found.answer.clone().map(Box::new);
    Ok(document)
}

/// Differences to the baselines from other sources than studies: with the nominal values, and published ones.
fn known(summary: &Summary) -> Vec<(String, KnownValue)> {
    let baselines = summary.runs.iter().skip(1).zip(&summary.comparison);
    let of = |(run, comparison): (&RunSummary, &Comparison)| {
        let known = KnownValue {
            nominal: comparison.fuel_percent,
            published: answer::published(summary, &run.vehicle),
        };
        // Named as in the labelled answer of a study.
        (run.label().to_owned(), known)
    };
    baselines.map(of).collect()
}

/// Maximum number of cars named in a title.
const NAMED: usize = 3;

fn title(summary: &Summary) -> String {
    let subject = summary.runs.first().map_or("", |run| run.title.as_str());
    let others = summary.runs.get(1..).unwrap_or_default();
    match others {
        [] => subject.to_owned(),
        [other] => format!("{subject} against {}", other.title),
        _ if others.len() <= NAMED => {
            let names: Vec<String> = others.iter().map(|run| run.label().to_owned()).collect();
            format!("{subject} against {}", list_of(&names))
        }
        _ => format!("{subject} against {} cars", others.len()),
    }
}

/// Name of the cycle for people.
pub fn cycle_title(summary: &Summary, record: Option<&Record>) -> String {
    let title = record.map(|r| r.cycle.title.clone());
    let title = title.filter(|title| !title.is_empty());
    title.unwrap_or_else(|| words(&summary.cycle))
}

/// The start in words.
pub fn start_line(summary: &Summary) -> String {
    match &summary.start {
        StartWord::Word(word) if word == "warm" => "warm start from the same cycle".to_owned(),
        StartWord::Word(_) => "cold start".to_owned(),
        StartWord::Degc(start) => format!("the car at {}", degc(*start)),
        StartWord::Nodes(_) => {
            let nodes = summary.start.nodes_in_words().unwrap_or_default();
            format!("start with {}", nodes.replace("degC", "\u{b0}C"))
        }
    }
}

/// Ambient and start in words.
pub fn conditions_line(summary: &Summary) -> String {
    let ambient = degc(summary.ambient_degc);
    format!("ambient {ambient}, {}", start_line(summary))
}
