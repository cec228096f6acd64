//! Problems as text for people.

use cvtcycle_config::{Input, Place, Problem, render};

fn problem() -> Problem {
    Problem::out_of_range("`belt.band_offset_mm` is out of range")
        .at(Place {
            line: 7,
            column: 18,
            line_text: "band_offset_mm = 99.0 # é".into(),
            width: 4,
            ..Place::file("car.toml")
        })
        .key("belt.band_offset_mm")
        .value("99.0")
        .allowed("0.5 to 10 mm")
        .hint("try less")
}

#[test]
fn a_problem_with_its_line() {
    let text = render(&[problem()], false);
    for part in [
        "car.toml:7:18",
        "band_offset_mm = 99.0",
        "^^^^ allowed: 0.5 to 10 mm",
        "try less",
        "out of range",
    ] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
    assert!(text.ends_with("\n1 problem in car.toml\n"), "{text}");
    assert!(!text.contains('\u{1b}'));
    assert!(render(&[problem()], true).contains('\u{1b}'));
    assert_eq!(render(&[], true), "");
}

#[test]
fn a_problem_without_a_line_is_plain_text() {
    let place = Input::Override("a=2".into());
    let text = render(&[problem().at(place), problem()], false);
    assert!(
        text.contains("override a=2: `belt.band_offset_mm` is out of range"),
        "{text}"
    );
    assert!(text.contains("99.0; allowed: 0.5 to 10 mm"), "{text}");
    assert!(
        text.ends_with("2 problems in car.toml, override a=2\n"),
        "{text}"
    );
}

#[test]
fn a_cell_is_named_by_its_column() {
    let cell = problem().key("speed_kmh").message("this is not a number");
    assert!(
        render(std::slice::from_ref(&cell), false)
            .starts_with("error: speed_kmh: this is not a number\n")
    );
    let far = cell.clone().at(Place {
        line_text: String::new(),
        ..cell.place.clone()
    });
    assert!(
        render(&[far], false).starts_with("error: car.toml:7: speed_kmh: this is not a number\n")
    );
    let long = cell.key("k".repeat(1000));
    assert!(render(&[long], false).starts_with("error: this is not a number\n"));
    assert_eq!(
        render(&[problem()], false)
            .matches("belt.band_offset_mm")
            .count(),
        1
    );
}

#[test]
fn long_texts_are_cut_and_all_problems_are_counted() {
    let long = problem().message("ä".repeat(1 << 20));
    let text = render(
        &[long, Problem::more(Input::File("car.toml".into()), 41)],
        false,
    );
    assert!(text.contains(&format!("{}...\n", "ä".repeat(2000))) && text.len() < 2 * 2000 + 1000);
    assert!(
        text.ends_with("\n42 problems in car.toml\n"),
        "{}",
        &text[text.len() - 100..]
    );
}

#[test]
fn places_beyond_the_line_do_not_panic() {
    let place = Place {
        column: 900,
        width: usize::MAX,
        ..problem().place
    };
    assert!(render(&[problem().at(place)], false).contains("car.toml"));
    let place = Place {
        input: Input::File("a\u{1b}[31m.toml".into()),
        ..problem().place
    };
    let wild = problem().at(place).message("a\u{1b}[31mb\nc");
    assert!(!render(&[wild], false).contains('\u{1b}'));
}
