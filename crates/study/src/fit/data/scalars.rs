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
    let columns = vec![
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
        if let Some(phases) =
            phases.filter(|phases| !word.is_empty() && !phases.iter().any(|phase| phase == word))
        {
            let message = format!("the cycle has no phase `{word}`");
            let hint = "leave the cell empty for the whole cycle";
            problems.add(
                sheet.problem(
                    row,
                    phase.unwrap_or(0),
                    Problem::invalid(message)
                        .allowed(phases.join(", "))
                        .hint(hint),
                ),
            );
        }
    }
    (Some(sheet), problems.finish())
}

fn no_quantity(word: &str, quantities: &[&'static str]) -> Problem {
    let unit: Vec<&str> = quantities
        .iter()
        .copied()
        .filter(|full| {
            full.strip_prefix(word)
                .is_some_and(|rest| rest.starts_with('_'))
        })
        .collect();
    if !unit.is_empty() {
        return Problem::invalid("this quantity has no unit")
            .allowed(unit.join(", "))
            .hint("name it by its unit, and see that the value is in it");
    }
    let hint = did_you_mean(word, quantities.iter().copied());
    let hint = hint.unwrap_or_else(|| "remove the row or rename it".to_owned());
    let allowed = "totals of a run, such as fuel_l_per_100km or end_sump_degc: docs/calibration.md lists them";
    Problem::invalid("there is no such quantity")
        .allowed(allowed)
        .hint(hint)
}
