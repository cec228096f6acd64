//! The same cycle in other units is the same drive.

use cvtcycle_model::drive::Row;
use cvtcycle_model::drive::{State, simulate};
use proptest::prelude::*;

use super::cars::recipes;
use super::hold;
use super::traces::{Write, read, traces};
use crate::common::{Keep, ZERO};

/// Name of a column and how km/h, or rise over run, are written in it. International mile: 1.609344 km.
const SPEEDS: [(&str, Write); 4] = [
    ("speed_kmh", |x| x),
    ("speed_km_h", |x| x),
    ("speed_m_s", |x| x / 3.6),
    ("speed_mph", |x| x / 1.609_344),
];
const GRADES: [(&str, Write); 2] = [("grade", |x| x), ("grade_percent", |x| 100.0 * x)];

/// Fuel kg, distance m, losses J, end temperatures K.
fn sums(rows: &[Row]) -> Vec<f64> {
    let sum = |f: &dyn Fn(&Row) -> f64| rows.iter().map(|row| f(row) * row.dt_s).sum::<f64>();
    let last = &rows[rows.len() - 1];
    vec![
        sum(&|row| row.fuel_kg_s),
        sum(&|row| row.speed_m_s),
        sum(&|row| row.loss_w.iter().sum()),
        sum(&|row| row.brake_w),
        last.coolant_k,
        last.sump_k,
    ]
}

/// Units are rounding: a last digit of the speed. The implicit solve leaves 1e-7, so that its path may differ by some of it.
#[test]
fn units_of_the_table_do_not_matter() {
    hold(
        300,
        &(recipes(0.1), traces(), -40.0..60.0),
        |(recipe, table, ambient)| {
            let car = recipe.car().setup.car(ZERO + ambient);
            let run = |speed, grade| {
                let cycle = read(&table.csv(0.0, speed, grade));
                let mut keep = Keep::default();
                simulate(
                    &car,
                    cycle.trace_for(car.transmission.is_cvt()),
                    1.0,
                    State::at(ZERO + ambient),
                    &mut keep,
                );
                sums(&keep.rows)
            };
            let plain = run(SPEEDS[0], GRADES[0]);
            for speed in SPEEDS {
                for grade in GRADES {
                    let other = run(speed, grade);
                    for (a, b) in plain.iter().zip(&other) {
                        let scale = a.abs() + 1e-3 * plain[2].min(1.0);
                        prop_assert!(
                            (a - b).abs() <= 1e-5 * scale,
                            "{} {}: {:?} instead of {:?}",
                            speed.0,
                            grade.0,
                            other,
                            plain
                        );
                    }
                }
            }
            Ok(())
        },
    );
}
