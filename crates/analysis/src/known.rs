//! Draws the intervals that the program carries for the usual cases of shipped cars (`words::intervals`).

use crate::draws::{drive, prepare};
use crate::words::intervals::{CASES, DRAWS, HEAD, PLAN, plan_sha256};
use cvtcycle_config::Problems;
use cvtcycle_config::setup::{Options, load};
use cvtcycle_output::progress::NoProgress;
use cvtcycle_output::provenance::{car_sha256, cycle_sha256};
use cvtcycle_study::plan::Plan;

/// Draws a case: a line of the file.
///
/// # Errors
/// Problems of the plan or of its cars.
pub fn draw((cycle, ambient_degc, start): (&str, f64, &str)) -> Result<String, Problems> {
    let mut base = Plan::open(PLAN)?.base;
    cycle.clone_into(&mut base.cycle);
    base.ambient_degc = ambient_degc;
    start.clone_into(&mut base.start);
    let cars = [
        &base.vehicle,
        &base.baselines.clone().unwrap_or_default()[0],
    ]
    .map(|word| Ok(car_sha256(&load(word, &Options::default())?)));
    let [subject, baseline]: [Result<String, Problems>; 2] = cars;
    let (subject, baseline) = (subject?, baseline?);
    let study = prepare(&base, DRAWS)?;
    let found = drive(&study, &NoProgress)?;
    let Some((_, of)) = found.and_then(|found| found.into_iter().next()) else {
        return Ok(String::new());
    };
    let (of_cycle, plan) = (cycle_sha256(&study.cycles[0]), plan_sha256());
    let (n, more, [low, median, high]) = (of.draws, of.more, of.percent);
    Ok(format!(
        "{cycle},{ambient_degc},{start},{subject},{baseline},{of_cycle},{plan},{n},{more},{low:.3},{median:.3},{high:.3}\n"
    ))
}

/// The whole file.
///
/// # Errors
/// As [`draw`].
pub fn file() -> Result<String, Problems> {
    let mut text = HEAD.to_owned() + "\n";
    for case in CASES {
        text += &draw(case)?;
    }
    Ok(text)
}
