//! A sentence of a complaint that no bad file shows fails here.
//!
//! The source is read as text: in every file that makes problems of a user's file, each text literal with a blank in it that stands within
//! a maker of complaints (`complain`, `Complaint::new`, `Problem { .. }`, `Err(..)` and the like), or is given to a name such as `message`
//! or `hint`, must stand in one of the expected texts, its `{..}` being anything. A new file with a maker is looked at by itself.
//!
//! Limits: a sentence that a function returns under another name, or that is put together from single words, is not seen; two makers with
//! the same words count as one; a sentence of two branches must be met in both, but not each value that it may hold.

use std::path::{Path, PathBuf};

/// Marks of a file that makes problems.
const MARKS: [&str; 4] = [".complain(", "Complaint::new(", "Problem {", "Fault {"];

/// Files that make no such problems, or not of a user's input file: path and reason.
const OUTSIDE: [(&str, &str); OUTSIDE_COUNT] = [
    (
        "src/calibrate/solve/descend.rs",
        "the search: tests/calibrate_solve",
    ),
    ("src/cli/belt/sink.rs", "output"),
    ("src/cli/explain.rs", "words of the command line"),
    ("src/cli/losses/plan.rs", "options"),
    ("src/cli/mod.rs", "words of the command line"),
    ("src/cli/run/cars.rs", "options"),
    ("src/cli/sniff.rs", "words of the command line"),
    ("src/cli/study.rs", "options"),
    ("src/cli/study/common.rs", "options and output"),
    ("src/cli/answer.rs", "output"),
    ("src/cli/ranges.rs", "options"),
    ("src/cli/rig/transmission.rs", "options"),
    ("src/config/assign.rs", "overrides: src/config/tests.rs"),
    ("src/cycle/find.rs", "words of options"),
    ("src/cycle/constant.rs", "words of options"),
    ("src/results/file.rs", "output"),
    ("src/results/files.rs", "output"),
    (
        "src/review/compare.rs",
        "directories that the program wrote",
    ),
    ("src/review/found.rs", "directories that the program wrote"),
    ("src/setup/mod.rs", "words of options"),
    ("src/setup/other_box.rs", "overrides"),
    ("src/study/export.rs", "output"),
    ("src/study/plan/embedded.rs", "words of the command line"),
    ("src/study/store/dir.rs", "files that the program wrote"),
    ("src/study/store/history.rs", "files that the program wrote"),
    ("src/study/store/mod.rs", "files that the program wrote"),
    (
        "src/study/store/parquet_read.rs",
        "files that the program wrote",
    ),
    (
        "src/validate/judge.rs",
        "what only computing shows: tests/validate.rs",
    ),
];
const OUTSIDE_COUNT: usize = 28;

/// Files that make sentences and no problems: what they say is passed on by a reader.
const PASSED_ON: [&str; 4] = [
    "src/numeric/curve.rs",
    "src/numeric/grid.rs",
    "src/lubricant/viscosity.rs",
    "src/engine/fuel.rs",
];

/// Sentences without a bad file: file, beginning of the sentence and reason.
const EXCUSED: [(&str, &str, &str); EXCUSED_COUNT] = [
    (
        "src/rig/points/lines.rs",
        "cannot read on: ",
        "needs a failing disk",
    ),
    (
        "src/rig/points/lines.rs",
        "check the file and its disk",
        "needs a failing disk",
    ),
    (
        "src/rig/points/model.rs",
        "this belt does not fit",
        "of the vehicle, which is refused before",
    ),
    (
        "src/rig/points/model.rs",
        "check length_m of the belt",
        "of the vehicle, which is refused before",
    ),
    (
        "src/config/reader.rs",
        "`{path}` is a table, not a value",
        "overrides only: src/config/tests.rs",
    ),
    (
        "src/engine/load.rs",
        "a combination of speed and load stands twice",
        "setup/map_csv.rs says it before, with the line",
    ),
    (
        "src/lubricant/viscosity.rs",
        "viscosity must be above",
        "the ranges of the keys lie above it",
    ),
    (
        "src/numeric/curve.rs",
        "a curve takes finite numbers only",
        "the ranges of the keys keep others out",
    ),
    (
        "src/numeric/curve.rs",
        "a curve takes at most",
        "src/numeric/curve.rs has its test",
    ),
    (
        "src/numeric/grid.rs",
        "the {} rows do not fill",
        "setup/map_csv.rs says it before, with the line",
    ),
    (
        "src/numeric/grid.rs",
        "the combination {x:?}",
        "setup/map_csv.rs says it before, with the line",
    ),
    (
        "src/results/history/read.rs",
        "the trace has too many steps",
        "a file of 140 MB; as Parquet in tests/limits",
    ),
    (
        "src/setup/tables.rs",
        "every combination of the columns'",
        "setup/map_csv.rs says it before, with the line",
    ),
    (
        "src/setup/tables.rs",
        "a full grid",
        "setup/map_csv.rs says it before, with the line",
    ),
    (
        "src/study/prepare.rs",
        "give fewer values",
        "the plan's reader says it before",
    ),
    (
        "src/validate/expr/calls.rs",
        "a function",
        "a fallback that nothing reaches",
    ),
];
const EXCUSED_COUNT: usize = 16;

