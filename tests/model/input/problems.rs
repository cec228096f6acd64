//! Lists of problems, their text for people, and names that a mistyped one may have meant.

use cvtcycle_config::{
    Input, Place, Problem, Problems, is_hidden, near, one_line, render, visible,
};

const MAX_DESCRIBED: usize = 1000;

fn file(name: &str) -> Input {
    Input::File(name.into())
}

fn some(count: usize) -> Problems {
    (0..count)
        .map(|_| Problem::invalid("no").in_file("f"))
        .collect()
}

#[test]
fn problems_beyond_some_number_are_counted_together() {
    let mut all = Problems::new();
    all.append(some(MAX_DESCRIBED - 1));
    assert_eq!(all.len(), MAX_DESCRIBED - 1);
    all.append(some(2));
    assert_eq!(all[MAX_DESCRIBED].message, "1 more problem is not shown");
    let mut found = some(3);
    found.push(Problem::more(file("f"), 70));
    all.append(found);
    all.append(Problems::new());
    assert_eq!(
        (all.len(), &all[MAX_DESCRIBED]),
        (MAX_DESCRIBED + 1, &Problem::more(file("f"), 74))
    );
    let shown = |problem: &Problem| problem.not_shown().is_none();
    assert!(all[..MAX_DESCRIBED].iter().all(shown));
    let mut short = some(1);
    short.append(Problem::more(file("g"), 5).into());
    short.append(some(1));
    assert_eq!((short.len(), short[2].not_shown()), (3, Some(5)));
    assert_eq!(short.iter().filter_map(Problem::not_shown).count(), 1);
}

#[test]
fn problems_are_an_error_with_text() {
    let mut problems = some(1);
    problems.push(Problem::missing("no mass").hint("add it"));
    let error: Box<dyn std::error::Error> = Box::new(problems);
    assert_eq!(error.to_string(), "f: no\nno mass (add it)");
}

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
        .names_key()
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
        line_text: "".into(),
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

/// Every character that a stranger's text must not bring to a screen.
fn hidden() -> impl Iterator<Item = char> {
    let ranges = [
        '\0'..='\u{8}',
        '\u{B}'..='\u{1F}',
        '\u{7F}'..='\u{9F}',
        '\u{61C}'..='\u{61C}',
        '\u{200E}'..='\u{200F}',
        '\u{2028}'..='\u{202E}',
        '\u{2066}'..='\u{2069}',
        '\u{FDD0}'..='\u{FDEF}',
        '\u{FEFF}'..='\u{FEFF}',
    ];
    ranges.into_iter().flatten()
}

#[test]
fn hidden_characters_are_known_and_replaced() {
    let found: Vec<char> = ('\0'..=char::MAX).filter(|c| is_hidden(*c)).collect();
    assert_eq!(found, hidden().collect::<Vec<char>>());
    let text = "a\tä\n\u{20AC}\u{1F697}";
    assert_eq!(visible(text), text);
    assert_eq!(one_line(text), "a\u{FFFD}ä\u{FFFD}\u{20AC}\u{1F697}");
    assert_eq!(visible("\u{1b}[2J\u{202e}\n"), "\u{FFFD}[2J\u{FFFD}\n");
}

#[test]
fn no_part_of_a_problem_brings_a_hidden_character() {
    for c in hidden() {
        let wild = format!("a{c}b");
        let with_line = problem()
            .at(Place {
                input: file(&wild),
                line_text: format!("x{c}y = 1").into(),
                column: 3,
                width: 1,
                ..problem().place
            })
            .message(&wild)
            .allowed(&wild)
            .hint(&wild);
        let without_line = with_line.clone().in_file(&wild).value(&wild);
        let of_cell = Problem::invalid("no")
            .key(&wild)
            .at(with_line.place.clone());
        for (problem, times) in [(with_line, 6), (without_line, 6), (of_cell, 4)] {
            let text = render(&[problem], false);
            assert!(!text.contains(is_hidden), "{text:?}");
            assert_eq!(text.matches('\u{FFFD}').count(), times, "{text}");
        }
    }
    // The caret is below the character after the replaced one.
    let place = Place {
        line_text: "x\u{9b}y = 1".into(),
        column: 3,
        width: 1,
        ..problem().place
    };
    let text = render(&[problem().at(place)], false);
    assert!(
        text.contains("7 | x\u{FFFD}y = 1\n  |   ^ allowed"),
        "{text}"
    );
}

#[test]
fn a_slip_of_the_finger_is_found() {
    let known = ["band_offset_mm", "band_width_mm", "pitch_mm", "mass_kg"];
    assert_eq!(
        near("band_ofset_mm", known.into_iter())[0],
        "band_offset_mm"
    );
    assert_eq!(near("mass", known.into_iter()), ["mass_kg"]);
    assert_eq!(near("Mass_Kg", known.into_iter()), ["mass_kg"]);
}

#[test]
fn nothing_is_suggested_for_something_else() {
    assert!(near("zebra", ["band_offset_mm", "mass_kg"].into_iter()).is_empty());
    assert!(near("", ["a"].into_iter()).is_empty());
}

#[test]
fn at_most_three_and_the_best_first() {
    let known = ["abcd1", "abcd2", "abcd3", "abcde", "abcd5"];
    let found = near("abcde", known.into_iter());
    assert_eq!(found.len(), 3);
    assert_eq!(found[0], "abcde");
}
