//! A CSV file of totals of a run: `quantity`, `value`, `sd`, and `phase` where a phase alone is meant.

use super::sheet::{self, Column, Sheet};
use super::unknown;
use crate::config::{Bound, Problem};
use crate::cycle::problems::Complaint;

/// Reads totals of a run with these quantities and phases.
///
/// # Errors
/// All problems of the file.
pub(crate) fn read(file: &str, bytes: &[u8], quantities: &[&'static str], phases: &[String]) -> Result<Sheet, Vec<Problem>> {
    let known = |name: &str| {
        let column = |range, may_be_empty| Ok(Column { name: name.to_owned(), range, may_be_empty });
        match name {
            "quantity" => column(None, false),
            "phase" => column(None, true),
            "value" => column(Some(Bound::any()), false),
            "sd" => column(Some(Bound::positive()), false),
            _ => Err(unknown(name, &["quantity", "phase", "value", "sd"], "quantity, value, sd, phase")),
        }
    };
    let sheet = sheet::read(file, bytes, &known, &["quantity", "value", "sd"])?;
    let mut problems = Vec::new();
    let (quantity, phase) = (sheet.find("quantity"), sheet.find("phase"));
    for row in 0..sheet.rows.len() {
        let word = sheet.word(row, quantity);
        if !quantities.contains(&word) {
            let mut complaint = unknown(word, quantities, &quantities.join(", "));
            complaint.message =
                complaint.message.replace("this column has", "this quantity has").replace("no such column", "no such quantity");
            problems.push(sheet.problem(row, quantity.unwrap_or(0), complaint));
        }
        let word = sheet.word(row, phase);
        if !word.is_empty() && !phases.iter().any(|phase| phase == word) {
            let message = format!("the cycle has no phase `{word}`");
            let hint = "leave the cell empty for the whole cycle";
            problems.push(sheet.problem(row, phase.unwrap_or(0), Complaint::new(message, phases.join(", "), hint)));
        }
    }
    if problems.is_empty() { Ok(sheet) } else { Err(problems) }
}
