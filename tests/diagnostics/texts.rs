//! Texts of problems are for users: code decides by kind, key and suggested names.

use crate::sources::sources;

/// Texts of a problem.
const FIELDS: [&str; 3] = ["message", "hint", "allowed"];
/// Methods that inspect a text.
const METHODS: [&str; 10] = [
    "contains",
    "ends_with",
    "find",
    "matches",
    "replace",
    "split",
    "split_once",
    "starts_with",
    "strip_prefix",
    "strip_suffix",
];
/// `allowed` is also the name of a numeric range.
const RANGE: &str = ".allowed.contains(";

/// Inspections of problem texts in a source, outside comments.
fn looks_into(source: &str) -> Vec<String> {
    let code: String = source
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"))
        .flat_map(|line| line.chars().filter(|c| !c.is_whitespace()))
        .collect();
    let mut found = Vec::new();
    for field in FIELDS {
        for method in METHODS {
            for text in ["", ".as_str()", ".trim()"] {
                let pattern = format!(".{field}{text}.{method}(");
                if code.contains(&pattern) && pattern != RANGE {
                    found.push(pattern);
                }
            }
        }
    }
    found
}

#[test]
fn no_code_looks_into_the_text_of_a_problem() {
    let mut wrong = Vec::new();
    for source in sources() {
        let found = looks_into(&source.code).into_iter();
        wrong.extend(found.map(|pattern| format!("{}: {pattern}", source.module)));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn inspections_of_a_text_are_detected() {
    let bad = "if problem\n    .message\n    .contains(\"stopped\") {}";
    assert_eq!(looks_into(bad), [".message.contains("]);
    assert!(looks_into("// problem.message.contains(x)\nself.allowed.contains(1.0)").is_empty());
}

/// True if a text names a command-line option, outside comments.
fn names_an_option(line: &&str) -> bool {
    let mut rest = line.split("--").skip(1);
    let is_text = line.contains('"') && !line.trim_start().starts_with("//");
    is_text && rest.any(|rest| rest.starts_with(|c: char| c.is_ascii_lowercase()))
}

#[test]
fn no_text_of_the_library_names_an_option() {
    // The command that a page offers to copy is a result.
    let of_library =
        |module: &str| !module.starts_with("cvtcycle") && module != "report::whatif::command";
    let mut wrong = Vec::new();
    for source in sources().iter().filter(|source| of_library(&source.module)) {
        let lines = source.code.lines().filter(names_an_option);
        wrong.extend(lines.map(|line| format!("{}: {}", source.module, line.trim())));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
