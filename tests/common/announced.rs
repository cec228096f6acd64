//! Problems that bad files announce in comments above the bad line.

use cvtcycle::config::Problem;

/// Problem announced by a bad file: its line, and parts of its message, hint and allowed range.
#[derive(Default)]
pub struct Expected {
    line: usize,
    message: String,
    hint: String,
    allowed: String,
}

/// Parses the comments `#~ MESSAGE`, `#~ hint: ...` and `#~ allowed: ...` about the line below them.
pub fn expectations(text: &str) -> Vec<Expected> {
    let mut all: Vec<Expected> = Vec::new();
    let mut open = 0;
    for (index, line) in text.lines().enumerate() {
        let Some(part) = line.trim_start().strip_prefix("#~ ") else {
            let from = all.len() - open;
            all[from..]
                .iter_mut()
                .for_each(|expected| expected.line = index + 1);
            open = 0;
            continue;
        };
        match (part.split_once(": "), all.last_mut()) {
            (Some(("hint", hint)), Some(last)) => last.hint = hint.to_string(),
            (Some(("allowed", allowed)), Some(last)) => last.allowed = allowed.to_string(),
            _ => {
                all.push(Expected {
                    message: part.to_string(),
                    ..Expected::default()
                });
                open += 1;
            }
        }
    }
    all
}

/// Differences between expected and found problems, as text.
pub fn differences(expected: &[Expected], found: &[Problem]) -> String {
    let mut rest: Vec<&Problem> = found.iter().collect();
    let mut text = String::new();
    for wanted in expected {
        let fits = |problem: &&Problem| {
            problem.place.line == wanted.line
                && problem.message.contains(&wanted.message)
                && problem.hint.contains(&wanted.hint)
                && problem.allowed.contains(&wanted.allowed)
        };
        match rest.iter().position(fits) {
            Some(at) => drop(rest.remove(at)),
            None => {
                text += &format!(
                    "not found: line {} {} / {}\n",
                    wanted.line, wanted.message, wanted.hint
                )
            }
        }
    }
    for problem in rest {
        text += &format!("not expected: {problem:#?}\n");
    }
    text
}
