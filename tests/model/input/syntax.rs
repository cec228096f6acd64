//! Texts that are no TOML.

use cvtcycle_config::{Document, decode};

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
