//! Files of the corpus. `tests/diagnostics/KIND.txt` holds the bad files of a kind, one after the other:
//!
//! ```text
//! ======== NAME
//! (the bad file)
//! -------- message
//! (what the program prints)
//! ```
//!
//! A file that is not plain text (another encoding, other line ends) has `(escaped)` after its name, and its lines are written in
//! the form of the fuzzers' corpus: bytes outside printable ASCII are escaped as in Rust. `kinds::made` writes files named `made_...`. A file without a message is read by another one.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

const FILE: &str = "======== ";
const ESCAPED: &str = " (escaped)";
const MESSAGE: &str = "-------- message\n";

/// Folder of the corpus in the package, and in the folder where the program reads it.
pub const FOLDER: &str = "tests/diagnostics";

/// Case in `KIND.txt`.
#[derive(Debug, Default, PartialEq)]
pub struct Case {
    pub name: String,
    /// Text of the file, escaped where [`Case::escaped`] is true.
    pub input: String,
    pub escaped: bool,
    pub message: Option<String>,
}

impl Case {
    pub fn is_made(&self) -> bool {
        self.name.starts_with("made_") || self.name == "all_of_bad.txt"
    }

    /// Bytes of the bad file.
    pub fn bytes(&self) -> Vec<u8> {
        if !self.escaped {
            return self.input.as_bytes().to_vec();
        }
        let lines = self.input.lines();
        let bytes = lines.map(|line| super::escaped::unescape(line.as_bytes()));
        let bytes: Option<Vec<_>> = bytes.collect();
        bytes
            .unwrap_or_else(|| panic!("{}: wrong escape", self.name))
            .concat()
    }
}

pub fn parse(text: &str) -> Vec<Case> {
    let mut cases: Vec<Case> = Vec::new();
    let mut in_message = false;
    for line in text.split_inclusive('\n') {
        if let Some(name) = line.strip_prefix(FILE) {
            let name = name.trim_end();
            let plain = name.strip_suffix(ESCAPED);
            cases.push(Case {
                name: plain.unwrap_or(name).to_owned(),
                escaped: plain.is_some(),
                ..Case::default()
            });
            in_message = false;
            continue;
        }
        let case = cases
            .last_mut()
            .expect("a file begins with the name of a case");
        if line == MESSAGE {
            case.message = Some(String::new());
            in_message = true;
        } else if in_message {
            *case.message.get_or_insert_default() += line;
        } else {
            case.input += line;
        }
    }
    cases
}

pub fn format(cases: &[Case]) -> String {
    let text = |case: &Case| {
        let message = case.message.as_ref().map(|text| MESSAGE.to_owned() + text);
        format!(
            "{FILE}{}{}\n{}{}",
            case.name,
            if case.escaped { ESCAPED } else { "" },
            case.input,
            message.unwrap_or_default()
        )
    };
    cases.iter().map(text).collect()
}

/// Path of `KIND.txt`.
pub fn path(kind: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join(FOLDER)
        .join(kind)
        .with_extension("txt")
}

/// The cases of a kind.
pub fn cases(kind: &str) -> Vec<Case> {
    parse(
        &fs::read_to_string(path(kind))
            .unwrap()
            .replace("\r\n", "\n"),
    )
}

/// Writes the files of all kinds below [`FOLDER`] in an empty folder and makes it the current one, because messages contain these paths.
pub fn unpack() {
    static DONE: LazyLock<()> = LazyLock::new(|| {
        let root = Path::new(env!("CARGO_TARGET_TMPDIR")).join("diagnostics_corpus");
        if root.exists() {
            fs::remove_dir_all(&root).unwrap();
        }
        for kind in super::kinds::KINDS {
            let to = root.join(FOLDER).join(kind);
            let write = |name: &str, bytes: &[u8]| {
                let path = to.join(name);
                fs::create_dir_all(path.parent().unwrap()).unwrap();
                fs::write(path, bytes).unwrap();
            };
            for case in cases(kind).iter().filter(|case| !case.is_made()) {
                write(&case.name, &case.bytes());
            }
        }
        std::env::set_current_dir(root).unwrap();
    });
    LazyLock::force(&DONE);
}

#[test]
fn a_corpus_is_written_as_it_was_read() {
    let text = "======== a.csv\nx\n-------- message\nerror: y\n\nerror: z\n======== data/b.csv\n1,2\n======== made_c\n-------- message\n";
    let cases = parse(text);
    assert_eq!(format(&cases), text);
    assert_eq!(
        (cases[0].input.as_str(), cases[0].message.as_deref()),
        ("x\n", Some("error: y\n\nerror: z\n"))
    );
    assert_eq!(
        (cases[1].name.as_str(), &cases[1].message),
        ("data/b.csv", &None)
    );
    assert_eq!(cases[2].message.as_deref(), Some(""));
    assert!(cases[2].is_made());
}

#[test]
fn an_escaped_file_has_the_bytes() {
    let text = "======== a.csv (escaped)\n\\xff\\xfet\\x00\\r\\n\\\\\n";
    let cases = parse(text);
    assert_eq!(format(&cases), text);
    assert_eq!(
        (cases[0].name.as_str(), cases[0].bytes()),
        ("a.csv", b"\xff\xfet\x00\r\n\\".to_vec())
    );
}
