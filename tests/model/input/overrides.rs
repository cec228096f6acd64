//! Assignments from the command line.
use crate::reading::{HEAD, belt, document, only, with};
use cvtcycle_config::Override;

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
