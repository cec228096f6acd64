//! Losses by component and by phase.

use super::svg_checks::{check, numbers};
use cvtcycle::output::Component;
use cvtcycle::report::charts::figures::{CarLosses, PhaseLosses, loss_by_component, loss_by_phase};

fn car(name: &str, losses: &[(Component, f64)]) -> CarLosses {
    CarLosses {
        name: name.to_owned(),
        losses_kj: losses.to_vec(),
        distance_km: 11.0,
    }
}

#[test]
fn bars_are_in_proportion_and_shares_are_of_the_own_car() {
    let cars = [
        car(
            "one",
            &[
                (Component::Pump, 550.0),
                (Component::BeltBand, 400.0),
                (Component::BeltFilm, 0.01),
                (Component::FinalDrive, 0.0),
            ],
        ),
        car(
            &"long & odd <name> ".repeat(12),
            &[(Component::Churning, 275.0)],
        ),
    ];
    let picture = loss_by_component(&cars, "conditions");
    check(&picture);
    let doc = roxmltree::Document::parse(&picture.svg).expect("well-formed");
    let width = |row: &str| {
        let bar = doc
            .descendants()
            .find(|n| n.attribute("class") == Some("bar") && n.attribute("data-row") == Some(row));
        bar.and_then(|n| n.attribute("width"))
            .and_then(|w| w.parse::<f64>().ok())
            .unwrap_or(0.0)
    };
    assert!(
        (width("0") / width("4") - 2.0).abs() < 0.01,
        "one scale for all cars"
    );
    assert!((width("0") / width("1") - 550.0 / 400.0).abs() < 0.01);
    let shares: f64 = picture.table.rows[..4]
        .iter()
        .map(|row| numbers(&row[3]))
        .sum();
    assert!((shares - 100.0).abs() < 0.03);
    assert_eq!(picture.table.rows[4][3], "100.00");
}

#[test]
fn no_data_and_non_finite_numbers_give_valid_pictures() {
    for cars in [
        vec![],
        vec![car("", &[])],
        vec![car(
            "x",
            &[(Component::Seal, f64::NAN), (Component::Bearing, 0.0)],
        )],
    ] {
        check(&loss_by_component(&cars, "conditions"));
    }
}

#[test]
fn stacked_parts_join_and_the_label_is_their_sum() {
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
    let phase_losses = PhaseLosses {
        subject: "s".to_owned(),
        cars: vec!["a".to_owned(), "very long name of a car & more".repeat(4)],
        groups,
    };
    let picture = loss_by_phase(&phase_losses);
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
fn a_picture_without_phases_is_valid() {
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
