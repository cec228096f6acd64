//! A CSV file of totals of a run: `quantity`, `value`, `sd`, and `phase` where a phase alone is meant.

use super::sheet::{self, Sheet};
use cvtcycle_config::csv::{Cells, Column};
use cvtcycle_config::{Bound, Problem, Problems, did_you_mean};

/// Reads totals of a run with these quantities and, where they are known, phases, as far as they can be understood; and all problems of the
/// file.
pub fn read(
    file: &str,
    bytes: &[u8],
    quantities: &[&'static str],
    phases: Option<&[String]>,
) -> (Option<Sheet>, Problems) {
    let columns = [
        Column::new("quantity", Cells::Word).required(),
        Column::number("value", Bound::any()).required(),
        Column::number("sd", Bound::positive()).required(),
        Column::new("phase", Cells::Word).or_empty(),
    ];
    let (sheet, mut problems) = sheet::read(file, bytes, columns, "", None);
    let Some(sheet) = sheet else {
        return (None, problems.finish());
    };
    let (quantity, phase) = (sheet.find("quantity"), sheet.find("phase"));
    for row in 0..sheet.rows.len() {
        let word = sheet.word(row, quantity);
        if !word.is_empty() && !quantities.contains(&word) {
            problems.add(sheet.problem(row, quantity.unwrap_or(0), no_quantity(word, quantities)));
        }
        let word = sheet.word(row, phase);
        let known =
            |phases: &&[String]| word.is_empty() || phases.iter().any(|phase| phase == word);
        if let Some(phases) = phases.filter(|phases| !known(phases)) {
            let problem = Problem::unknown_name(format!("the cycle has no phase `{word}`"))
                .allowed(phases.join(", "))
                .hint("leave the cell empty for the whole cycle");
            problems.add(sheet.problem(row, phase.unwrap_or(0), problem));
        }
    }
    (Some(sheet), problems.finish())
}

fn no_quantity(word: &str, quantities: &[&'static str]) -> Problem {
    let rest = |full: &str| full.strip_prefix(word).map(|rest| rest.starts_with('_'));
    let with_unit = quantities
        .iter()
        .copied()
        .filter(|full| rest(full) == Some(true));
    let with_unit: Vec<&str> = with_unit.collect();
    if !with_unit.is_empty() {
        return Problem::unknown_name("this quantity has no unit")
            .allowed(with_unit.join(", "))
            .hint("name it by its unit, and see that the value is in it");
    }
    let hint = did_you_mean(word, quantities.iter().copied());
    let allowed = "totals of a run, such as fuel_l_per_100km or end_sump_degc: docs/calibration.md lists them";
    Problem::unknown_name("there is no such quantity")
        .allowed(allowed)
        .hint(hint.unwrap_or_else(|| "remove the row or rename it".to_owned()))
}
