//! Custom CVT fluid: compares the same car over the cold NEDC with two fluids, and locates the difference.
//!
//! `cargo run --release --example own_lubricant -- my_fluid.toml` takes a file; the default is a thinner variant of the embedded one.
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "an example is a program"
)]

use cvtcycle::config::cycle;
use cvtcycle::config::setup::{Options, load};
use cvtcycle::config::{Override, Problems, render};
use cvtcycle::model::drive::{Conditions, Start, drive};
use cvtcycle::model::lubricant::ZERO_DEGC_K;
use cvtcycle::output::summary::{Driven, Settings, StartWord, Summary, summarise};

const AMBIENT_DEGC: f64 = -10.0;

fn main() {
    match compare(std::env::args().nth(1)) {
        Ok(summary) => print(&summary),
        Err(problems) => {
            eprint!("{}", render(&problems, false));
            std::process::exit(2);
        }
    }
}

fn compare(file: Option<String>) -> Result<Summary, Problems> {
    let thinner = vec![
        Override::number("lubricant.kv40_mm2_s", 26.0),
        Override::number("lubricant.kv100_mm2_s", 5.8),
    ];
    let set = if file.is_some() { Vec::new() } else { thinner };
    let own = load(
        "rover_216_cvt",
        &Options {
            lubricant: file,
            set,
            ..Options::default()
        },
    )?;
    let usual = load("rover_216_cvt", &Options::default())?;
    let cycle = cycle::embedded("ece15_eudc").ok_or_else(Problems::new)?;
    let ambient_k = AMBIENT_DEGC + ZERO_DEGC_K;
    let conditions = Conditions {
        ambient_k,
        start: Start::Soak,
        max_dt_s: 1.0,
        keep_rows: false,
    };
    let outcomes = [
        drive(&own, &cycle, &conditions),
        drive(&usual, &cycle, &conditions),
    ];
    let driven = [
        Driven {
            name: "own fluid",
            setup: &own,
            outcome: &outcomes[0],
        },
        Driven {
            name: "usual fluid",
            setup: &usual,
            outcome: &outcomes[1],
        },
    ];
    let settings = Settings {
        dt_s: conditions.max_dt_s,
        ..Settings::default()
    };
    Ok(summarise(
        &cycle,
        AMBIENT_DEGC,
        StartWord::Word("soak".to_owned()),
        settings,
        &driven,
    ))
}

fn print(summary: &Summary) {
    let (own, usual) = (&summary.runs[0], &summary.runs[1]);
    println!(
        "kJ over {} at {AMBIENT_DEGC} degC      {:>12} {:>12}",
        summary.cycle, own.vehicle, usual.vehicle
    );
    for (name, kj) in own.loss_kj.iter() {
        println!(
            "{name:34} {:12.1} {:12.1}",
            kj.unwrap_or(f64::NAN),
            usual.loss_kj.get(name).unwrap_or(f64::NAN)
        );
    }
    if let Some(percent) = summary.comparison[0].fuel_percent {
        println!("fuel: {percent:+.2} %");
    }
}
