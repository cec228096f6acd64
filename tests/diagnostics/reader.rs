//! `tests/diagnostics/reader.txt`: files with mistakes, each with the expected message above the bad line, and files of any content.
//!
//! `#~ part of a message` announces a problem of the next line that is not an announcement. `#~ hint: …`
//! and `#~ allowed: …` add parts of its hint and its allowed range.
use crate::announced::{differences, expectations};
use crate::loose::Loose;
use cvtcycle::config::{
    Bound, Document, KeyInfo, Override, Problem, Problems, Reader, decode, near, render,
};
use cvtcycle::model::keys::{Key, spec};
use proptest::prelude::*;

/// Reads a small vehicle with a value of every kind.
fn read(document: &Document) -> Result<Vec<KeyInfo>, Problems> {
    let reader = Reader::new(document);
    let root = reader.root();
    let belt = root.table("belt");
    if belt.exists() {
        belt.number(
            "band_offset_mm",
            Bound::closed(0.5, 10.0),
            "Distance of the bands",
        );
        belt.number_or("pitch_mm", Bound::positive(), 9.6, "Pitch");
        belt.optional_number("width_mm", Bound::positive(), "Width");
        belt.integer_or("bands", 1..=2, 2, "Number of bands");
    }
    let vehicle = root.table("vehicle");
    if vehicle.exists() {
        vehicle.number("mass_kg", Bound::positive(), "Mass");
        vehicle.number_or("drag", Bound::open_low(0.0, 2.0), 0.3, "Drag coefficient");
        vehicle.number_or("area_m2", Bound::positive(), 2.0, "Frontal area");
        vehicle.number_or("top_speed_kmh", Bound::any(), 180.0, "Top speed");
        vehicle.number_or("start_degc", Bound::any(), 20.0, "Start");
        vehicle.integer_or("gears", 1..=9, 5, "Gears");
        vehicle.text("name", "Name");
        vehicle.optional_text(&Key::new("maker", spec::text(), "Maker"));
        vehicle.text_or("class", "C", "Class");
        vehicle.word_or("fuel", &["petrol", "diesel"], "petrol", "Fuel");
        vehicle.boolean_or("abs", true, "Brakes");
    }
    let lists = root.table("lists");
    if lists.exists() {
        lists.numbers("ratios", Bound::positive(), 2..=4, "Ratios");
        lists.numbers("radii_mm", Bound::positive(), 0..=usize::MAX, "Radii");
        const COLUMNS: [(&str, Bound); 2] = [
            ("temperature_degc", Bound::any()),
            ("viscosity_mm2_s", Bound::positive()),
        ];
        lists.rows("points", &COLUMNS, "Viscosity");
    }
    let default = (!root.has("clamp")).then_some("torque_following");
    let (option, clamp) = root.choose("clamp", &["torque_following", "map"], default, "Clamping");
    if option == "map" {
        clamp.number("pressure_bar", Bound::positive(), "Pressure");
    } else {
        clamp.number_or("safety", Bound::closed(1.0, 3.0), 1.3, "Safety");
    }
    reader.finish()
}

fn problems(file: &str, text: &str) -> Problems {
    match Document::parse(file, text) {
        Ok(document) => read(&document).err().unwrap_or_default(),
        Err(problems) => problems,
    }
}

#[test]
fn every_mistake_is_found_at_its_line_and_nothing_else() {
    let cases = super::corpus::cases("reader");
    assert!(cases.len() >= 10, "only {} files", cases.len());
    for case in cases {
        let (name, text) = (case.name.as_str(), case.input);
        let expected = expectations(&text);
        assert!(!expected.is_empty(), "{name} announces nothing");
        for text in [text.clone(), text.replace('\n', "\r\n")] {
            let found = problems(name, &text);
            let differences = differences(&expected, &found);
            assert!(differences.is_empty(), "{name}:\n{differences}");
            check_places(&text, &found);
        }
    }
}

/// Checks that a place is within its line, and that the rendered text shows it.
fn check_places(text: &str, found: &[Problem]) {
    let shown = render(found, false);
    for problem in found {
        let place = &problem.place;
        let line = text.lines().nth(place.line - 1).unwrap_or("beyond the end");
        assert_eq!(&*place.line_text, line);
        assert!(
            place.column - 1 + place.width <= line.chars().count().max(place.column),
            "{problem:?}"
        );
        let header = format!("{}:{}:{}", place.input, place.line, place.column);
        assert!(shown.contains(&header), "{header} is not in\n{shown}");
        assert!(
            shown.contains(&problem.hint),
            "{} is not in\n{shown}",
            problem.hint
        );
    }
}

