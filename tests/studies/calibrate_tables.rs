//! Tables of artificial outcomes of a calibration.

use std::collections::HashMap;

use cvtcycle::calibrate::outcome::tables;
use cvtcycle::calibrate::outcome::{Direction, Fold, Outcome, Parameter, Residual, SCHEMA, Start};

#[path = "../fixtures/outcome.rs"]
mod outcomes;
use outcomes::{named, noise};

/// Rows of a CSV file by column name.
fn rows(bytes: &[u8]) -> Vec<HashMap<String, String>> {
    let mut reader = csv::Reader::from_reader(bytes);
    reader
        .deserialize()
        .collect::<Result<_, _>>()
        .expect("a sound file")
}

#[test]
fn tables_hold_every_number_unrounded() {
    let outcome = named("mixed");
    let written = tables(&outcome);
    let rows_of = |name: &str| {
        written
            .iter()
            .find(|(own, _)| own == name)
            .map(|(_, bytes)| rows(bytes))
            .expect("a table")
    };
    let number = |text: &str| text.parse::<f64>().ok();
    let same = |text: &str, x: Option<f64>| {
        assert_eq!(
            number(text).map(f64::to_bits),
            x.map(f64::to_bits),
            "{text}"
        )
    };
    let residuals = rows_of("residuals.csv");
    assert_eq!(residuals.len(), outcome.residuals.len());
    for (row, r) in residuals.iter().zip(&outcome.residuals) {
        assert_eq!(
            (&row["group"], &row["label"], &row["unit"]),
            (&r.group, &r.label, &r.unit)
        );
        let wanted = [
            ("measured_low", r.low),
            ("measured_high", r.high),
            ("sd", Some(r.sd)),
            ("weight_sd", Some(r.weight_sd)),
        ];
        let computed = [
            ("before", r.before),
            ("after", Some(r.after)),
            ("left_out", r.left_out),
            ("time_s", r.time_s),
        ];
        let in_sd = [
            ("before_sd", r.before_sd),
            ("after_sd", Some(r.after_sd)),
            ("left_out_sd", r.left_out_sd),
        ];
        wanted
            .into_iter()
            .chain(computed)
            .chain(in_sd)
            .for_each(|(name, x)| same(&row[name], x));
    }
    for (row, p) in rows_of("parameters.csv").iter().zip(&outcome.parameters) {
        assert_eq!(
            (&row["parameter"], &row["unit"], &row["source"]),
            (&p.name, &p.unit, &p.source)
        );
        let known = [
            ("file_value", Some(p.file_value)),
            ("fitted", Some(p.value)),
            ("standard_error", p.standard_error),
        ];
        let prior = [
            ("prior_mean", p.prior.map(|x| x[0])),
            ("prior_sd", p.prior.map(|x| x[1])),
            ("prior_share", p.prior_share),
        ];
        known
            .into_iter()
            .chain(prior)
            .chain([("low", Some(p.low)), ("high", Some(p.high))])
            .for_each(|(name, x)| same(&row[name], x));
    }
    for (row, line) in rows_of("correlation.csv").iter().zip(&outcome.correlation) {
        outcome
            .parameters
            .iter()
            .zip(line)
            .for_each(|(p, r)| same(&row[&p.name], *r));
    }
    assert!(tables(&named("nothing")).is_empty());
    assert!(noise(1).abs() <= 1.0);
}
