//! Readings of small documents, through the interface that the vehicle files are read with, and texts that are no TOML.

use crate::loose::Loose;
use cvtcycle_config::{Bound, Document, KeyInfo, Problem, Problems, Reader, decode};
use cvtcycle_model::keys::{Key, spec};

pub fn document(text: &str) -> Document {
    Document::parse("car.toml", text).unwrap()
}

pub fn with(text: &str, assignments: &[&str]) -> Document {
    let mut document = document(text);
    for text in assignments {
        document.set(&text.parse().unwrap()).unwrap();
    }
    document
}

const OFFSET: Bound = Bound::closed(0.5, 10.0);

/// Reads the band offset of a belt and ends the session.
pub fn belt(document: &Document) -> (f64, Result<Vec<KeyInfo>, Problems>) {
    let reader = Reader::new(document);
    let belt = reader
        .root()
        .table("transmission")
        .table("cvt")
        .table("belt");
    let offset = belt.number("band_offset_mm", OFFSET, "Distance of the bands");
    drop(belt);
    (offset, reader.finish())
}

pub const HEAD: &str = "[transmission.cvt.belt]\n";

pub fn only(result: Result<Vec<KeyInfo>, Problems>) -> Problem {
    let mut problems = result.unwrap_err();
    assert_eq!(problems.len(), 1, "{problems:#?}");
    problems.remove(0)
}

#[test]
fn both_forms_carry_their_status() {
    let (si, keys) = belt(&document(&format!("{HEAD}band_offset_mm = 3")));
    assert!((si - 0.003).abs() < 1e-15);
    assert_eq!(keys.unwrap()[0].status, "user");
    let long = "band_offset_mm = { value = 3.5, status = \"fitted\", source = \"run 4\", note = \"cold\" }";
    let (_, keys) = belt(&document(&format!("{HEAD}{long}")));
    let expected = KeyInfo {
        key: "transmission.cvt.belt.band_offset_mm".into(),
        unit: "mm".into(),
        value: "3.5".into(),
        si: Some(3.5 * 1e-3),
        status: "fitted".into(),
        source: "run 4".into(),
        note: "cold".into(),
        range: None,
        from: "line 2".into(),
        allowed: "0.5 to 10 mm".into(),
        is_number: true,
        doc: "Distance of the bands".into(),
        labels: &[],
    };
    assert_eq!(keys.unwrap(), [expected]);
}

#[test]
fn a_problem_has_its_place_value_range() {
    let problem = only(
        belt(&document(&format!(
            "\n{HEAD}  band_offset_mm = {{ value = 99.0 }} # é"
        )))
        .1,
    );
    assert_eq!(
        (
            problem.place.line,
            problem.place.column,
            problem.place.width
        ),
        (3, 30, 4)
    );
    assert_eq!(
        &*problem.place.line_text,
        "  band_offset_mm = { value = 99.0 } # é"
    );
    assert_eq!(
        (problem.value.as_str(), problem.allowed.as_str()),
        ("99.0", "0.5 to 10 mm")
    );
    assert_eq!(problem.key, "transmission.cvt.belt.band_offset_mm");
}

#[test]
fn columns_count_characters() {
    let problem = only(
        belt(&document(
            "transmission.cvt.belt.\"é\" = 1\ntransmission.cvt.belt.band_offset_mm = 1\n",
        ))
        .1,
    );
    assert_eq!(
        (
            problem.place.line,
            problem.place.column,
            problem.place.width
        ),
        (1, 23, 3)
    );
}

#[test]
fn a_missing_key_is_reported_at_the_header() {
    let (si, result) = belt(&document(HEAD));
    assert!(si.is_nan());
    let problem = only(result);
    assert!(
        problem
            .message
            .contains("missing key `transmission.cvt.belt.band_offset_mm`")
    );
    assert_eq!((problem.place.line, problem.place.column), (1, 1));
    let problem = only(belt(&document("")).1);
    assert_eq!(
        (problem.place.line, problem.place.file_name().unwrap()),
        (0, "car.toml")
    );
}