#[test]
fn a_vehicle_without_mistakes_is_read() {
    let text = "belt.band_offset_mm = 3\nvehicle = { mass_kg = 1200, name = \"x\" }\nclamp = \"map\"\n\
                [lists]\nratios = [1, 2]\n";
    let mut document = Document::parse("good.toml", text).unwrap();
    let by = Override::number("clamp.map.pressure_bar", 20.0);
    document.set(&by).unwrap();
    let keys = read(&document).unwrap();
    assert!(
        keys.iter()
            .all(|info| !info.unit.is_empty() && !info.allowed.is_empty() && !info.doc.is_empty())
    );
    assert!(
        keys.iter()
            .any(|info| info.key == "vehicle.mass_kg" && info.si == Some(1200.0))
    );
}

/// Pieces of the language and of the vehicle above, so that many texts pass the parser.
fn piece() -> impl Strategy<Value = String> {
    let known = [
        "[belt]\n",
        "[vehicle]\n",
        "[lists]\n",
        "[clamp]\n",
        "[clamp.map]\n",
        "[clamp.torque_following]\n",
        "band_offset_mm",
        "pitch_mm",
        "mass_kg",
        "name",
        "fuel",
        "points",
        "ratios",
        "clamp",
        "map",
        "value",
        " = ",
        "=",
        "{ value = ",
        ", status = \"source\" }",
        "[",
        "]",
        "{",
        "}",
        ",",
        ".",
        "\n",
        "\r\n",
        "#",
        "\"",
        "3",
        "-1.5",
        "2,40",
        "nan",
        "inf",
        "true",
        "\"text\"",
        "'é'",
        "3 mm",
        "0x1F",
        "1e999",
        "99999999999999999999",
        "2020-01-01",
        "[[1, 2], [3, 4]]",
        "\u{feff}",
        "\0",
        "\t",
    ];
    prop_oneof![6 => proptest::sample::select(known.to_vec()).prop_map(str::to_string), 1 => ".{0,4}"]
}

fn line() -> impl Strategy<Value = String> {
    let keys = [
        "belt",
        "belt.band_offset_mm",
        "vehicle.mass_kg",
        "vehicle.name",
        "clamp",
        "clamp.map",
        "lists.points",
        "x",
        "clamp.map.value",
    ];
    let values = [
        "3",
        "nan",
        "\"map\"",
        "\"é\"",
        "[]",
        "[[]]",
        "{}",
        "{ value = 3 }",
        "{ value = {} }",
        "{ map = {} }",
        "1979-05-27",
        "2,4",
    ];
    (
        proptest::sample::select(keys.to_vec()),
        proptest::sample::select(values.to_vec()),
    )
        .prop_map(|(key, value)| format!("{key} = {value}\n"))
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(512) })]

    #[test]
    fn no_text_makes_the_reader_panic(pieces in prop::collection::vec(piece(), 0..30)) {
        render(&problems("any.toml", &pieces.concat()), true);
    }

    #[test]
    fn no_lines_make_the_reader_panic(lines in prop::collection::vec(line(), 0..6), sets in prop::collection::vec(line(), 0..4)) {
        if let Ok(mut document) = Document::parse("any.toml", &lines.concat()) {
            for text in sets {
                let _ = text.trim().parse().and_then(|by: Override| document.set(&by));
            }
            render(&read(&document).err().unwrap_or_default(), false);
        }
    }

    #[test]
    fn no_text_at_all_makes_anything_panic(text in "\\PC{0,80}", bytes in prop::collection::vec(any::<u8>(), 0..80)) {
        render(&problems(&text, &text), false);
        if let Ok(text) = decode("any.toml", &bytes) {
            render(&problems("any.toml", &text), false);
        }
        let mut document = Document::parse("any.toml", "a = 1").unwrap();
        let _ = text.parse().and_then(|by: Override| document.set(&by));
        near(&text, [text.as_str(), "belt"].into_iter());
    }
}
