//! Losses by component.

use super::svg_checks::{check, numbers};
use cvtcycle::output::Component;
use cvtcycle::report::charts::figures::{CarLosses, loss_by_component};

fn car(name: &str, losses: &[(Component, f64)]) -> CarLosses {
    CarLosses {
        name: name.to_owned(),
        losses_kj: losses.to_vec(),
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
    let picture = loss_by_component(&cars);
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
fn nothing_or_broken_numbers_are_still_pictures() {
    for cars in [
        vec![],
        vec![car("", &[])],
        vec![car(
            "x",
            &[(Component::Seal, f64::NAN), (Component::Bearing, 0.0)],
        )],
    ] {
        check(&loss_by_component(&cars));
    }
}