#[test]
fn kinds_of_values() {
    let text = "n = 3\nyes = true\nname = { value = \"x\", status = \"assumed\" }\nword = \"cold\"\n\
                list_mm = [1, 2.5]\npoints = [[-40, 9000.0], [0, 250]]\n";
    let document = document(text);
    let reader = Reader::new(&document);
    let root = reader.root();
    assert_eq!(root.integer_or("n", 1..=5, 2, ""), 3);
    assert_eq!(root.integer_or("n2", 1..=5, 2, ""), 2);
    assert!(root.boolean_or("yes", false, ""));
    assert_eq!(root.text("name", ""), "x");
    assert_eq!(root.text_or("name2", "y", ""), "y");
    assert_eq!(
        root.optional_text(&Key::new("name3", spec::text(), "")),
        None
    );
    assert_eq!(root.word_or("word", &["warm", "cold"], "warm", ""), "cold");
    assert_eq!(
        root.numbers("list_mm", Bound::positive(), 1..=2, ""),
        [1e-3, 2.5 * 1e-3]
    );
    const COLUMNS: [(&str, Bound); 2] = [
        ("temperature_degc", Bound::any()),
        ("viscosity_mm2_s", Bound::positive()),
    ];
    let rows = root.rows("points", &COLUMNS, "");
    assert_eq!(
        rows,
        [[-40.0 + 273.15, 9000.0 * 1e-6], [273.15, 250.0 * 1e-6]]
    );
    assert!(root.rows("points2", &COLUMNS, "").is_empty());
    assert_eq!(root.optional_number("x_mm", OFFSET, ""), None);
    assert!((root.number_or("x_m", OFFSET, 1.0, "") - 1.0).abs() < 1e-15);
    assert!(root.has("n") && !root.has("x_mm") && root.exists() && !root.table("t").exists());
    drop(root);
    let keys = reader.finish().unwrap();
    let find = |key: &str| keys.iter().find(|info| info.key == key).unwrap();
    assert_eq!(find("name").status, "assumed");
    assert_eq!(
        (find("n2").status.as_str(), find("n2").value.as_str()),
        ("default", "2")
    );
    assert_eq!(find("points").unit, "°C, mm²/s");
    assert_eq!(find("list_mm").value, "[1.0, 2.5]");
    assert_eq!(
        (find("x_mm").value.as_str(), find("x_mm").status.as_str()),
        ("", "")
    );
}

#[test]
fn lists_keep_their_length_after_a_problem() {
    let document = document("a = [1, \"x\"]\nb = [1, 2, 3, 4]\nc = 7\n");
    let reader = Reader::new(&document);
    let root = reader.root();
    let read = |key| root.numbers(key, Bound::any(), 3..=3, "").len();
    assert_eq!(["a", "b", "c", "d"].map(read), [3; 4]);
    drop(root);
    // `a` is wrong twice: a text and its length.
    assert_eq!(reader.finish().unwrap_err().len(), 5);
}

#[test]
fn a_value_where_a_table_belongs_is_one_problem() {
    let problem = only(belt(&document("transmission = 3\n")).1);
    assert!(
        problem
            .message
            .contains("`transmission`: expected a table, found an integer"),
        "{problem:?}"
    );
}

#[test]
fn complaints_stand_at_the_value() {
    let document = document("[a]\nx = { value = 3, status = \"source\" }\n");
    let reader = Reader::new(&document);
    let section = reader.root().table("a");
    section.number("x", Bound::any(), "");
    section.conflict("x", "below y", "`x` is above `y`", "swap them");
    section.missing("y", "", "no `y`", "");
    reader.problem(Problem::invalid("from outside"));
    drop(section);
    let problems = reader.finish().unwrap_err();
    let at = |message: &str| {
        problems
            .iter()
            .find(|problem| problem.message.contains(message))
            .unwrap()
    };
    assert_eq!(
        (
            at("above").place.line,
            at("above").place.column,
            at("above").value.as_str()
        ),
        (2, 15, "3")
    );
    assert_eq!(
        (at("no `y`").place.line, at("no `y`").key.as_str()),
        (1, "a.y")
    );
    assert_eq!(at("from outside").key, "");
}

