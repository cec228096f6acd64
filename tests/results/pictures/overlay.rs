//! Traces of two runs.

use super::svg_checks::{check, numbers};
use cvtcycle::report::charts::figures::{Overlay, OverlayPanel, overlay};

fn two() -> Overlay {
    let wave = |k: f64, n: u32| (1..=n).map(|i| (f64::from(i), k * f64::from(i))).collect();
    let mut gap: Vec<(f64, f64)> = wave(0.001, 1180);
    gap[4].1 = f64::NAN;
    let panel = |title: &str, unit, a, b| OverlayPanel {
        title: title.to_owned(),
        unit,
        runs: [a, b],
    };
    Overlay {
        title: "Two runs".to_owned(),
        subject: "ece15_eudc".to_owned(),
        names: ["one & <other>".to_owned(), "name ".repeat(80)],
        panels: vec![
            panel("Sump", "degC", wave(0.05, 1180), wave(0.04, 1000)),
            panel("Belt ratio", "-", gap, Vec::new()),
        ],
    }
}

#[test]
fn lines_and_table_are_the_traces() {
    let picture = overlay(&two());
    check(&picture);
    assert_eq!(picture.svg.matches("class=\"series\"").count(), 3);
    assert!(picture.table.rows.len() <= 600 && picture.table.note.starts_with("One of 2"));
    let third = &picture.table.rows[2];
    assert!(
        (numbers(&third[0]) - 5.0).abs() < 1e-9
            && (numbers(&third[1]) - 0.25).abs() < 0.06
            && third[3].is_empty()
            && third[4].is_empty()
    );
    assert_eq!(
        picture.table.rows.last().map(|row| row[2].clone()),
        Some(String::new()),
        "B has ended"
    );
    let doc = roxmltree::Document::parse(&picture.svg).expect("well-formed");
    let frames: Vec<_> = doc
        .descendants()
        .filter(|n| n.has_attribute("data-x0"))
        .collect();
    assert_eq!(frames.len(), 2);
    assert!(
        frames
            .iter()
            .all(|n| n.attribute("data-x0") == Some("0.0")
                && n.attribute("data-x1") == Some("1180.0"))
    );
}

#[test]
fn a_value_between_two_steps_is_interpolated() {
    let a = vec![(1.0, 10.0), (3.0, 30.0), (4.0, f64::NAN)];
    let b = [0.5, 1.0, 2.0, 3.0, 3.5, 9.0]
        .map(|time| (time, 0.0))
        .to_vec();
    let panel = |a, b| OverlayPanel {
        runs: [a, b],
        ..OverlayPanel::default()
    };
    let picture = overlay(&Overlay {
        panels: vec![panel(a, b.clone()), panel(Vec::new(), b)],
        ..Overlay::default()
    });
    let rows = picture.table.rows;
    let column = |k: usize| {
        rows.iter()
            .map(|row| numbers(&row[k]))
            .collect::<Vec<f64>>()
    };
    assert_eq!(column(0), [0.5, 1.0, 2.0, 3.0, 3.5, 4.0, 9.0]);
    for (x, wanted) in
        column(1)
            .into_iter()
            .zip([None, Some(10.0), Some(20.0), Some(30.0), None, None, None])
    {
        assert!(
            wanted.map_or(x.is_nan(), |wanted: f64| (x - wanted).abs() < 1e-9),
            "{x}"
        );
    }
    assert!(column(3).into_iter().all(f64::is_nan), "no points at all");
}

#[test]
fn an_empty_picture_is_valid() {
    check(&overlay(&Overlay::default()));
    check(&overlay(&Overlay {
        panels: vec![OverlayPanel::default(); 4],
        ..Overlay::default()
    }));
    let broken = OverlayPanel {
        runs: [vec![(f64::NAN, 1.0), (2.0, f64::INFINITY)], Vec::new()],
        ..OverlayPanel::default()
    };
    check(&overlay(&Overlay {
        panels: vec![broken],
        ..Overlay::default()
    }));
}
