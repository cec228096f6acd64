//! Spread of the difference between two shipped cars over the draws of a plan of uncertainty, drawn once for the usual cases.
//!
//! `intervals/penalty.csv` holds the results with the hashes of what they were made from; a row is used for a run of the same hashes only.
//! `cargo run --release --example intervals` writes the file, a test draws a row of it again.

use std::cell::OnceCell;

use cvtcycle_config::cycle::Cycle;
use cvtcycle_config::embedded;
use cvtcycle_config::setup::Setup;
use cvtcycle_output::provenance::{car_sha256, cycle_sha256, hash};
use cvtcycle_output::summary::DrawnDifference;

/// The file.
const TABLE: &str = include_str!("../../intervals/penalty.csv");
/// The plan that is drawn.
pub const PLAN: &str = "uncertainty_rover";
/// Number of draws.
pub(crate) const DRAWS: u64 = 256;
/// Head of the file.
pub(crate) const HEAD: &str = "cycle,ambient_degc,start,subject_sha256,baseline_sha256,cycle_sha256,plan_sha256,draws,more,percent_5,percent_50,percent_95";

/// Two cars under the conditions of a run.
pub struct Pair<'a> {
    /// The cycle.
    pub cycle: &'a Cycle,
    /// Ambient temperature, degC.
    pub ambient_degc: f64,
    /// `soak` or `warm`.
    pub start: &'a str,
    /// Subject and baseline.
    pub cars: [&'a Setup; 2],
    /// Hash of the cycle, once it is known.
    pub cycle_sha256: &'a OnceCell<String>,
    /// Hash of the subject, once it is known.
    pub subject_sha256: &'a OnceCell<String>,
}

/// Cycle, ambient temperature and start of the cases of the file.
pub const CASES: [(&str, f64, &str); 8] = [
    ("ece15_eudc", -30.0, "soak"),
    ("ece15_eudc", -10.0, "soak"),
    ("ece15_eudc", 0.0, "soak"),
    ("ece15_eudc", 25.0, "soak"),
    ("ece15_eudc", 25.0, "warm"),
    ("ftp75", 24.0, "soak"),
    ("wltc_class3b", 23.0, "soak"),
    ("wltc_class3b", -7.0, "soak"),
];

/// Finds the row of a case in the file; gives its cells.
fn row(pair: &Pair) -> Option<Vec<&'static str>> {
    let rows = TABLE
        .lines()
        .skip(1)
        .map(|line| line.split(',').collect::<Vec<_>>());
    let mut of_case = rows.filter(|cells| {
        let ambient = cells.get(1).and_then(|cell| cell.parse::<f64>().ok());
        let near = ambient.is_some_and(|degc| (degc - pair.ambient_degc).abs() < 1e-9);
        near && cells[0] == pair.cycle.name && cells.get(2) == Some(&pair.start)
    });
    // Hashes take longer than all else: only where a case has the names of this one.
    let row = of_case.next()?;
    let own = row.get(3..7)?;
    let [subject, baseline] = pair.cars;
    let of_subject = || pair.subject_sha256.get_or_init(|| car_sha256(subject));
    let of_cycle = || pair.cycle_sha256.get_or_init(|| cycle_sha256(pair.cycle));
    let same = own[0] == *of_subject()
        && own[1] == car_sha256(baseline)
        && own[2] == *of_cycle()
        && own[3] == plan_sha256();
    same.then_some(row)
}

pub(crate) fn plan_sha256() -> String {
    let text = embedded::plans().iter().find(|(name, _)| *name == PLAN);
    text.map_or_else(String::new, |(_, text)| hash(text.as_bytes()))
}

/// Looks up the interval of the difference; `None` for a case that was not drawn, or with other cars, another cycle or another plan.
pub fn known(pair: &Pair) -> Option<DrawnDifference> {
    let cells = row(pair)?;
    let count = |k: usize| cells.get(k)?.parse().ok();
    let number = |k: usize| cells.get(k)?.parse().ok();
    Some(DrawnDifference {
        fuel_l_per_100km: None,
        plan: PLAN.to_owned(),
        draws: count(7)?,
        left_out: DRAWS - count(7)?,
        reasons: Vec::new(),
        more: count(8)?,
        percent: [number(9)?, number(10)?, number(11)?],
        by_form: Vec::new(),
    })
}

/// The line of a case in the file that the program carries.
pub fn line((cycle, ambient_degc, start): (&str, f64, &str)) -> Option<&'static str> {
    let head = format!("{cycle},{ambient_degc},{start},");
    TABLE.lines().find(|line| line.starts_with(&head))
}
