//! The document on more than two runs of one cycle.

use super::many::{RunComparison, Side};
use crate::document::{Block, Document, ReportTable, Section};
use crate::number::{NONE, Quantity, grouped, list_of, signed, words};
use cvtcycle_analysis::words::{between, decimals};
use cvtcycle_output::summary::Over;

/// Builds the report of any number of runs, the first one the reference. A run that fails a check or slips is marked, and has no place in the order.
pub(crate) fn document(found: &RunComparison) -> Document {
    let names: Vec<String> = found.runs.iter().map(|run| run.name.clone()).collect();
    let mut sections = vec![answer(found), losses(found)];
    sections.extend(values(found));
    Document {
        title: format!("{} runs: {}", names.len(), list_of(&names)),
        subtitle: format!("each against {}", found.reference),
        sections,
        ..Document::default()
    }
}

/// Fuel of a run over what it has.
fn fuel(run: &Side) -> Option<f64> {
    match run.over() {
        Over::Distance => run.fuel_l_per_100km,
        Over::Time => run.fuel_l_per_h,
    }
}

fn answer(found: &RunComparison) -> Section {
    let mut section = Section::new("answer", "Answer");
    let good = || found.runs.iter().filter(|run| run.faults.is_empty());
    let least = good().filter_map(|run| Some((run, fuel(run)?)));
    if let Some((run, litres)) = least.min_by(|(_, a), (_, b)| a.total_cmp(b)) {
        let of = Quantity::fuel(run.over()).text(litres);
        let certain = run.drawn.as_ref().and_then(|drawn| drawn.ends());
        let certain = match certain {
            Some(ends) => format!(
                "; against {} 90 % of the runs with uncertain inputs varied give {}",
                found.reference,
                between(ends, "%")
            ),
            None => String::new(),
        };
        let lead = format!("{} uses least: {of}{certain}.", run.name);
        section.blocks.push(Block::Lead(lead));
    }
    for run in found.runs.iter().filter(|run| !run.faults.is_empty()) {
        let list: Vec<String> = run.faults.iter().map(|fault| words(fault)).collect();
        section.alert(format!(
            "{} failed: {}. Its numbers are not those of a car that drives this cycle, and it has no place in the order.",
            run.name,
            list_of(&list)
        ));
    }
    let over = found.runs.first().map_or(Over::Distance, Side::over);
    let columns = [
        ("Fuel", over.unit()),
        ("Against the first", "%"),
        ("90 %, uncertain inputs", ""),
        ("90 %, error of the model", ""),
        ("Clamp safety, least", ""),
    ];
    let mut table = ReportTable::numeric("Runs", "Run", columns);
    for run in &found.runs {
        let percent = run
            .difference_percent
            .filter(|_| run.name != found.reference);
        let drawn = run.drawn.as_ref().and_then(|drawn| drawn.ends());
        let digits = drawn.map_or(2, decimals);
        let range = |ends: Option<[f64; 2]>| {
            ends.map_or_else(|| NONE.to_owned(), |ends| between(ends, "%"))
        };
        let name = match run.faults.is_empty() {
            true => run.name.clone(),
            false => format!("{} (failed)", run.name),
        };
        table.named(
            name,
            [
                Quantity::fuel(run.over()).bare(fuel(run)),
                percent.map_or_else(|| NONE.to_owned(), |x| signed(grouped(x, digits), x)),
                range(drawn),
                range(run.fleet.as_ref().map(|range| range.ends)),
                run.min_clamp_safety
                    .map_or_else(|| NONE.to_owned(), |x| grouped(x, 2)),
            ],
        );
    }
    section.table(table);
    if let Some(cause) = found.cause() {
        section.text(cause + ".");
    }
    section
}

fn losses(found: &RunComparison) -> Section {
    let mut section = Section::new("losses", "Losses that differ");
    let over = found.runs.first().map_or(Over::Distance, Side::over);
    let unit = match over {
        Over::Distance => "kJ/km",
        Over::Time => "kJ/h",
    };
    let columns = found.runs.iter().map(|run| (run.name.clone(), unit));
    let mut table = ReportTable::numeric("Losses", "Component", columns);
    for component in &found.components {
        let of = |run: &Side| run.losses_kj(over).get(component).copied().flatten();
        let cells = found
            .runs
            .iter()
            .map(|run| of(run).map_or_else(|| NONE.to_owned(), |x| grouped(x, 2)));
        table.named(words(component), cells);
    }
    section.table(table);
    section
}

fn values(found: &RunComparison) -> Option<Section> {
    let values = found.values.as_ref().filter(|values| !values.is_empty())?;
    let mut section = Section::new("values", "Values that differ");
    let names = found.runs.iter().map(|run| run.name.as_str());
    let heads: Vec<&str> = ["Key", "Unit"].into_iter().chain(names).collect();
    let mut table = ReportTable::textual("Values", &heads);
    for value in values {
        let head = [value.key.clone(), value.unit.clone()];
        table.row(head.into_iter().chain(value.values.iter().cloned()));
    }
    section.table(table);
    Some(section)
}
