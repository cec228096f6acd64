//! Fails if no bad file shows a sentence of a message.
//!
//! The source is scanned as text: in every module that makes problems of a user's file, each string literal with a blank that is an argument
//! of a constructor of messages (`complain`, `Complaint::new`, `Problem { .. }`, `Err(..)`, ...), or is assigned to a name such as `message`
//! or `hint`, must occur in an expected text, with anything in place of its `{..}`. New modules with a constructor are found without an entry here.
//! Limits: a sentence that a function returns under another name, or that is joined from single words, is missed. Two constructors with
//! the same words count as one. A sentence with two branches must occur with both, but not with every value of its placeholders.

use crate::sources::{Source, sources};

/// Marks of a module that makes problems.
const MARKS: [&str; 7] = [
    "Problem::",
    ".complain(",
    ".conflict(",
    ".missing(",
    "Complaint::new(",
    "Problem {",
    "Fault {",
];

/// Modules (with submodules) whose problems are not about input files of users, with the reason.
const OUTSIDE: &[(&str, &str)] = &[
    ("config::cycle::find", "names given to options"),
    ("config::channel", "names given to options"),
    ("config::log", "logs: tests/cli/commands/log.rs"),
    (
        "config::setup",
        "names given to options: only this module, see INSIDE",
    ),
    ("cvtcycle", "options, words of the command line, output"),
    ("output::file", "output"),
    ("output::files", "output"),
    ("python", "arguments of Python: crates/python/tests"),
    ("report::compare", "directories that the program wrote"),
    (
        "report::whatif",
        "pages and records that the program wrote: tools/browser",
    ),
    ("report::problems", "directories that the program wrote"),
    ("report::results", "directories that the program wrote"),
    (
        "validate::judge",
        "found by computing only: tests/results/validate.rs",
    ),
    (
        "study::family",
        "arguments of a call: crates/python/tests/test_family.py",
    ),
    (
        "analysis::levers::combine",
        "names given to options: tests/studies/levers.rs",
    ),
    ("analysis::levers::answer", "tables that the program wrote"),
    ("study::store", "files that the program wrote"),
    ("whatif", "pages that the program wrote: tools/browser"),
    (
        "fleet",
        "rows and columns of a table of cars: tests/cli/commands/fleet.rs",
    ),
];

/// Submodules of those above that read input files.
const INSIDE: &[&str] = &[
    "config::setup::like",
    "config::setup::params",
    "config::setup::twin",
];

/// Modules that return sentences for the problems of a reader.
const PASSED_ON: [&str; 4] = [
    "model::math::curve",
    "model::math::grid",
    "model::lubricant::viscosity",
    "model::maps::bsfc",
];

/// Sentences without a bad file: beginning of the sentence, and the reason.
const EXCUSED: &[(&str, &str)] = &[
    (
        "the design of the plan draws no samples",
        "names given to options: tests/cli",
    ),
    (
        "samples and seed are for",
        "names given to options: tests/cli",
    ),
    (
        "{samples} samples are out of range for this design",
        "names given to options: tests/cli",
    ),
    (
        "the nearest allowed value is {}",
        "names given to options: tests/cli",
    ),
    (" The message is one sentence", "text of documentation"),
    (
        "{}, also in line {}",
        "problems of a kind as one: tests/cli/commands/log.rs",
    ),
    (
        "{}, and in {count} more rows",
        "problems of a kind as one: tests/cli/commands/log.rs",
    ),
    (
        "problem is",
        "tests/model/input/cycle.rs counts problems that are not shown",
    ),
    (
        "a number with a decimal point, or nothing",
        "the case of a bad number has a column that may not be empty",
    ),
    (
        "cannot keep a column of the study in a temporary file",
        "no room on the disk: not a matter of a file",
    ),
    (
        "make room there, or name another folder in TMPDIR",
        "no room on the disk: not a matter of a file",
    ),
    (
        "the file has more than {NODES}",
        "files that the program wrote: tests/cli/limits/structure.rs",
    ),
    (
        "this is no whole JSON",
        "files that the program wrote: tests/results/report/refused.rs",
    ),
    (
        "the file is damaged; run it again",
        "files that the program wrote",
    ),
    ("cannot read on: ", "needs a failing disk"),
    ("check the file and its disk", "needs a failing disk"),
    (
        "`{path}` is a table, not a value",
        "overrides only: unit tests of config",
    ),
    (
        "`{value}` is a value, so `{path}` cannot exist",
        "overrides only: tests/model/input/overrides.rs",
    ),
    (
        "set `{value}` itself",
        "overrides only: tests/model/input/overrides.rs",
    ),
    (
        "stopped before the model",
        "needs a signal: tests/studies/calibrate_cli.rs",
    ),
    ("this belt does not fit", "the vehicle is refused before"),
    (
        "check length_m of the belt",
        "the vehicle is refused before",
    ),
    (
        "viscosity must be above",
        "the ranges of the keys are above it",
    ),
    (
        "a curve takes finite numbers only",
        "the ranges of the keys exclude others",
    ),
    ("a curve takes at most", "unit test of the curve"),
    (
        "the {} rows do not fill",
        "the reader of maps reports it before, with the line",
    ),
    (
        "the combination {x:?}",
        "the reader of maps reports it before, with the line",
    ),
    (
        "every combination of the columns'",
        "the reader of maps reports it before, with the line",
    ),
    (
        "a full grid",
        "the reader of maps reports it before, with the line",
    ),
    ("give fewer values", "the reader of plans reports it before"),
    (
        "the plan varies `{}`",
        "a plan with levers: tests/studies/levers.rs",
    ),
    (
        "levers are driven under conditions",
        "a plan with levers: tests/studies/levers.rs",
    ),
    (
        "`{}` can have none of the levers",
        "levers that the program carries: tests/studies/levers.rs",
    ),
    (
        "name a lever file for such a car",
        "levers that the program carries: tests/studies/levers.rs",
    ),
];

