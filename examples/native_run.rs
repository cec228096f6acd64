//! Median time of a run without Python, us, as the reference of `benches/python.py`.

#![allow(clippy::print_stdout, reason = "an example shows its result")]

use std::hint::black_box;
use std::time::Instant;

use cvtcycle::config::cycle;
use cvtcycle::config::setup::{Options, load};
use cvtcycle::model::drive::{Conditions, Start, drive};

fn main() -> Result<(), cvtcycle::config::Problems> {
    let (car, cycle) = (
        load("rover_216_cvt", &Options::default())?,
        cycle::find("ece15_eudc")?,
    );
    let conditions = Conditions {
        ambient_k: 298.15,
        start: Start::Soak,
        max_dt_s: 1.0,
        keep_rows: false,
    };
    let mut times: Vec<f64> = (0..400)
        .map(|_| {
            let begun = Instant::now();
            black_box(drive(&car, &cycle, &conditions));
            begun.elapsed().as_secs_f64() * 1e6
        })
        .collect();
    times.sort_by(f64::total_cmp);
    println!("{}", times[times.len() / 2]);
    Ok(())
}
