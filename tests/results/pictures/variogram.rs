//! Engine speed against vehicle speed.

use super::svg_checks::{check, numbers};
use cvtcycle::report::charts::figures::{GuideLine, Variogram, variogram};

fn line(name: &str, per_kmh: f64) -> GuideLine {
    GuideLine {
        name: name.to_owned(),
        points: (0..=40)
            .map(|k| (5.0 * f64::from(k), 5.0 * f64::from(k) * per_kmh))
            .collect(),
        whole: false,
    }
}

#[test]
fn all_time_is_in_the_table_and_lines_stay_in_the_panel() {
    let speed: Vec<f64> = (0..500).map(|k| 0.24 * f64::from(k)).collect();
    let rpm: Vec<f64> = speed
        .iter()
        .map(|v| (v * 100.0).clamp(850.0, 2600.0))
        .collect();
    let (mut speed, mut rpm, mut seconds) = (speed, rpm, vec![0.5; 500]);
    // A soak with the engine off is not an operating point.
    speed.push(0.0);
    rpm.push(0.0);
    seconds.push(600.0);
    let lines = vec![
        line("lowest ratio", 130.0),
        line("highest & <odd>", 22.0),
        line(&"a long name ".repeat(20), 40.0),
    ];
    let picture = variogram(&Variogram {
        subject: "s".to_owned(),
        conditions: "NEDC, ambient \u{2212}10 \u{b0}C".into(),
        speed_kmh: &speed,
        engine_rpm: &rpm,
        seconds: &seconds,
        lines,
    });
    check(&picture);
    let time: f64 = picture.table.rows.iter().map(|row| numbers(&row[4])).sum();
    assert!((time - 250.0).abs() < 1e-6, "{time}");
    assert_eq!(picture.svg.matches("class=\"series\"").count(), 3);
    assert_eq!(
        picture.svg.matches("class=\"cell\"").count(),
        picture.table.rows.len()
    );
    assert!(
        !picture.table.rows.iter().any(|row| row[2] == "0"),
        "the engine was off"
    );
    assert_eq!(
        picture
            .svg
            .matches("highest &amp; &lt;odd&gt;</text>")
            .count(),
        1
    );
}

#[test]
fn the_axis_takes_in_whole_lines_and_says_which_are_outside() {
    let (speed, rpm, seconds) = ([10.0, 90.0], [1500.0, 2400.0], [1.0, 1.0]);
    let flat = |name: &str, rpm: f64, whole| GuideLine {
        name: name.to_owned(),
        points: vec![(20.0, rpm), (95.0, rpm)],
        whole,
    };
    let lines = vec![flat("target", 3500.0, true), flat("beyond", 5900.0, false)];
    let picture = variogram(&Variogram {
        speed_kmh: &speed,
        engine_rpm: &rpm,
        seconds: &seconds,
        lines,
        ..Variogram::default()
    });
    check(&picture);
    assert!(picture.svg.contains(">target</text>") && !picture.svg.contains(">beyond</text>"));
    assert!(picture.table.note.ends_with("Outside the picture: beyond."));
}

#[test]
fn an_empty_picture_is_valid() {
    check(&variogram(&Variogram::default()));
    let broken = [f64::NAN, f64::INFINITY, 3.0];
    let lines = vec![GuideLine {
        name: String::new(),
        points: vec![(f64::NAN, 1.0), (0.0, 1.0)],
        whole: true,
    }];
    check(&variogram(&Variogram {
        speed_kmh: &broken,
        engine_rpm: &broken,
        seconds: &broken,
        lines,
        ..Variogram::default()
    }));
}
