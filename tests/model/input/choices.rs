//! Choice of options by table, word and assignment.
use crate::loose::Loose;
use crate::reading::{document, only, with};
use cvtcycle_config::{Bound, Document, KeyInfo, Problems, Reader};

const CLAMPS: [&str; 2] = ["torque_following", "map"];

/// Chooses a clamp, reads the pressure of the map if chosen, and ends the session.
fn clamp(
    document: &Document,
    default: Option<&'static str>,
) -> (&'static str, Result<Vec<KeyInfo>, Problems>) {
    let reader = Reader::new(document);
    let (option, section) = reader.root().choose("clamp", &CLAMPS, default, "Clamping");
    assert_eq!(section.path(), format!("clamp.{option}"));
    if option == "map" {
        section.number("pressure_bar", Bound::positive(), "");
    } else {
        section.number_or("safety", Bound::positive(), 1.3, "");
    }
    drop(section);
    (option, reader.finish())
}

/// A text, assignments, the option that they choose and the status of the choice.
type Case<'a> = (&'a str, &'a [&'a str], &'a str, &'a str);

fn check(cases: &[Case<'_>]) {
    for (text, sets, option, status) in cases {
        let (found, keys) = clamp(&with(text, sets), Some("torque_following"));
        let keys = keys.unwrap_or_else(|problems| panic!("{text} {sets:?}: {problems:#?}"));
        let KeyInfo {
            key,
            value,
            status: said,
            ..
        } = &keys[0];
        assert_eq!(
            (found, value.as_str()),
            (*option, *option),
            "{text} {sets:?}"
        );
        assert_eq!(
            (key.as_str(), said.as_str()),
            ("clamp", *status),
            "{text} {sets:?}"
        );
    }
}

const ONE: &str = "[clamp.torque_following]\nsafety = 1.5\n";
const BOTH: &str = "[clamp.torque_following]\nsafety = 1.5\n[clamp.map]\npressure_bar = 20\n";
const WORD: &str = "clamp = \"torque_following\"";
const LONG: &str = "clamp = { value = \"torque_following\", status = \"assumed\" }";

#[test]
fn a_choice_in_the_file() {
    check(&[
        ("[clamp.map]\npressure_bar = 20\n", &[], "map", "choice"),
        (WORD, &[], "torque_following", "user"),
        (LONG, &[], "torque_following", "assumed"),
        ("", &[], "torque_following", "default"),
        ("[clamp]\n", &[], "torque_following", "default"),
    ]);
}

#[test]
fn a_choice_by_assignment() {
    let inner = "clamp.map.pressure_bar=10";
    check(&[
        (BOTH, &["clamp=torque_following"], "torque_following", "set"),
        (BOTH, &["clamp=torque_following", "clamp=map"], "map", "set"),
        (BOTH, &["clamp=map"], "map", "set"),
        (BOTH, &[inner], "map", "set"),
        (ONE, &[inner], "map", "set"),
        (ONE, &["clamp=map", inner], "map", "set"),
        (ONE, &[inner, "clamp=map"], "map", "set"),
        ("", &["clamp=map", inner], "map", "set"),
        (WORD, &[inner], "map", "set"),
        (LONG, &[inner], "map", "set"),
    ]);
}

#[test]
fn the_file_still_fills_the_option_named_by_an_assignment() {
    let document = with(ONE, &["clamp=torque_following"]);
    let (_, keys) = clamp(&document, None);
    assert_eq!(keys.unwrap()[1].value, "1.5");
}

#[test]
fn a_choice_that_is_none() {
    for (text, sets, message, line) in [
        ("", &[][..], "missing key `clamp`", 0),
        (
            BOTH,
            &[],
            "`torque_following` (line 1) and `map` (line 3)",
            3,
        ),
        ("clamp = \"mapp\"", &[], "`mapp` is not known", 1),
        (
            "clamp = 3",
            &[],
            "expected the name of an option or its table, found an integer",
            1,
        ),
        (
            "[clamp]\nmap = 3",
            &[],
            "expected a table, found an integer",
            2,
        ),
        ("", &["clamp=mapp"], "`mapp` is not known", 0),
        (
            BOTH,
            &["clamp=map", "clamp.torque_following.safety=2"],
            "two options",
            0,
        ),
        (
            "",
            &[
                "clamp.map.pressure_bar=1",
                "clamp.torque_following.safety=2",
            ],
            "two options",
            0,
        ),
        (
            "[clamp.mapp]\npressure_bar = 20\n",
            &[],
            "unknown table `clamp.mapp`",
            1,
        ),
    ] {
        let problem = only(clamp(&with(text, sets), None).1);
        assert!(
            problem.message.contains(message),
            "{text} {sets:?}: {problem:#?}"
        );
        assert_eq!(problem.place.line, line, "{text} {sets:?}");
    }
    let hint = only(clamp(&document("clamp = \"mapp\""), None).1).hint;
    assert_eq!(hint, "did you mean `map`?");
}

#[test]
fn after_a_failed_choice_nothing_is_missing() {
    let problem = only(clamp(&document("clamp = \"zebra\""), Some("map")).1);
    assert!(
        problem.message.contains("`zebra` is not known"),
        "{problem:?}"
    );
    assert_eq!(problem.hint, "write one of torque_following, map");
}