#[test]
fn a_quoted_name_with_a_dot_is_not_a_path() {
    let document = document("\"a.x\" = 3\na.x = 1\n");
    let reader = Reader::new(&document);
    reader.root().table("a").number("x", Bound::any(), "");
    let problem = only(reader.finish());
    assert_eq!(problem.place.line, 1);
}

#[test]
fn problems_stand_in_the_order_of_the_file() {
    let document = document("b = 9\na = 9\n");
    let reader = Reader::new(&document);
    for key in ["a", "b"] {
        reader.root().number(key, Bound::closed(0.0, 1.0), "");
        reader.root().number(key, Bound::closed(0.0, 1.0), "");
    }
    let lines: Vec<usize> = reader
        .finish()
        .unwrap_err()
        .iter()
        .map(|problem| problem.place.line)
        .collect();
    assert_eq!(lines, [1, 2]);
}

#[test]
fn very_deep_texts_are_refused_in_good_time() {
    for depth in [100, 100_000] {
        for text in [
            format!("{}a = 1", "a.".repeat(depth)),
            format!("[{}a]", "a.".repeat(depth)),
            format!("a = {}{}", "[".repeat(depth), "]".repeat(depth)),
            format!("a = {}1{}", "{a=".repeat(depth), "}".repeat(depth)),
        ] {
            assert!(!Document::parse("deep.toml", &text).unwrap_err().is_empty());
        }
    }
}

#[test]
fn columns_after_other_letters_count_characters() {
    let document = document("\"é\".x = 99\n");
    let reader = Reader::new(&document);
    let section = reader.root().table("é");
    section.number("x", Bound::closed(0.0, 1.0), "");
    drop(section);
    let place = only(reader.finish()).place;
    assert_eq!((place.line, place.column, place.width), (1, 9, 2));
}

/// All problems of a reading, and their number.
fn counted(document: &Document) -> (usize, usize) {
    let reader = Reader::new(document);
    let root = reader.root();
    root.number("mass_kg", Bound::positive(), "mass");
    root.numbers("list_mm", OFFSET, 0..=usize::MAX, "numbers");
    let problems = reader.finish().unwrap_err();
    (
        problems.len(),
        problems
            .iter()
            .map(|problem| problem.not_shown().unwrap_or(1))
            .sum(),
    )
}

#[test]
fn of_a_great_many_problems_the_rest_is_counted() {
    let keys: String = (0..10_000).map(|k| format!("k{k} = 1\n")).collect();
    assert_eq!(counted(&document(&keys)), (501, 10_001));
    let list = format!("mass_kg = 1\nlist_mm = [{}]\n", "99,".repeat(10_000));
    assert_eq!(counted(&document(&list)), (501, 10_000));
    let twice = "a = 1\n".repeat(1000);
    let problems = Document::parse("car.toml", &twice).unwrap_err();
    assert_eq!(
        (problems.len(), problems.last().and_then(Problem::not_shown)),
        (101, Some(899))
    );
}

