//! Figures for decisions: correct titles, complete sums, empty pictures.

use super::svg_checks::{check, numbers};
use cvtcycle::model::transmission::component::LossGroup;
use cvtcycle::report::charts::decision::{
    Against, CheckedNumber, PerKm, Repeat, agreement, answer_strip, repeats, waterfall,
};
use cvtcycle::report::charts::figures::Term;

/// Title with plain spaces.
fn title(svg: &str) -> String {
    let title = svg.split("<title>").nth(1).unwrap();
    title
        .split("</title>")
        .next()
        .unwrap()
        .replace('\u{a0}', " ")
}

#[test]
fn the_strip_states_if_the_sign_is_certain() {
    let row = |drawn: Option<[f64; 3]>| Against {
        is_by_cars: false,
        baseline: "five <gears>".to_owned(),
        title: "a car with <gears> (not like for like)".to_owned(),
        files: Some(6.3),
        drawn,
        published: Some([5.0, 5.0]),
    };
    for (drawn, said) in [
        (
            Some([1.2, 5.0, 9.6]),
            "6 % more than five &lt;gears&gt;; with uncertain inputs varied +1 to +10 %",
        ),
        (
            Some([-1.2, 4.0, 9.1]),
            "own uses between 1 % less and 9 % more than five &lt;gears&gt;; 6 % more with nominal values",
        ),
        (
            None,
            "6.3 % more than five &lt;gears&gt;; no range is claimed",
        ),
    ] {
        let picture = answer_strip("own", "somewhere", &[row(drawn)]);
        check(&picture);
        assert!(
            title(&picture.svg).contains(said),
            "{}",
            title(&picture.svg)
        );
    }
    check(&answer_strip("own", "", &[]));
    check(&answer_strip("own", "", &[Against::default()]));
}

/// Conservation: the steps lead from one fuel to the other.
#[test]
fn the_waterfall_ends_at_the_fuel_of_the_subject() {
    let terms = [
        ("transmission", 139.0),
        ("exhaust", 54.0),
        ("engine heat", -36.0),
        ("brakes", -10.0),
        ("rest", 0.2),
        ("more", 0.1),
    ];
    let terms = terms
        .map(|(name, kj)| (name.to_owned(), Term::Other, kj))
        .to_vec();
    let per_km = PerKm {
        names: ["own".to_owned(), "other".to_owned()],
        fuel: [2489.3, 2342.0],
        terms,
    };
    let picture = waterfall(&per_km, "somewhere");
    check(&picture);
    let after: Vec<f64> = picture
        .table
        .rows
        .iter()
        .map(|row| numbers(&row[2]))
        .collect();
    assert_eq!(after.first(), Some(&2342.0));
    let [.., before, last] = after[..] else {
        panic!("{after:?}")
    };
    assert!(
        (before - last).abs() < 0.11 && (last - 2489.3).abs() < 0.06,
        "{after:?}"
    );
    let said = "Fuel of own against other: more for transmission and more for exhaust";
    let title = title(&picture.svg);
    assert!(title.starts_with(said), "{title}");
    assert!(
        !title.contains(|c: char| c.is_ascii_digit()),
        "a difference has a range, which the title has no room for: {title}"
    );
    assert!(
        picture.table.rows.iter().any(|row| row[0] == "2 others"),
        "small ones together"
    );
    check(&waterfall(&PerKm::default(), ""));
}

#[test]
fn repeated_drives_are_summed_and_named() {
    let drive = |oil_degc, pump, belt| Repeat {
        oil_degc,
        losses_kj: vec![(LossGroup::Pump, pump), (LossGroup::Belt, belt)],
    };
    let drives = [
        drive([-10.0, 2.0], 104.0, 53.0),
        drive([2.0, 9.0], 90.0, 53.5),
        drive([9.0, 16.0], 86.0, 54.0),
    ];
    let picture = repeats("own", &drives);
    check(&picture);
    let said =
        "Warmer oil cuts the loss of the same drive from 157 to 140 kJ, pump most (104 to 86)";
    assert!(
        title(&picture.svg).starts_with(said),
        "{}",
        title(&picture.svg)
    );
    let all = picture.table.rows.last().unwrap();
    assert_eq!((numbers(&all[1]), numbers(&all[3])), (157.0, 140.0));
    check(&repeats("own", &drives[..1]));
    check(&repeats("own", &[]));
}

#[test]
fn numbers_far_off_stay_in_the_picture() {
    let number = |part: &str, off: f64| CheckedNumber {
        part: part.to_owned(),
        off,
        agrees: off.abs() <= 1.0,
    };
    let all = [
        number("a", 0.0),
        number("a", 0.9),
        number("b", -70.0),
        number("b", 1e9),
    ];
    let picture = agreement("own", &all);
    check(&picture);
    assert!(title(&picture.svg).starts_with("2 of 4 published numbers"));
    assert_eq!(
        picture.table.rows.last().unwrap()[1..],
        ["2".to_owned(), "4".to_owned()]
    );
    check(&agreement("own", &[]));
}
