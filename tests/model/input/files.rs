//! Files up to a size, and CSV tables: places, limits, fields, encodings.

use cvtcycle_config::bounded::{LOGO, Limit, ReadError, TABLE, TOML, TRACE, read, read_file};
use cvtcycle_config::csv::{self, Cells, Collector, Column, Field, Line, Schema, Table};
use cvtcycle_config::{Problem, Problems};
use std::io;

const SMALL: Limit = Limit {
    bytes: 1000,
    hint: "less",
};

#[test]
fn a_file_at_its_limit_is_read_and_one_byte_more_is_not() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("f");
    for (length, is_read) in [
        (0, true),
        (999, true),
        (1000, true),
        (1001, false),
        (5000, false),
    ] {
        std::fs::write(&path, vec![b'x'; length]).expect("written");
        for read in [read(&path, SMALL), read_file(&path, SMALL)] {
            match read {
                Ok(bytes) => assert!(is_read && bytes.len() == length, "{length}"),
                Err(refused) => {
                    assert!(!is_read, "{length}: {refused}");
                    assert_eq!(refused.to_string(), format!("it has {length} bytes"));
                    assert_eq!(
                        (refused.allowed("x"), refused.hint("x")),
                        ("up to 1 kB".to_owned(), "less")
                    );
                }
            }
        }
    }
}

#[test]
fn what_cannot_be_read_keeps_its_words() {
    let dir = tempfile::tempdir().expect("a folder");
    let missing = read_file(dir.path().join("no"), SMALL).expect_err("not there");
    assert_eq!(
        (missing.kind(), missing.allowed("a"), missing.hint("b")),
        (io::ErrorKind::NotFound, "a".to_owned(), "b")
    );
    let folder = read_file(dir.path(), SMALL).expect_err("a folder");
    assert!(matches!(folder, ReadError::Unreadable(_)), "{folder}");
    assert_eq!(
        [TOML, TABLE, TRACE, LOGO].map(|limit| limit.allowed()),
        [
            "up to 1 MiB",
            "up to 64 MiB",
            "up to 512 MiB",
            "up to 500 kB"
        ]
    );
}

#[cfg(unix)]
#[test]
fn a_device_has_no_size_and_is_read_up_to_the_limit() {
    let endless = read("/dev/zero", SMALL).expect_err("endless");
    assert_eq!(endless.to_string(), "it has more than 1 kB");
    assert_eq!(endless.allowed("x"), "up to 1 kB");
    assert!(matches!(
        read_file("/dev/zero", SMALL),
        Err(ReadError::NoFile)
    ));
    assert_eq!(read("/dev/null", SMALL).expect("nothing"), b"");
}

#[test]
fn a_place_counts_characters_and_not_bytes() {
    let line = Line {
        number: 7,
        text: "é,ü,12",
    };
    let mut problems = Collector::new("f.csv");
    problems.value(line, Field { start: 6, end: 8 }, "k", Problem::default);
    let place = &problems.finish()[0].place;
    let text = &*place.line_text;
    assert_eq!(
        (place.line, place.column, place.width, text),
        (7, 5, 2, "é,ü,12")
    );
}

#[test]
fn long_lines_and_values_are_kept_off_the_screen() {
    let text = "ö".repeat(1000);
    let line = Line {
        number: 1,
        text: &text,
    };
    let whole = Field {
        start: 0,
        end: text.len(),
    };
    let mut problems = Collector::new("f.csv");
    problems.value(line, whole, "k", Problem::default);
    let problem = &problems.finish()[0];
    assert_eq!(&*problem.place.line_text, "");
    assert_eq!(problem.value.chars().count(), 63);
}