/// Constructors of complaints from the texts within their brackets.
const MAKERS: [&str; 28] = [
    "allowed",
    "hint",
    "message",
    "complain",
    "conflict",
    "missing",
    "duplicate",
    "unknown_key",
    "unknown_name",
    "out_of_range",
    "too_large",
    "mistyped",
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

/// Names of variables and fields with texts of complaints.
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

/// String literal that is part of a complaint.
#[derive(Debug)]
struct Sentence {
    line: usize,
    text: String,
}

/// True if the source is the module or one of its submodules.
fn is_in_module(source: &Source, module: &str) -> bool {
    let rest = source.module.strip_prefix(module);
    rest.is_some_and(|rest| rest.is_empty() || rest.starts_with("::"))
}

pub fn check(messages: &[String]) {
    let mut wrong = String::new();
    let mut excused = vec![0_usize; EXCUSED.len()];
    let mut count = 0;
    let sources = sources();
    for source in &sources {
        let marked = MARKS.iter().any(|mark| source.code.contains(mark));
        let listed = |list: &[&str]| list.iter().any(|module| is_in_module(source, module));
        let outside = OUTSIDE
            .iter()
            .any(|(module, _)| is_in_module(source, module));
        if outside && !listed(INSIDE) || !marked && !listed(&PASSED_ON) {
            continue;
        }
        for sentence in sentences(&source.code) {
            count += 1;
            let known = |(text, _): &(&str, &str)| sentence.text.starts_with(text);
            let excuse = EXCUSED.iter().position(known);
            let shown = messages.iter().any(|text| is_in(&sentence.text, text));
            match (excuse, shown) {
                (Some(excuse), false) => excused[excuse] += 1,
                (None, false) => {
                    let (module, line, text) = (&source.module, sentence.line, &sentence.text);
                    wrong += &format!("{module}, line {line}: no bad file shows {text:?}\n");
                }
                (_, true) => {}
            }
        }
    }
    for ((text, _), used) in EXCUSED.iter().zip(excused) {
        if used == 0 {
            wrong += &format!("{text:?} is excused without need\n");
        }
    }
    let modules = OUTSIDE
        .iter()
        .map(|(module, _)| module)
        .chain(INSIDE)
        .chain(&PASSED_ON);
    for module in
        modules.filter(|module| !sources.iter().any(|source| is_in_module(source, module)))
    {
        wrong += &format!("there is no module {module}\n");
    }
    assert!(wrong.is_empty(), "\n{wrong}");
    assert!(count > 300, "only {count} sentences");
}

/// True if a text contains the fixed parts of a sentence in order.
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

/// Fixed parts of a format string.
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

/// Open bracket.
#[derive(Debug, Default)]
struct Bracket {
    /// Name before it.
    name: String,
    /// True while the statement assigns to one of [`NAMES`].
    says: bool,
    /// True within a pattern.
    pattern: bool,
}

/// Sentences of complaints in a source.
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
            let said = open.iter().any(|bracket| {
                let name = bracket.name.as_str();
                bracket.says || name.starts_with("Problem::") || MAKERS.contains(&name)
            });
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

/// Processes a character after a word.
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
            // Brackets within a pattern belong to it.
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
        // A blank separates the name of a struct from its brace.
        ' ' if next == '{' => return,
        _ => {}
    }
    word.clear();
}

/// Length of a character literal; 1 for a lifetime.
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

/// Length of a literal, its text, and the number of line ends in it.
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
