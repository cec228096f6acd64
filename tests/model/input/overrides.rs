//! Assignments from the command line, and the documents that they are laid over: silent readings find the same values and as many problems as
//! ordinary ones.

use crate::reading::{HEAD, belt, document, only, with};
use cvtcycle_config::{Override, ProblemKind, Reader};
use cvtcycle_model::keys::{Key, spec};

#[test]
fn an_assignment_goes_before_the_file() {
    let text = format!("{HEAD}band_offset_mm = {{ value = 3.0, status = \"source\" }}");
    let key = "transmission.cvt.belt.band_offset_mm";
    let (si, keys) = belt(&with(&text, &[&format!("{key} = 2")]));
    assert!((si - 0.002).abs() < 1e-15);
    assert_eq!(keys.unwrap()[0].status, "set");
    let (_, keys) = belt(&with(
        "",
        &[&format!("{key}={{ value = 2, status = \"source\" }}")],
    ));
    assert_eq!(keys.unwrap()[0].status, "set");
    let problem = only(belt(&with(&text, &[&format!("{key}=2,5")])).1);
    assert_eq!(problem.place.assignment(), Some(&*format!("{key}=2,5")));
    assert_eq!((problem.place.line, problem.value.as_str()), (0, "2,5"));
    assert!(problem.hint.contains("2.5"), "{problem:?}");
}

#[test]
fn the_last_assignment_of_a_key_counts() {
    let key = "transmission.cvt.belt.band_offset_mm";
    let (si, _) = belt(&with("", &[&format!("{key}=2"), &format!("{key}=4")]));
    assert!((si - 0.004).abs() < 1e-15);
}

/// Truth: the value of the file times the factor, or and the difference, one after the other; that of the key's default where the file has none.
#[test]
fn a_relative_assignment_changes_the_value_in_force() {
    let key = "transmission.cvt.belt.band_offset_mm";
    let text = format!("{HEAD}band_offset_mm = {{ value = 3.0, status = \"source\" }}");
    let of = |sets: &[&str]| {
        let sets: Vec<String> = sets.iter().map(|set| format!("{key}{set}")).collect();
        let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
        belt(&with(&text, &sets)).0
    };
    assert!((of(&["*=0.5"]) - 1.5e-3).abs() < 1e-15);
    assert!((of(&[" += -1"]) - 2e-3).abs() < 1e-15);
    assert!((of(&["*=2", "+=1"]) - 7e-3).abs() < 1e-15);
    assert!((of(&["=2", "*=2"]) - 4e-3).abs() < 1e-15);
    let problem = only(belt(&with(&text, &[&format!("{key}*=10")])).1);
    assert_eq!(
        (problem.kind, problem.value.as_str()),
        (ProblemKind::OutOfRange, "30")
    );
    assert_eq!(problem.place.assignment(), Some(&*format!("{key}*=10")));
    let unknown = only(belt(&with(&text, &["transmission.cvt.belt.band_ofset_mm*=2"])).1);
    assert_eq!(unknown.kind, ProblemKind::UnknownKey);
}

#[test]
fn a_relative_assignment_needs_a_number_to_change() {
    let mut document =
        document("title = \"a\"\nlist = [1, 2.5]\nroad_load.mass_kg = { value = 1000 }");
    let put = |document: &mut cvtcycle_config::Document, text: &str| {
        document.set(&text.parse::<Override>().unwrap())
    };
    put(&mut document, "list*=2").unwrap();
    put(&mut document, "road_load.mass_kg+=-100").unwrap();
    let reader = Reader::new(&document);
    let row = Key::new("list", spec::list(0.0, 10.0, 1, 5), "numbers");
    assert_eq!(
        cvtcycle_model::keys::Values::numbers(&reader.root(), &row),
        [2.0, 5.0]
    );
    let text = put(&mut document, "title*=2").unwrap_err();
    assert_eq!(
        (text.kind, text.key.as_str()),
        (ProblemKind::WrongType, "title")
    );
    let none = put(&mut document, "engine.displacement_cc*=2").unwrap_err();
    assert_eq!(none.kind, ProblemKind::Missing);
    assert!(none.hint.contains("engine.displacement_cc=VALUE"));
    for bad in ["a*=b", "a+=true", "a*=inf"] {
        assert_eq!(
            bad.parse::<Override>().unwrap_err().kind,
            ProblemKind::Syntax,
            "{bad}"
        );
    }
}

#[test]
fn an_assignment_to_an_unknown_key_names_the_whole_path() {
    let text = format!("{HEAD}band_offset_mm = 3");
    for (assignment, message) in [
        ("belt.band_ofset_mm=2", "unknown key `belt.band_ofset_mm`"),
        (
            "transmission.cvt.belt.band_ofset_mm=2",
            "unknown key `transmission.cvt.belt.band_ofset_mm`",
        ),
        ("belt.band_offset_mm=2", "unknown key"),
        ("band_offset_m=0.002", "wrong unit"),
    ] {
        let problem = only(belt(&with(&text, &[assignment])).1);
        assert!(problem.message.contains(message), "{problem:?}");
        assert!(
            problem
                .hint
                .contains("`transmission.cvt.belt.band_offset_mm`"),
            "{problem:?}"
        );
        assert_eq!(problem.place.assignment(), Some(assignment));
    }
}

#[test]
fn what_is_no_assignment_is_refused() {
    let mut document = document("a = 1\nb = { value = 2 }");
    for (assignment, part) in [
        ("a", "no `=`"),
        ("=1", "is no key"),
        ("a..b=1", "is no key"),
        ("a=", "no value"),
        ("a.b=1", "`a` is a value"),
        ("b.value=1", "`b` is a value"),
    ] {
        let set = |by: Override| document.set(&by);
        let problem = assignment.parse().and_then(set).unwrap_err();
        assert!(problem.message.contains(part), "{problem:?}");
        assert_eq!(problem.place.assignment(), Some(assignment));
        assert!(!problem.hint.is_empty());
    }
    let deep = format!("{}z=1", "z.".repeat(100_000));
    assert!(deep.parse::<Override>().is_err());
}

#[test]
fn a_word_for_a_table_that_is_no_choice() {
    let problem = only(
        belt(&with(
            &format!("{HEAD}band_offset_mm = 3"),
            &["transmission.cvt=belt"],
        ))
        .1,
    );
    assert!(
        problem
            .message
            .contains("`transmission.cvt` is a table, not a value"),
        "{problem:?}"
    );
    assert_eq!(problem.place.assignment(), Some("transmission.cvt=belt"));
}
