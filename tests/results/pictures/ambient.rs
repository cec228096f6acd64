//! Pictures of a matrix of ambient temperatures: valid, with correct titles.

use super::svg_checks::check;
use crate::titles::{assert_number, title, written};
use cvtcycle::report::charts::ambient::{ambient_fuel, ambient_penalty, warm_up};
use cvtcycle::study::answer::ambient::{FuelPart, Matrix, WarmUp};

/// Artificial fuel of two cars from two starts at three unsorted temperatures.
fn matrix(excess: [f64; 3]) -> Matrix {
    Matrix {
        cars: vec!["car".to_owned(), "other".to_owned()],
        starts: vec!["soak".to_owned(), "warm".to_owned()],
        ambient_degc: vec![20.0, -10.0, 40.0],
        fuel: vec![FuelPart {
            name: "total".to_owned(),
            l_per_100km: vec![
                vec![vec![7.123, 8.456, 6.789], vec![6.5, 7.1, 6.4]],
                vec![vec![6.7, 7.9, 6.3], vec![6.2, 6.6, 6.1]],
            ],
            excess_percent: vec![vec![excess.to_vec(), vec![4.8, 7.5, 4.9]]],
        }],
        ends: Vec::new(),
    }
}

#[test]
fn fuel_at_the_ends_is_that_of_the_first_start() {
    let picture = ambient_fuel(&matrix([6.3, 7.0, 7.8]), "cars");
    check(&picture);
    let title = title(&picture.svg);
    let said = written(title.split(" L/100 km at ").next().unwrap());
    assert_number(&said[0], 8.456, &title);
    let said = written(title.split(" L/100 km at ").nth(1).unwrap());
    for (said, wanted) in said.iter().zip([-10.0, 6.789, 40.0]) {
        assert_number(said, wanted, &title);
    }
}

#[test]
fn the_excess_ranges_from_minimum_to_maximum_and_is_called_more_only_if_always_positive() {
    let none = |_: usize, _: f64, _: f64| None;
    let title_for = |excess| title(&ambient_penalty(&matrix(excess), "cars", &none).unwrap().svg);
    for (excess, wanted, more) in [
        ([6.31, 7.04, 7.82], [6.31, 7.82], true),
        ([1.2, -0.4, 3.1], [-0.4, 3.1], false),
        ([-1.2, -0.4, -3.1], [-3.1, -0.4], false),
    ] {
        let title = title_for(excess);
        for (said, wanted) in written(&title).iter().zip(wanted) {
            assert_number(said, wanted, &title);
        }
        assert_eq!(
            title.contains("more than other at every temperature"),
            more,
            "{title}"
        );
    }
}

/// The band is that of the first start, in the order of the temperatures, in picture and table; where it holds both signs the title says so.
#[test]
fn the_excess_has_its_range() {
    let range = |baseline: usize, degc: f64, percent: f64| {
        assert_eq!(baseline, 1);
        Some([percent - 9.0, percent + 0.1 * degc])
    };
    let picture = ambient_penalty(&matrix([6.3, 7.0, 7.8]), "cars", &range).unwrap();
    check(&picture);
    assert!(picture.svg.contains("class=\"band\""));
    let title = title(&picture.svg);
    assert!(
        title.contains("less than the error of the model"),
        "{title}"
    );
    let last = picture.table.columns.len();
    assert_eq!(picture.table.columns[last - 1].0, "over other, 90 % to");
    let ends: Vec<[&str; 3]> = picture
        .table
        .rows
        .iter()
        .map(|row| [&*row[0], &row[last - 2], &row[last - 1]])
        .collect();
    assert_eq!(
        ends,
        [
            ["\u{2212}10", "\u{2212}2.0", "6.0"],
            ["20", "\u{2212}2.7", "8.3"],
            ["40", "\u{2212}1.2", "11.8"]
        ]
    );
}

#[test]
fn the_sump_ends_where_the_first_car_ends() {
    let run = |car: usize, ambient: usize, end: f64| WarmUp {
        car,
        start: 0,
        ambient,
        time_s: vec![0.0, 600.0, 1200.0],
        sump_degc: vec![20.0, 0.5 * (20.0 + end), end],
        engine_oil_degc: vec![20.0, 60.0, 90.0],
    };
    let runs = [
        run(1, 1, 11.0),
        run(0, 0, 52.4),
        run(0, 1, 31.4),
        run(0, 2, 71.6),
        run(1, 2, 93.0),
    ];
    let picture = warm_up(&matrix([1.0; 3]), &runs, 0, "cars");
    check(&picture);
    let title = title(&picture.svg);
    for (said, wanted) in written(&title).iter().zip([31.4, -10.0, 71.6, 40.0]) {
        assert_number(said, wanted, &title);
    }
}