#[test]
fn long_lines_and_values_are_not_repeated() {
    let long = format!(
        "mass_kg = 1\n{}\nx = \"{}\" # {}\n",
        "# \u{e9}".repeat(300),
        "\u{e9}".repeat(300),
        "y".repeat(600)
    );
    let written = document(&long);
    let reader = Reader::new(&written);
    reader.root().number("mass_kg", Bound::positive(), "mass");
    let problem = only(reader.finish());
    assert_eq!(
        (
            problem.place.line,
            problem.place.column,
            &*problem.place.line_text
        ),
        (3, 1, "")
    );
    assert_eq!(problem.value, format!("\"{}...", "\u{e9}".repeat(199)));
    // Line ends of every kind, the last line without one.
    for text in ["a = 1\r\nb = 2\r\n\r\nc = 3", "a = 1\nb = 2\n\nc = 3\n"] {
        let document = document(text);
        let reader = Reader::new(&document);
        let places: Vec<(usize, String)> = reader
            .finish()
            .unwrap_err()
            .into_iter()
            .map(|problem| (problem.place.line, problem.place.line_text.into()))
            .collect();
        assert_eq!(
            places,
            [
                (1, "a = 1".to_string()),
                (2, "b = 2".to_string()),
                (4, "c = 3".to_string())
            ]
        );
    }
}

#[test]
fn tables_of_a_list_are_documents_with_their_places() {
    let mut document = Document::parse(
        "x.toml",
        "a = 1\n[[row]]\nspeed_rpm = \"0..60:30\"\n[[row]]\nspeed_rpm = [30, 9e9]\n",
    )
    .expect("TOML");
    let rows = document.take_tables("row");
    assert_eq!(
        (
            rows.len(),
            document.take_tables("row").len(),
            document.take_tables("a").len()
        ),
        (2, 0, 0)
    );
    let read = |k: usize| {
        let reader = Reader::new(&rows[k]);
        let values = reader
            .root()
            .grid(&Key::new("speed_rpm", spec::grid(0.0, 100.0), "speed"));
        reader.root().text("name", "name");
        (values, reader.finish().expect_err("no name"))
    };
    let (values, problems) = read(0);
    assert!(
        values.is_some_and(|v| v.len() == 3 && (v[2] - 2.0 * std::f64::consts::PI).abs() < 1e-12)
    );
    assert_eq!(
        (
            problems.len(),
            problems[0].place.line,
            &*problems[0].place.line_text
        ),
        (1, 2, "[[row]]")
    );
    let (_, problems) = read(1);
    assert_eq!(
        problems.iter().map(|p| p.place.line).collect::<Vec<_>>(),
        [4, 5]
    );
}

#[test]
fn bytes_that_are_no_text() {
    let message = |bytes: &[u8]| decode("x.toml", bytes).unwrap_err().remove(0).message;
    for bytes in [&b"a\0b"[..], b"\xff\xfe\x00", b"PK\x03\x04\x80"] {
        let problems = decode("x.toml", bytes).unwrap_err();
        assert!(problems[0].message.contains("binary file"), "{problems:?}");
        assert_eq!(problems[0].place.file_name(), Some("x.toml"));
    }
    assert!(message(b" \r\n\t").contains("file is empty"));
    assert!(message(b"\xEF\xBB\xBF").contains("file is empty"));
    assert_eq!(decode("x", b"\xEF\xBB\xBFa = 1").unwrap(), "a = 1");
}

#[test]
fn slips_in_a_line() {
    let first = |line: &str| Document::parse("x.toml", line).unwrap_err().remove(0);
    for (line, column, width, hint) in [
        ("a = 2,40", 5, 4, "write 2.40 with a decimal point"),
        ("a = -1,5 # x", 5, 4, "-1.5"),
        ("a = { value = 2,40, status = \"source\" }", 15, 4, "2.40"),
        ("a_mm = 3 mm", 8, 4, "without `mm`"),
        ("a_mm = 3 mm # x", 8, 4, "without `mm`"),
        ("a = belt drive", 5, 10, "\"belt drive\""),
    ] {
        let problem = first(line);
        assert_eq!(problem.message, "not a valid value", "{line}");
        assert!(problem.hint.contains(hint), "{problem:?}");
        assert_eq!((problem.place.column, problem.place.width), (column, width));
    }
    let long = format!("a = 2,40 # {}", "x".repeat(1000));
    for line in [long.as_str(), "a = [1, 2"] {
        assert!(first(line).message.starts_with("not valid TOML"), "{line}");
    }
    assert!(Document::parse("x.toml", "a = 1").is_ok());
}