#[test]
fn a_long_line_and_many_columns_are_refused() {
    const MAX_LINE_LEN: usize = 1 << 20;
    for (length, is_read) in [(MAX_LINE_LEN - 1, true), (MAX_LINE_LEN, false)] {
        let text = format!("a,b\n{}\n1,2\n", "1".repeat(length));
        let mut problems = Collector::new("f.csv");
        let count = problems.lines(text.as_bytes()).map(Iterator::count);
        assert_eq!(count, is_read.then_some(3));
        let list = problems.finish();
        assert_eq!(
            list.first().map(|p| p.message.as_str()),
            (!is_read).then_some("line 2 is too long for a row of a table")
        );
    }
    for (columns, is_read) in [(1000, true), (1001, false)] {
        let schema = Schema {
            columns: vec![Column::new("a", Cells::Ignored)],
            lenient: Some(("table", "")),
            ..Schema::default()
        };
        let text = vec!["b"; columns - 1].join(",") + ",a\n" + &",".repeat(columns - 1);
        let mut problems = Collector::new("f.csv");
        let table = csv::read(
            text.as_bytes(),
            &schema,
            &mut problems,
            |_, _, _| {},
            |_, _| true,
        );
        assert_eq!((table.is_some(), problems.is_empty()), (is_read, is_read));
    }
}

#[test]
fn the_rest_is_counted() {
    for (count, last) in [
        (50, None),
        (51, Some("1 more problem is not shown")),
        (250, Some("200 more problems are not shown")),
    ] {
        let mut problems = Collector::new("f.csv");
        for _ in 0..count {
            problems.file(Problem::default());
        }
        let list = problems.finish();
        assert_eq!(list.len(), count.min(50) + usize::from(last.is_some()));
        let message = list.last().map(|p| p.message.as_str());
        assert_eq!(message.filter(|m| !m.is_empty()), last);
    }
}

/// Texts and first bytes of the fields of a row, or the problems of a row with so many columns.
fn fields(text: &str, columns: usize) -> Result<Vec<(&str, usize)>, Problems> {
    let names: Vec<String> = (0..columns).map(|k| format!("c{k}")).collect();
    let column = |name: &String| Column::new(name.clone(), Cells::Word).or_empty();
    let schema = Schema {
        columns: names.iter().map(column).collect(),
        ..Schema::default()
    };
    let header = names.join(",");
    let line = |text| Line { number: 1, text };
    let mut problems = Collector::new("f.csv");
    let mut table = Table::open(line(&header), std::iter::empty(), &schema, &mut problems).unwrap();
    let row = table.row(line(text), &mut problems);
    let field = |field: &Field| (&text[field.start..field.end], field.start);
    let fields = row.fields().iter().map(field).collect();
    problems.finish().finish().map(|()| fields)
}

#[test]
fn a_line_is_split_at_commas() {
    assert_eq!(fields("a,b", 2).unwrap(), [("a", 0), ("b", 2)]);
    assert_eq!(
        fields("  a b ,\t,c ", 3).unwrap(),
        [("a b", 2), ("", 8), ("c", 9)]
    );
    assert_eq!(fields("", 1).unwrap(), [("", 0)]);
    assert_eq!(fields(",é,", 3).unwrap(), [("", 0), ("é", 1), ("", 4)]);
}

#[test]
fn quotes_hold_commas_together() {
    assert_eq!(fields("\"a,b\",c", 2).unwrap(), [("a,b", 1), ("c", 6)]);
    assert_eq!(
        fields(" \"\" , \"x \"\"y\"\"\"", 2).unwrap(),
        [("", 2), ("x \"\"y\"\"", 7)]
    );
    for text in ["a,\"b,c", "a,\"b\" c,d"] {
        let problem = fields(text, 3).unwrap_err().remove(0);
        assert_eq!(problem.message, "this quote is not closed");
        assert_eq!(problem.place.column, 3);
    }
}

#[test]
fn what_is_no_text_is_named() {
    let lines = |bytes: &[u8]| {
        let mut problems = Collector::new("f.csv");
        let count = problems.lines(bytes).map(Iterator::count);
        count.ok_or_else(|| problems.finish().remove(0).message)
    };
    for (bytes, part) in [
        (&b"\xff\xfet\0"[..], "UTF-16"),
        (b"PK\n\0\x01", "zero byte in line 2"),
        (b"a\nb\n\xe9\n", "UTF-8 text: line 3"),
        (b"\xef\xbb\xbf \r\n\n", "empty"),
        (b"", "empty"),
        (b"a,b\r1,2\r", "carriage return"),
    ] {
        let message = lines(bytes).unwrap_err();
        assert!(message.contains(part), "{message}");
    }
    assert_eq!(lines(b"\xef\xbb\xbfa,b\r\n"), Ok(1));
}
