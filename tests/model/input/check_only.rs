//! Silent readings find the same values and as many problems as ordinary ones; drafts are what assignments make of a document.
use crate::loose::Loose;
use crate::reading::document;
use cvtcycle_config::{Bound, KeyPath, Override, PatchedDocument, Reader};
use cvtcycle_model::keys::{Key, Kind, Presence, spec};

/// A little of everything that a reader reads, as text.
fn read(reader: &Reader) -> String {
    let root = reader.root();
    let belt = root.table("belt");
    let (option, clamp) = root.choose(
        "clamp",
        &["map", "slip", "torque"],
        Some("map"),
        "clamp law",
    );
    let numbers = (
        belt.number("offset_mm", Bound::closed(0.0, 20.0), "offset"),
        belt.number_or("width_mm", Bound::positive(), 25.0, "width"),
        belt.integer_or("bands", 1..=40, 12, "bands"),
        belt.optional_number("gap_mm", Bound::positive(), "gap"),
        clamp.number_or("safety", Bound::closed(1.0, 3.0), 1.5, "safety"),
    );
    let others = (
        root.numbers("radii_mm", Bound::positive(), 1..=3, "radii"),
        root.rows(
            "points",
            &[
                ("temp_degc", Bound::any()),
                ("share", Bound::closed(0.0, 1.0)),
            ],
            "points",
        ),
        root.word_or("fluid", &["old", "new"], "new", "fluid"),
        root.boolean_or("warm", true, "warm"),
        root.text("title", "title"),
        root.grid(&Key::new(
            "speed_rpm",
            (Kind::Grid(Bound::positive()), Presence::Optional),
            "speed",
        )),
        root.texts(&Key::new("names", spec::texts(), "names")),
    );
    format!("{option} {numbers:?} {others:?}")
}

const GOOD: &str = "title = 'x'\nradii_mm = [1, 2]\npoints = [[1, 0.5], [2, 0.6]]\nspeed_rpm = '1..3:1'\nnames = ['a']\nclamp = 'slip'\n\
    [belt]\noffset_mm = { value = 3, status = 'assumed', source = 'here' }\n";

#[test]
fn silent_readings_find_the_same() {
    let bad = "title = 1\nradii_mm = []\npoints = [[1, 2], [1]]\nfluid = 'odl'\nwarm = 0\nspeed_rpm = '3'\nnames = [1]\nclamp = 'amp'\n\
        belt = { offset_mm = { status = 'assumed' }, width_mm = -1, bands = 1.5, gap_mm = 'x' }\n";
    for (text, problem_count) in [
        (GOOD, 0),
        (bad, 13),
        ("", 3),
        ("belt = 1\n[clamp.map]\n[clamp.slip]\n", 4),
    ] {
        let document = document(text);
        let (ordinary, silent) = (Reader::new(&document), Reader::check_only(&document));
        let same = read(&ordinary) == read(&silent);
        assert!(same, "{text}");
        assert_eq!(
            ordinary.finish().err().map_or(0, |problems| problems.len()),
            problem_count,
            "{text}"
        );
        assert!(silent.known().is_empty());
        assert_eq!(
            silent.finish().err().map_or(0, |problems| problems.len()),
            problem_count,
            "{text}"
        );
    }
}

fn path(key: &str) -> KeyPath {
    key.split('.').map(Into::into).collect()
}

/// Numbers in place of a value, a default, a word or nothing; put in twice; taken back.
#[test]
fn drafts_are_what_assignments_make() {
    let base = document(GOOD);
    let mut draft = PatchedDocument::new(&base);
    let unchanged = read(&Reader::check_only(&base));
    let numbers = [
        ("belt.offset_mm", 4.5),
        ("belt.bands", 7.0),
        ("belt.gap_mm", 0.1),
        ("clamp.torque.safety", 2.0),
        ("warm", -1.0),
    ];
    for count in 0..=numbers.len() {
        for round in [1.0, 1.25] {
            let mut assigned = base.clone();
            for (key, number) in &numbers[..count] {
                assert!(draft.set(&path(key), number * round));
                assigned
                    .set(&Override::number(key, number * round))
                    .unwrap();
            }
            let same = read(&Reader::check_only(draft.document())) == read(&Reader::new(&assigned));
            assert!(same, "{count} numbers, {round}");
            assert!(count == 0 || read(&Reader::check_only(draft.document())) != unchanged);
        }
        draft.reset();
        assert_eq!(read(&Reader::check_only(draft.document())), unchanged);
    }
    assert!(
        !draft.set(&path("belt.offset_mm.x"), 1.0),
        "a value is in the way"
    );
    assert_eq!(read(&Reader::check_only(draft.document())), unchanged);
}
