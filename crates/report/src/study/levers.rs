//! Results of a study of levers, as a section of a run's report or as a separate report.

use cvtcycle_analysis::answer::Answer;
use cvtcycle_analysis::levers::{LeverAnswer, LeverBlock, LeverRow, answer_in_words, lever_answer};
use cvtcycle_config::Problem;
use cvtcycle_study::execute::side_effects::{FLOOR, LUGGING};

use super::conditions::{conditions, reproduce};
use super::{ended_badly, unfinished};
use crate::document::{Block, Document, ReportTable, Section};
use crate::number::{NONE, Quantity, degc, grouped, signed};
use crate::results::StudyResults;
use crate::study_pictures::lever_pictures;

/// Maximum number of levers of a car in the body of a run's report.
const SHOWN: usize = 12;

/// Builds the section on levers.
///
/// # Errors
/// A part cannot be read.
pub fn section(study: &StudyResults) -> Result<Section, Problem> {
    let answer = answer_of(study)?;
    let mut section = said(study, &answer, "levers", "Levers");
    let all = details(&answer).blocks;
    for block in &answer.blocks {
        section.table(numbers(&answer, block, Some(SHOWN)));
    }
    section.more = all;
    Ok(section)
}

/// The section on levers that were driven for a report.
pub fn computed(answer: &Answer, block: &LeverBlock) -> Section {
    let mut section = Section::new("levers", "Levers");
    let Some(mut levers) = answer.levers.clone() else {
        return section;
    };
    levers.blocks = vec![block.clone()];
    let words = answer_in_words(&levers, block).into_iter();
    section.blocks.extend(words.map(Block::Text));
    let (draws, plan) = (answer.draws, &answer.plan);
    section.text(format!(
        "{draws} draws of {plan}, its ranges relative to the values of this car, the same for all cars of this document.{}",
        ended_badly(&levers.runs)
    ));
    for note in &levers.notes {
        section.text(format!("Note: {note}."));
    }
    section.table(numbers(&levers, block, Some(SHOWN)));
    section.more = details(&levers).blocks;
    section
}

/// Builds the report of a study of levers.
///
/// # Errors
/// A part cannot be read.
pub fn document(study: &StudyResults) -> Result<Document, Problem> {
    let answer = answer_of(study)?;
    let cars: Vec<&str> = named(&answer.blocks, |block| block.vehicle.as_str());
    let sections = vec![
        said(study, &answer, "answer", "Answer"),
        details(&answer),
        conditions(study),
        reproduce(study),
    ];
    let ambients = named(&answer.blocks, |block| degc(block.ambient_degc)).join(", ");
    Ok(Document {
        title: format!("What is worth changing: {}", cars.join(", ")),
        subtitle: format!("levers, each against the car as it is; ambient {ambients}"),
        sections,
        warnings: study.unfinished().into_iter().collect(),
        ..Document::default()
    })
}

fn answer_of(study: &StudyResults) -> Result<LeverAnswer, Problem> {
    let mut answer = lever_answer(&study.frame()?, study.answer.confidence)?;
    for block in &mut answer.blocks {
        block.vehicle = study.label(&block.vehicle);
    }
    Ok(answer)
}

/// Distinct properties of the blocks, in their order.
fn named<'b, T: PartialEq>(
    blocks: &'b [LeverBlock],
    property: impl Fn(&'b LeverBlock) -> T,
) -> Vec<T> {
    let mut list = Vec::new();
    for value in blocks.iter().map(property) {
        if !list.contains(&value) {
            list.push(value);
        }
    }
    list
}

/// A car at an ambient temperature.
fn case(block: &LeverBlock) -> String {
    format!("{} at {}", block.vehicle, degc(block.ambient_degc))
}

/// Answer in sentences, with the number of runs behind it.
fn said(study: &StudyResults, answer: &LeverAnswer, id: &str, title: &str) -> Section {
    let mut section = Section::new(id, title);
    section
        .blocks
        .extend(unfinished(study, "what follows is what they say"));
    for block in &answer.blocks {
        section.heading(&case(block));
        let words = answer_in_words(answer, block).into_iter();
        section.blocks.extend(words.map(Block::Text));
    }
    let runs = study.outline.points * study.outline.cars.len() as u64;
    let from = match &answer.plan {
        Some(plan) => format!("{} paired draws of {plan}, {runs} runs.", answer.draws),
        None => format!("{runs} runs of the cars as their files have them, without draws."),
    };
    section.text(from + &ended_badly(&answer.runs));
    let doubts = match answer.plan {
        Some(_) => answer.enough.doubts(answer.confidence),
        None => Vec::new(),
    };
    for note in doubts.iter().chain(&answer.notes) {
        section.text(format!("Note: {note}."));
    }
    section
}

