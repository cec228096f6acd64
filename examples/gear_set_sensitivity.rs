//! Effect of the manual car's gear set and driver on the like-for-like comparison: the CVT's penalty over plausible gear sets and shift speeds.
//! Run with `cargo run --release --example gear_set_sensitivity`.

#![allow(clippy::print_stdout, reason = "an example shows its result")]

use cvtcycle::config::Override;
use cvtcycle::config::cycle::{Cycle, embedded};
use cvtcycle::config::setup::{Options, load};
use cvtcycle::model::drive::{Conditions, Start, drive, litres_per_100km};

const GEAR_SETS: [(&str, &str); 4] = [
    ("shipped", "[13.45, 7.67, 5.25, 4.15, 3.33]"),
    ("long top gear", "[13.45, 7.67, 5.01, 3.77, 2.84]"),
    ("as the Mondeo", "[13.12, 8.65, 6.01, 4.51, 3.47]"),
    ("short", "[14.20, 8.10, 5.60, 4.45, 3.65]"),
];

const SHIFTS: [(&str, &str, &str); 3] = [
    ("early", "[13, 28, 42, 60]", "[9, 20, 34, 50]"),
    ("regulation's", "[15, 35, 50, 70]", "[10, 25, 40, 55]"),
    ("late", "[20, 42, 65, 90]", "[13, 32, 52, 75]"),
];

fn fuel(vehicle: &str, set: Vec<Override>, cycle: &Cycle) -> f64 {
    let setup = load(
        vehicle,
        &Options {
            set,
            ..Options::default()
        },
    )
    .expect("shipped vehicle");
    let conditions = Conditions {
        ambient_k: 298.15,
        start: Start::Soak,
        max_dt_s: 1.0,
        keep_rows: false,
    };
    let total = drive(&setup, cycle, &conditions).totals.total();
    litres_per_100km(total.fuel_kg, 745.0, total.distance_m)
}

fn main() {
    println!("CVT penalty in per cent of the 5-speed's L/100 km, 25 degC soak\n");
    for (cycle, note) in [
        ("ece15_eudc", "gears prescribed by the cycle"),
        ("ece15_eudc_auto", "same cycle, gears by shift speeds"),
        ("ftp75", "gears by shift speeds"),
    ] {
        let cycle = embedded(cycle).expect("embedded");
        let cvt = fuel("rover_216_cvt", vec![], &cycle);
        println!("{} ({note})", cycle.name);
        let schedules = if cycle.name == "ece15_eudc" {
            &SHIFTS[1..2]
        } else {
            &SHIFTS[..]
        };
        for (gears, ratios) in GEAR_SETS {
            let row: Vec<String> = schedules
                .iter()
                .map(|(name, up, down)| {
                    let set = [
                        ("overall_ratios", ratios),
                        ("upshift_kmh", up),
                        ("downshift_kmh", down),
                    ];
                    let by = |(key, value): (&str, &str)| {
                        Override::new(&format!("transmission.manual.{key}"), value)
                    };
                    let set = set.map(by).into_iter().collect::<Result<_, _>>();
                    let set = set.expect("keys with values");
                    let manual = fuel("rover_216_5mt", set, &cycle);
                    format!("{name} {:+.1}", 100.0 * (cvt / manual - 1.0))
                })
                .collect();
            println!("  {gears:15} {}", row.join("   "));
        }
    }
}
