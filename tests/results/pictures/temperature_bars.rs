//! Losses by temperature.

use super::svg_checks::{check, numbers};
use cvtcycle::output::Component;
use cvtcycle::report::charts::figures::{LossTrace, loss_by_temperature};

#[test]
fn energy_and_time_are_those_of_the_moving_car() {
    let seconds = [1.0, 2.0, 1.0, 0.5, 3.0, 4.0];
    let sump = [-7.0, -6.0, -2.0, 12.0, 21.0, 24.9];
    let speed = [10.0, 20.0, 0.0, 30.0, 40.0, 50.0];
    let (pump, drive) = ([100.0, 400.0, 900.0, 9e9, 50.0, 85.0], [10.0; 6]);
    let losses_w = vec![
        (Component::Pump, &pump[..]),
        (Component::FinalDrive, &drive[..]),
    ];
    let trace = LossTrace {
        subject: "<a & b>".to_owned(),
        seconds: &seconds,
        sump_degc: &sump,
        speed_kmh: &speed,
        losses_w,
    };
    let picture = loss_by_temperature(&trace);
    check(&picture);
    let rows: Vec<Vec<f64>> = picture
        .table
        .rows
        .iter()
        .map(|row| row.iter().map(|cell| numbers(cell)).collect())
        .collect();
    assert_eq!(
        rows,
        [
            [-10.0, -5.0, 3.0, 300.0, 10.0, 310.0],
            [20.0, 25.0, 7.0, 70.0, 10.0, 80.0]
        ]
    );
    assert!(picture.table.note.contains("0.5 s in all") && picture.svg.contains("go together"));
}

#[test]
fn many_temperatures_make_wider_bins() {
    let sump: Vec<f64> = (0..400).map(|k| -40.0 + 0.5 * f64::from(k)).collect();
    let (ones, speed) = (vec![1.0; 400], vec![30.0; 400]);
    let losses_w = vec![(Component::Churning, &ones[..])];
    let trace = LossTrace {
        seconds: &ones,
        sump_degc: &sump,
        speed_kmh: &speed,
        losses_w,
        ..LossTrace::default()
    };
    let picture = loss_by_temperature(&trace);
    check(&picture);
    assert!(picture.table.rows.len() <= 20 && picture.table.rows.len() > 5);
    let time: f64 = picture.table.rows.iter().map(|row| numbers(&row[2])).sum();
    assert!((time - 400.0).abs() < 1e-9);
}

#[test]
fn nothing_is_still_a_picture() {
    check(&loss_by_temperature(&LossTrace::default()));
    let broken = [f64::NAN, 1.0];
    let losses_w = vec![(Component::Seal, &broken[..1])];
    check(&loss_by_temperature(&LossTrace {
        seconds: &broken,
        sump_degc: &broken,
        speed_kmh: &broken,
        losses_w,
        ..LossTrace::default()
    }));
}
