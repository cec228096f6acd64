//! Files up to a size.

use std::io;

use cvtcycle_config::bounded::{LOGO, Limit, ReadError, TABLE, TOML, TRACE, read, read_file};

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
