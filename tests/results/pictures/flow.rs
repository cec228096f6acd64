//! Energy flows.

use super::svg_checks::{check, numbers};
use cvtcycle::output::Component;
use cvtcycle::report::charts::Picture;
use cvtcycle::report::charts::figures::{CarEnergy, energy_flow, transmission_flow};

fn car() -> CarEnergy {
    let losses = [
        (Component::LaunchClutch, 225.0),
        (Component::Pump, 556.0),
        (Component::BeltFilm, 0.02),
        (Component::FinalDrive, 507.0),
    ];
    let mut car = CarEnergy {
        subject: "A < B & \"C\"".to_owned(),
        exhaust_kj_km: 6030.0,
        engine_heat_kj_km: 15784.0,
        accessories_kj_km: 562.0,
        kinetic_kj_km: -0.8,
        losses_kj_km: losses.to_vec(),
        brake_kj_km: 203.0,
        wheels_kj_km: 2301.0,
        ..CarEnergy::default()
    };
    car.fuel_kj_km = 6030.0 + 15784.0 + 562.0 - 0.8 + car.flywheel_kj_km();
    car
}

/// Energy of the rows of one direction, kJ/km.
fn sum(picture: &Picture, way: &str) -> f64 {
    picture
        .table
        .rows
        .iter()
        .filter(|row| row[1] == way)
        .map(|row| numbers(&row[2]))
        .sum()
}

/// Widths of the ribbons at both ends, canvas units, by row of the table.
fn widths(svg: &str) -> Vec<(usize, f64, f64)> {
    let doc = roxmltree::Document::parse(svg).expect("well-formed");
    let ribbons = doc
        .descendants()
        .filter(|n| n.attribute("class") == Some("ribbon"));
    ribbons
        .map(|node| {
            let d: Vec<f64> = node
                .attribute("d")
                .unwrap_or("")
                .split(|c: char| !c.is_ascii_digit())
                .filter_map(|n| n.parse().ok())
                .collect();
            let row = node
                .attribute("data-row")
                .and_then(|row| row.parse().ok())
                .expect("a row");
            // M x0 a C m a m c x1 c V d C m d m b x0 b
            (row, d[14] - d[1], d[8] - d[7])
        })
        .collect()
}

#[test]
fn energy_is_balanced_and_widths_are_proportional() {
    for picture in [energy_flow(&car()), transmission_flow(&car())] {
        check(&picture);
        let (entered, left) = (sum(&picture, "enters"), sum(&picture, "leaves"));
        assert!((entered - left).abs() < 0.06, "{entered} {left}");
        let widths = widths(&picture.svg);
        assert_eq!(
            widths.len(),
            picture
                .table
                .rows
                .iter()
                .filter(|row| row[1] != "arrives")
                .count()
                - 1,
            "a ribbon for each but the source"
        );
        for (row, start, end) in widths {
            let wanted = 4.0 * 300.0 * numbers(&picture.table.rows[row][2]) / entered;
            assert!(
                (start - wanted).abs() <= 1.1 && (end - wanted).abs() <= 1.1,
                "{:?}: {start} {end} {wanted}",
                picture.table.rows[row]
            );
        }
    }
}

#[test]
fn every_flow_has_its_label_however_thin() {
    let picture = transmission_flow(&car());
    for word in [
        "Belt film",
        "0.02 kJ/km",
        "&lt; 0.1 %",
        "Rolling and air",
        "A &lt; B &amp; &quot;C&quot;",
    ] {
        assert!(picture.svg.replace('\u{a0}', " ").contains(word), "{word}");
    }
    let mut driven = car();
    (driven.kinetic_kj_km, driven.fuel_kj_km) = (-800.0, driven.fuel_kj_km - 799.2);
    assert!(
        energy_flow(&driven).svg.contains("800 kJ/km"),
        "what flows in is labelled too"
    );
    let little = energy_flow(&car()).svg;
    assert!(
        little.contains("Accessories etc.") && !little.contains("0.80 kJ/km"),
        "what cannot be seen has no label of its own"
    );
}

/// Truth: the sum by hand. Parts below half a per cent of the work at the flywheel are merged into one flow with their names.
#[test]
fn small_parts_are_one_flow() {
    let mut car = car();
    car.losses_kj_km.insert(3, (Component::BeltSlip, 5.5));
    car.fuel_kj_km += 5.5;
    let picture = transmission_flow(&car);
    check(&picture);
    let small = |row: &&Vec<String>| row[0] == "Belt film, belt slip";
    let row = picture.table.rows.iter().find(small).unwrap();
    assert!((numbers(&row[2]) - 5.52).abs() < 0.006, "{row:?}");
    assert!((sum(&picture, "enters") - sum(&picture, "leaves")).abs() < 0.06);
}

#[test]
fn unusual_energies_give_valid_pictures() {
    let nothing = CarEnergy::default();
    let driven = CarEnergy {
        wheels_kj_km: -900.0,
        losses_kj_km: vec![(Component::Churning, 100.0)],
        brake_kj_km: 500.0,
        ..CarEnergy::default()
    };
    let broken = CarEnergy {
        fuel_kj_km: f64::NAN,
        exhaust_kj_km: f64::INFINITY,
        ..car()
    };
    let huge = CarEnergy {
        fuel_kj_km: 1e12,
        exhaust_kj_km: 1e12,
        subject: "n".repeat(400),
        ..CarEnergy::default()
    };
    for car in [nothing, driven, broken, huge] {
        for picture in [energy_flow(&car), transmission_flow(&car)] {
            check(&picture);
        }
    }
}

#[test]
fn energy_that_is_missing_is_shown() {
    let mut car = car();
    car.fuel_kj_km += 100.0;
    let picture = energy_flow(&car);
    assert!(
        picture.svg.contains("Not accounted for")
            && (sum(&picture, "enters") - sum(&picture, "leaves")).abs() < 0.06
    );
}
