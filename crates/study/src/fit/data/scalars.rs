//! A CSV file of totals of a run: `quantity`, `value`, `sd`, and `phase` where a phase alone is meant.

use super::sheet::{self, Column, Rules, Sheet};
use super::unknown;
use cvtcycle_config::cycle::problems::Complaint;
use cvtcycle_config::{Bound, Problems, near};

/// Reads totals of a run with these quantities and, where they are known, phases, as far as they can be understood; and all problems of the
/// file.
pub fn read(
    file: &str,
    bytes: &[u8],
    quantities: &[&'static str],
    phases: Option<&[String]>,
) -> (Option<Sheet>, Problems) {
    let known = |name: &str| {
        let column = |range, may_be_empty| {
            Ok(Column {
                name: name.to_owned(),
                range,
                may_be_empty,
            })
        };
        match name {
            "quantity" => column(None, false),
            "phase" => column(None, true),
            "value" => column(Some(Bound::any()), false),
            "sd" => column(Some(Bound::positive()), false),
            _ => Err(unknown(
                name,
                &["quantity", "phase", "value", "sd"],
                "quantity, value, sd, phase",
            )),
        }
    };
    let rules = Rules {
        known: &known,
        required: &["quantity", "value", "sd"],
        is_measured: None,
        example: "",
    };
    let (sheet, mut problems) = sheet::read(file, bytes, &rules);
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
            problems.add(sheet.problem(
                row,
                phase.unwrap_or(0),
                Complaint::new(message, phases.join(", "), hint),
            ));
        }
    }
    (Some(sheet), problems.finish())
}

fn no_quantity(word: &str, quantities: &[&'static str]) -> Complaint {
    let unit: Vec<&str> = quantities
        .iter()
        .copied()
        .filter(|full| {
            full.strip_prefix(word)
                .is_some_and(|rest| rest.starts_with('_'))
        })
        .collect();
    if !unit.is_empty() {
        return Complaint::new(
            "this quantity has no unit",
            unit.join(", "),
            "name it by its unit, and see that the value is in it",
        );
    }
    let close = near(word, quantities.iter().copied());
    let hint = if close.is_empty() {
        "remove the row or rename it".to_owned()
    } else {
        format!("did you mean {}?", close.join(" or "))
    };
    let allowed = "totals of a run, such as fuel_l_per_100km or end_sump_degc: docs/calibration.md lists them";
    Complaint::new("there is no such quantity", allowed, hint)
}
