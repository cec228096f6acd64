//! Losses by phase.

use super::svg_checks::{check, numbers};
use cvtcycle::output::Component;
use cvtcycle::report::charts::figures::{PhaseLosses, loss_by_phase};

#[test]
fn parts_stand_end_to_end_and_the_label_is_their_sum() {
    let parts = |k: f64| {
        vec![
            (Component::Pump, 40.0 * k),
            (Component::BeltBand, 0.0),
            (Component::FinalDrive, 25.5 * k),
        ]
    };
    let groups = vec![
        ("ece15".to_owned(), vec![parts(4.0), parts(1.0)]),
        ("e<u>dc".to_owned(), vec![parts(2.0), vec![]]),
    ];
    let of = PhaseLosses {
        subject: "s".to_owned(),
        cars: vec!["a".to_owned(), "very long name of a car & more".repeat(4)],
        groups,
    };
    let picture = loss_by_phase(&of);
    check(&picture);
    assert!(picture.svg.contains(">262.0</text>") && picture.svg.contains(">0.0</text>"));
    let all: f64 = picture.table.rows.iter().map(|row| numbers(&row[3])).sum();
    assert!((all - 65.5 * 7.0).abs() < 1e-6);
    let doc = roxmltree::Document::parse(&picture.svg).expect("well-formed");
    let number = |n: &roxmltree::Node, key: &str| {
        n.attribute(key)
            .and_then(|x| x.parse::<f64>().ok())
            .unwrap_or(f64::NAN)
    };
    let bars: Vec<_> = doc
        .descendants()
        .filter(|n| n.attribute("class") == Some("bar"))
        .take(2)
        .collect();
    assert!(
        (number(&bars[0], "x") + number(&bars[0], "width") - number(&bars[1], "x")).abs() < 0.5
    );
}

#[test]
fn nothing_is_still_a_picture() {
    check(&loss_by_phase(&PhaseLosses::default()));
    let no_cars = PhaseLosses {
        groups: vec![("g".to_owned(), vec![])],
        ..PhaseLosses::default()
    };
    check(&loss_by_phase(&no_cars));
    let broken = vec![("g".to_owned(), vec![vec![(Component::Seal, f64::NAN)]])];
    let soak = loss_by_phase(&PhaseLosses {
        cars: vec!["c".to_owned()],
        groups: broken,
        ..PhaseLosses::default()
    });
    check(&soak);
    assert!(soak.table.note.ends_with("per distance: g.") && soak.table.rows.is_empty());
}
