//! Problems as text for people.
use std::collections::BTreeSet;

use annotate_snippets::renderer::DecorStyle;
use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};

use crate::problem::Problem;
use crate::problem::place::{Input, Place};

/// Widest text that is shown without being cut.
const WIDTH: usize = 120;
/// A longer one is no name and would hide the message.
const MAX_KEY: usize = 80;
/// A longer text repeats unreadable input.
const MAX_TEXT: usize = 2000;

/// All problems with their lines, and their number on the last line. `colour` adds
/// terminal colours. Empty without problems.
pub fn render(problems: &[Problem], colour: bool) -> String {
    if problems.is_empty() {
        return String::new();
    }
    let renderer = if colour {
        Renderer::styled()
    } else {
        Renderer::plain()
    };
    let renderer = renderer.decor_style(DecorStyle::Ascii).term_width(WIDTH);
    let mut text = String::new();
    for problem in problems {
        text.push_str(&renderer.render(&[group(problem)]));
        text.push_str("\n\n");
    }
    let inputs: BTreeSet<String> = problems
        .iter()
        .map(|problem| visible(problem.place.input.to_string()))
        .filter(|input| !input.is_empty())
        .collect();
    let inputs: Vec<String> = inputs.into_iter().collect();
    let number: usize = problems
        .iter()
        .map(|problem| problem.not_shown().unwrap_or(1))
        .sum();
    let noun = if number == 1 { "problem" } else { "problems" };
    let place = if inputs.is_empty() {
        String::new()
    } else {
        format!(" in {}", inputs.join(", "))
    };
    text.push_str(&format!("{number} {noun}{place}\n"));
    text
}

fn group(problem: &Problem) -> Group<'static> {
    let place = &problem.place;
    let has_line = place.line > 0 && !place.line_text.is_empty();
    let mut title = visible(&problem.message);
    if let Some(key) = unsaid_key(problem) {
        title = format!("{}: {title}", visible(key));
    }
    let input = visible(place.input.to_string());
    if !has_line && place.input != Input::default() {
        title = match place.line {
            0 => format!("{input}: {title}"),
            line => format!("{input}:{line}: {title}"),
        };
    }
    let mut group = Group::with_title(Level::ERROR.primary_title(title));
    let allowed = if problem.allowed.is_empty() {
        String::new()
    } else {
        format!("allowed: {}", visible(&problem.allowed))
    };
    if has_line {
        let annotation = AnnotationKind::Primary.span(underlined(place));
        let annotation = if allowed.is_empty() {
            annotation
        } else {
            annotation.label(allowed)
        };
        let snippet = Snippet::source(place.line_text.clone())
            .line_start(place.line)
            .path(input);
        group = group.element(snippet.annotation(annotation));
    } else if !allowed.is_empty() {
        let value = if problem.value.is_empty() {
            String::new()
        } else {
            format!("{}; ", visible(&problem.value))
        };
        group = group.element(Level::NOTE.message(format!("{value}{allowed}")));
    }
    if !problem.hint.is_empty() {
        group = group.element(Level::HELP.message(visible(&problem.hint)));
    }
    group
}

/// The key of a value in a file where the message leaves it open, as that of a table cell does: the line of column names is far away.
fn unsaid_key(problem: &Problem) -> Option<&str> {
    let key = problem.key.as_str();
    let said = key.is_empty() || key.len() > MAX_KEY || problem.names_key;
    (problem.place.line > 0 && !said).then_some(key)
}

/// The bytes of the line that the caret underlines.
fn underlined(place: &Place) -> std::ops::Range<usize> {
    let line = &place.line_text;
    let byte = |characters: usize| {
        line.char_indices()
            .nth(characters)
            .map_or(line.len(), |(at, _)| at)
    };
    let first = place.column.saturating_sub(1);
    byte(first)..byte(first.saturating_add(place.width.max(1)))
}

/// Input is repeated without its control characters, which could rewrite the terminal, and not without end.
fn visible(text: impl AsRef<str>) -> String {
    let text = text.as_ref();
    let mut shown: String = text
        .chars()
        .take(MAX_TEXT)
        .map(|c| if c.is_control() { '\u{FFFD}' } else { c })
        .collect();
    if text.chars().nth(MAX_TEXT).is_some() {
        shown.push_str("...");
    }
    shown
}
