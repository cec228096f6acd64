//! The outcome of a calibration as CSV files.

use cvtcycle_output::columns;
use cvtcycle_output::table::{Column, csv_bytes};

use super::outcome::{Outcome, Parameter, Residual};

/// Name and contents of every table that has rows. Numbers read back to the same `f64`; a missing one is an empty cell.
#[must_use]
pub fn tables(outcome: &Outcome) -> Vec<(String, Vec<u8>)> {
    let names = outcome.parameters.iter().map(|p| p.name.as_str());
    let rows: Vec<(&str, &[Option<f64>])> = names
        .zip(outcome.correlation.iter().map(Vec::as_slice))
        .collect();
    let files = [
        (
            "parameters.csv",
            csv_bytes(&parameters(), &outcome.parameters),
        ),
        ("residuals.csv", csv_bytes(&residuals(), &outcome.residuals)),
        ("correlation.csv", csv_bytes(&correlation(outcome), &rows)),
    ];
    let with_rows = files
        .into_iter()
        .filter_map(|(name, bytes)| Some((name.to_owned(), bytes?)));
    with_rows.collect()
}

fn parameters() -> Vec<Column<Parameter>> {
    columns! { Parameter;
        text "parameter", "", "", p => p.name.clone();
        text "unit", "", "", p => p.unit.clone();
        number "file_value", "", "", p => p.file_value;
        number "fitted", "", "", p => p.value;
        optional "standard_error", "", "", p => p.standard_error;
        number "low", "", "", p => p.low;
        number "high", "", "", p => p.high;
        text "at_bound", "", "", p => p.at_bound.unwrap_or_default().to_owned();
        optional "prior_mean", "", "", p => p.prior.map(|prior| prior[0]);
        optional "prior_sd", "", "", p => p.prior.map(|prior| prior[1]);
        text "prior_status", "", "", p => p.prior_status.clone();
        optional "prior_share", "", "", p => p.prior_share;
        text "source", "", "", p => p.source.clone();
    }
}

fn residuals() -> Vec<Column<Residual>> {
    columns! { Residual;
        text "group", "", "", r => r.group.clone();
        text "fold", "", "", r => r.fold.clone();
        text "label", "", "", r => r.label.clone();
        text "what", "", "", r => r.what.clone();
        text "column", "", "", r => r.column.clone();
        optional "time_s", "", "", r => r.time_s;
        text "unit", "", "", r => r.unit.clone();
        optional "measured_low", "", "", r => r.low;
        optional "measured_high", "", "", r => r.high;
        number "sd", "", "", r => r.sd;
        number "weight_sd", "", "", r => r.weight_sd;
        optional "before", "", "", r => r.before;
        number "after", "", "", r => r.after;
        optional "left_out", "", "", r => r.left_out;
        optional "before_sd", "", "", r => r.before_sd;
        number "after_sd", "", "", r => r.after_sd;
        optional "left_out_sd", "", "", r => r.left_out_sd;
        text "doubtful", "", "", r => r.doubtful.to_string();
    }
}

/// Name of a parameter and its correlations.
type NamedRow<'a> = (&'a str, &'a [Option<f64>]);

/// Row and column by the names of the parameters; an empty cell where a correlation is not known.
fn correlation<'a>(outcome: &Outcome) -> Vec<Column<NamedRow<'a>>> {
    let name = Column::text("parameter", "", "", |row: &NamedRow| row.0.to_owned());
    let of = |(k, p): (usize, &Parameter)| {
        Column::optional(p.name.clone(), "", "", move |row: &NamedRow| {
            row.1.get(k).copied().flatten()
        })
    };
    std::iter::once(name)
        .chain(outcome.parameters.iter().enumerate().map(of))
        .collect()
}
