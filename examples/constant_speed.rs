//! Fuel of the CVT car at constant speed, warm, for three pump displacements.
//!
//! `cargo run --release --example constant_speed`
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "an example is a program"
)]

use cvtcycle::config::cycle;
use cvtcycle::config::setup::{Options, load};
use cvtcycle::config::{Override, render};
use cvtcycle::model::drive::{Conditions, Start, drive, litres_per_100km};
use cvtcycle::model::lubricant::ZERO_DEGC_K;

fn main() {
    // Warm: the same 600 s have just been driven.
    let conditions = Conditions {
        ambient_k: 20.0 + ZERO_DEGC_K,
        start: Start::Warm,
        max_dt_s: 1.0,
        keep_rows: false,
    };
    println!("pump, cc/rev   90 km/h  120 km/h   (L/100 km)");
    for displacement in [6.0, 8.0, 9.8] {
        let pump = "transmission.cvt.pump.displacement_cc_rev";
        let set = vec![Override::number(pump, displacement)];
        let setup = match load(
            "rover_216_cvt",
            &Options {
                set,
                ..Options::default()
            },
        ) {
            Ok(setup) => setup,
            Err(problems) => {
                eprint!("{}", render(&problems, false));
                std::process::exit(2);
            }
        };
        let fuel = |name: &str| {
            let Some(Ok(cycle)) = cycle::constant_speed(name) else {
                return f64::NAN;
            };
            let total = drive(&setup, &cycle, &conditions).totals.total();
            let density_kg_m3 = setup.car(conditions.ambient_k).engine.fuel_density_kg_m3;
            litres_per_100km(total.fuel_kg, density_kg_m3, total.distance_m)
        };
        println!(
            "{displacement:12} {:9.2} {:9.2}",
            fuel("constant_90"),
            fuel("constant_120")
        );
    }
}