/// What makes a complaint of the texts within its brackets.
const MAKERS: [&str; 17] = [
    "complain",
    "Complaint::new",
    "Problem",
    "Complaint",
    "Fault",
    "Err",
    "report",
    "fault",
    "fault_of_missing",
    "absent",
    "problem",
    "refuse",
    "wrong_type",
    "of_plan",
    "at",
    "unexpected",
    "add",
];

/// Names whose texts are parts of a complaint.
const NAMES: [&str; 10] = [
    "message",
    "allowed",
    "hint",
    "complaint",
    "why",
    "what",
    "form",
    "wanted",
    "one_of",
    "twice",
];

/// A text literal that is part of a complaint.
#[derive(Debug)]
struct Sentence {
    line: usize,
    text: String,
}

pub fn check(said: &[String]) {
    let mut wrong = String::new();
    let mut excused = [0_usize; EXCUSED.len()];
    let mut count = 0;
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for path in sources(&root.join("src")) {
        let name = path
            .strip_prefix(root)
            .unwrap()
            .to_str()
            .unwrap()
            .replace('\\', "/");
        let source = std::fs::read_to_string(&path).unwrap();
        let code = source.split("#[cfg(test)]").next().unwrap();
        let marked = MARKS.iter().any(|mark| code.contains(mark));
        let outside = OUTSIDE.iter().any(|(file, _)| *file == name);
        if outside && !marked {
            wrong += &format!("{name}: makes no problems, so it needs no reason to be left out\n");
        }
        if outside || !(marked || PASSED_ON.contains(&name.as_str())) {
            continue;
        }
        for sentence in sentences(code) {
            count += 1;
            let excuse = EXCUSED
                .iter()
                .position(|(file, text, _)| *file == name && sentence.text.starts_with(text));
            match (excuse, said.iter().any(|text| is_in(&sentence.text, text))) {
                (Some(excuse), false) => excused[excuse] += 1,
                (None, false) => {
                    wrong += &format!(
                        "{name}:{}: no bad file shows {:?}\n",
                        sentence.line, sentence.text
                    )
                }
                (_, true) => {}
            }
        }
    }
    for ((file, text, _), used) in EXCUSED.iter().zip(excused) {
        if used == 0 {
            wrong += &format!("{file}: {text:?} is excused for nothing\n");
        }
    }
    assert!(wrong.is_empty(), "\n{wrong}");
    assert!(count > 300, "only {count} sentences");
}

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut list = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        if path.is_dir() && name != "tests" {
            list.append(&mut sources(&path));
        } else if name.ends_with(".rs") && name != "tests.rs" {
            list.push(path);
        }
    }
    list.sort();
    list
}

/// Whether the fixed parts of a sentence stand in a text, one after the other.
fn is_in(sentence: &str, text: &str) -> bool {
    let mut rest = text;
    parts(sentence)
        .iter()
        .all(|part| match rest.find(part.as_str()) {
            Some(at) => {
                rest = &rest[at + part.len()..];
                true
            }
            None => false,
        })
}

/// The fixed parts of a format text.
fn parts(sentence: &str) -> Vec<String> {
    let mut parts = vec![String::new()];
    let mut letters = sentence.chars().peekable();
    while let Some(letter) = letters.next() {
        match letter {
            '{' | '}' if letters.peek() == Some(&letter) => {
                letters.next();
                parts.last_mut().unwrap().push(letter);
            }
            '{' => {
                letters.by_ref().find(|c| *c == '}');
                parts.push(String::new());
            }
            _ => parts.last_mut().unwrap().push(letter),
        }
    }
    parts.retain(|part| !part.is_empty());
    parts
}

/// An open bracket.
#[derive(Debug, Default)]
struct Bracket {
    /// The name before it.
    name: String,
    /// Whether the statement under way in it gives a value to one of [`NAMES`].
    says: bool,
    /// Whether a pattern is being read.
    pattern: bool,
}