/// Pictures and tables.
fn details(answer: &LeverAnswer) -> Section {
    let mut section = Section::new("levers", "What each lever saves");
    for (block, (name, picture)) in answer.blocks.iter().zip(lever_pictures(answer)) {
        let caption = format!("Change of the fuel by each lever, {}.", case(block));
        section.figure(name, caption, picture);
        section.table(numbers(answer, block, None));
    }
    if let Some(block) = answer.blocks.first() {
        section.folded(what_they_take(block));
    }
    section
}

/// Table of the first levers, or all of them, and the combinations.
fn numbers(answer: &LeverAnswer, block: &LeverBlock, most: Option<usize>) -> ReportTable {
    let [low, high] = answer
        .confidence
        .ends()
        .map(|p| format!("{:.0} %", 100.0 * p));
    let columns = [
        ("Fuel", "%"),
        (low.as_str(), "%"),
        (high.as_str(), "%"),
        ("Saves in", ""),
        ("Clamp safety", ""),
        ("At a floor", "s"),
        ("Short of flow", "s"),
        ("Slow engine", "s"),
    ];
    let columns = columns.map(|(name, unit)| (name.to_owned(), unit));
    let caption = format!("Levers, {}", case(block));
    let mut table = ReportTable::numeric(&caption, "Lever", columns);
    let digits = block.decimals();
    let single = block.rows.iter().filter(|row| !row.is_combination());
    let together = block.rows.iter().filter(|row| row.is_combination());
    let shown = single.take(most.unwrap_or(usize::MAX)).chain(together);
    for row in shown {
        let name = match row.failed {
            0 => row.of.title.clone(),
            failed => format!("{} (fails in {failed})", row.of.title),
        };
        match row.is_combination() {
            true => table.strong(name, cells(answer, row, digits)),
            false => table.named(name, cells(answer, row, digits)),
        }
    }
    table.note = format!(
        "Fuel: median of the runs with the uncertain values varied, and the values below which these shares of them lie. Saves in: runs of those that did not fail. Worst of all runs: clamp safety; seconds with \
         a floor of the pressure, with too little flow, and slow, that is below {:.0} rpm above half load with the clutch closed. Runs in which a lever fails a check are left out.",
        answer.heard_rpm
    );
    table
}

/// Cells of a row; all rows of a table have the same decimals.
fn cells(answer: &LeverAnswer, row: &LeverRow, digits: usize) -> Vec<String> {
    let drawn = answer.plan.is_some() && row.n > 0;
    let [low, high] = [row.low_percent.value, row.high_percent.value];
    let digits = if drawn { digits } else { 2 };
    let change = |x: f64| signed(grouped(x, digits), x);
    let of_draws = |x: f64| match drawn {
        true => change(x),
        false => NONE.to_owned(),
    };
    let saves = match drawn {
        true => format!("{} of {}", row.saves.k, row.saves.n),
        false => NONE.to_owned(),
    };
    let seconds = |name: &str| Quantity::Seconds.bare(row.worst(name));
    vec![
        change(row.fuel_percent.value),
        of_draws(low),
        of_draws(high),
        saves,
        grouped(row.worst("min_clamp_safety"), 2),
        seconds(FLOOR),
        seconds("flow_limited_s"),
        seconds(LUGGING),
    ]
}

/// Table of the change and the requirement of each lever, and the source of its size.
fn what_they_take(block: &LeverBlock) -> ReportTable {
    let heads = ["Lever", "Changes", "Needs", "Status", "Where from"];
    let mut table = ReportTable::textual("What the levers change and take", &heads);
    for row in block.rows.iter().filter(|row| !row.is_combination()) {
        let lever = &row.of;
        let words = [
            &lever.title,
            &lever.set.join(", "),
            &lever.needs,
            &lever.status,
            &lever.source,
        ];
        table.row(words.map(String::clone));
    }
    table
}
