//! Difference of two runs, term by term.

use super::svg_checks::{check, numbers};
use cvtcycle::output::Component;
use cvtcycle::report::charts::figures::{DifferenceTerm, EnergyDifference, Term, difference_bars};

fn two() -> EnergyDifference {
    let mut two = EnergyDifference {
        names: ["3 mm & <band>".to_owned(), "2 mm".to_owned()],
        fuel_kj_per_l: [32_000.0, 31_500.0],
        distance_km: [11.0, 10.9],
        terms: vec![
            DifferenceTerm::term("Heat to the engine", Term::EngineHeat, [15_000.0, 14_900.0]),
            DifferenceTerm::term("Rotating parts", Term::Kinetic, [-0.8, 0.0]),
            DifferenceTerm::component(Component::BeltBand, [390.0, 520.5]),
            DifferenceTerm::component(Component::BeltWedge, [110.0, 110.0]),
            DifferenceTerm::term("Rolling and air", Term::Wheels, [2300.0, 2310.0]),
        ],
        ..EnergyDifference::default()
    };
    two.fuel_kj = [0, 1].map(|k| two.terms.iter().map(|t| t.kj[k]).sum());
    two
}

#[test]
fn terms_add_up_to_the_difference_of_fuel() {
    let difference = two();
    let picture = difference_bars(&difference);
    check(&picture);
    let (fuel, terms) = picture.table.rows.split_last().expect("rows");
    for column in 1..7 {
        let sum: f64 = terms.iter().map(|row| numbers(&row[column])).sum();
        assert!(
            (sum - numbers(&fuel[column])).abs() < 0.03,
            "column {column}: {sum} {}",
            fuel[column]
        );
    }
    let (a, b) = (
        difference.fuel_kj[0] / 32_000.0 / 11.0 * 100.0,
        difference.fuel_kj[1] / 31_500.0 / 10.9 * 100.0,
    );
    assert!((numbers(&fuel[6]) - (b - a)).abs() < 1e-4);
}

#[test]
fn less_goes_left_of_zero_and_more_goes_right() {
    let picture = difference_bars(&two());
    let doc = roxmltree::Document::parse(&picture.svg).expect("well-formed");
    let edges = |row: &str| {
        let bar = doc
            .descendants()
            .find(|n| n.attribute("class") == Some("bar") && n.attribute("data-row") == Some(row))
            .expect("a bar");
        let number = |key: &str| {
            bar.attribute(key)
                .and_then(|x| x.parse::<f64>().ok())
                .expect("a number")
        };
        (number("x"), number("x") + number("width"))
    };
    let place = |name: &str| {
        let mut rows = picture.table.rows.iter();
        rows.position(|row| row[0].to_lowercase().starts_with(name))
            .expect("a row")
            .to_string()
    };
    let (heat, band) = (edges("0"), edges(&place("belt band")));
    assert!(
        (heat.1 - band.0).abs() <= 1.0,
        "both begin at zero: {heat:?} {band:?}"
    );
    assert!(((band.1 - band.0) / (heat.1 - heat.0) - 1.305).abs() < 0.01);
    let svg = picture.svg.replace('\u{a0}', " ");
    assert!(svg.contains("+130 kJ") || svg.contains("+131 kJ"));
}

#[test]
fn missing_terms_are_named_and_an_empty_picture_is_valid() {
    let mut difference = two();
    difference.fuel_kj[1] += 50.0;
    assert!(
        difference_bars(&difference)
            .svg
            .contains("Not accounted for")
    );
    assert!(!difference_bars(&two()).svg.contains("Not accounted for"));
    check(&difference_bars(&EnergyDifference::default()));
    let same = EnergyDifference {
        terms: vec![DifferenceTerm::component(Component::Seal, [5.0, 5.0])],
        fuel_kj: [5.0, 5.0],
        ..two()
    };
    check(&difference_bars(&same));
    let broken = EnergyDifference {
        terms: vec![DifferenceTerm::term(
            &"n".repeat(99),
            Term::Other,
            [f64::NAN, 1e9],
        )],
        fuel_kj: [0.0, 1e9],
        ..two()
    };
    check(&difference_bars(&broken));
    let falls = EnergyDifference {
        terms: vec![DifferenceTerm::component(Component::Seal, [9.0, 5.0])],
        fuel_kj: [9.0, 5.0],
        ..two()
    };
    check(&difference_bars(&falls));
}