/// The sentences of complaints in a source.
fn sentences(code: &str) -> Vec<Sentence> {
    let text: Vec<char> = code.chars().collect();
    let mut found = Vec::new();
    let mut open = vec![Bracket::default()];
    let mut word = String::new();
    let (mut at, mut line) = (0, 1);
    while at < text.len() {
        let letter = text[at];
        line += usize::from(letter == '\n');
        let next = text.get(at + 1).copied().unwrap_or(' ');
        if letter == '/' && next == '/' {
            while at < text.len() && text[at] != '\n' {
                at += 1;
            }
            continue;
        }
        if letter == '\'' {
            at += quoted_letter(&text[at..]);
            continue;
        }
        if letter == '"' {
            let (length, literal, lines) = literal(&text[at..]);
            let said = open
                .iter()
                .any(|bracket| bracket.says || MAKERS.contains(&bracket.name.as_str()));
            if said
                && literal.trim().contains(' ')
                && parts(&literal).iter().any(|part| part.trim().len() > 2)
            {
                found.push(Sentence {
                    line,
                    text: literal,
                });
            }
            line += lines;
            at += length;
            word.clear();
            continue;
        }
        if letter.is_alphanumeric() || letter == '_' {
            word.push(letter);
        } else {
            take(&mut open, &mut word, letter, next);
        }
        at += 1;
    }
    found
}

/// Takes a sign after a word.
fn take(open: &mut Vec<Bracket>, word: &mut String, sign: char, next: char) {
    let here = open.last_mut().unwrap();
    let last = word.rsplit("::").next().unwrap_or_default();
    match last {
        "let" => (here.pattern, here.says) = (true, false),
        name if here.pattern && NAMES.contains(&name) => here.says = true,
        name if sign == ' ' && next == '=' && NAMES.contains(&name) => here.says = true,
        _ => {}
    }
    match sign {
        '(' | '[' | '{' => {
            // Brackets of a pattern belong to it.
            let pattern = here.pattern;
            let name = std::mem::take(word);
            open.push(Bracket {
                name,
                says: false,
                pattern,
            });
            return;
        }
        ')' | ']' | '}' => {
            let closed = open.pop().unwrap();
            if open.is_empty() {
                open.push(Bracket::default());
            }
            if closed.pattern {
                open.last_mut().unwrap().says |= closed.says;
            }
        }
        '=' => here.pattern = false,
        ';' => (here.says, here.pattern) = (false, false),
        ':' => {
            word.push(':');
            return;
        }
        // The name of a struct stands a blank before its bracket.
        ' ' if next == '{' => return,
        _ => {}
    }
    word.clear();
}

/// Length of a letter in quotes; 1 for the mark of a lifetime.
fn quoted_letter(text: &[char]) -> usize {
    match (text.get(1), text.get(2)) {
        (Some('\\'), _) => text
            .iter()
            .skip(3)
            .position(|c| *c == '\'')
            .map_or(1, |at| at + 4),
        (_, Some('\'')) => 3,
        _ => 1,
    }
}

/// Length of a literal, its text, and the line ends in it.
fn literal(text: &[char]) -> (usize, String, usize) {
    let (mut at, mut lines) = (1, 0);
    let mut content = String::new();
    while at < text.len() && text[at] != '"' {
        if text[at] == '\\' {
            at += 1;
            match text[at] {
                'n' => content.push('\n'),
                '\n' => {
                    lines += 1;
                    while text.get(at + 1).is_some_and(|c| c.is_whitespace()) {
                        at += 1;
                    }
                }
                letter => content.push(letter),
            }
        } else {
            lines += usize::from(text[at] == '\n');
            content.push(text[at]);
        }
        at += 1;
    }
    (at + 1, content, lines)
}

#[test]
fn sentences_are_found_where_complaints_are_made() {
    let code = "fn f(s: &'static str) -> X {\n    let (message, hint) = match x {\n        'a' => (\"one {x} two\", \"three four\"),\n    };\n    \
                s.number(\"k\", \"no complaint here\");\n    // complain(\"not this one\")\n    s.complain(\"k\", \"a b\", &format!(\"c \\\"d\\\" {{e}}\"));\n    \
                let other = \"not this\";\n    Problem { hint: \"g h\".into() };\n    if x { hint = \"i j\"; }\n}\n";
    let found: Vec<String> = sentences(code)
        .into_iter()
        .map(|sentence| sentence.text)
        .collect();
    assert_eq!(
        found,
        [
            "one {x} two",
            "three four",
            "a b",
            "c \"d\" {{e}}",
            "g h",
            "i j"
        ]
    );
    assert_eq!(sentences(code)[3].line, 7);
    assert!(is_in("one {x} two", "say one 3 two") && !is_in("one {x} two", "two one"));
    assert!(is_in("{{e}} {}", "{e} 3"));
}
