//! Problems as text for people.
use std::collections::BTreeSet;

use annotate_snippets::renderer::DecorStyle;
use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};

use crate::problem::Problem;
use crate::problem::place::{Input, Place};
use crate::problem::visible::{one_line, visible};

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
        .map(|problem| shown(problem.place.input.to_string()))
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
    let mut title = shown(&problem.message);
    if let Some(key) = unsaid_key(problem) {
        title = format!("{}: {title}", shown(key));
    }
    let input = shown(place.input.to_string());
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
        format!("allowed: {}", shown(&problem.allowed))
    };
    if has_line {
        let line = visible(&place.line_text);
        let annotation = AnnotationKind::Primary.span(underlined(&line, place));
        let annotation = if allowed.is_empty() {
            annotation
        } else {
            annotation.label(allowed)
        };
        let snippet = Snippet::source(line.into_owned())
            .line_start(place.line)
            .path(input);
        group = group.element(snippet.annotation(annotation));
    } else if !allowed.is_empty() {
        let value = if problem.value.is_empty() {
            String::new()
        } else {
            format!("{}; ", shown(&problem.value))
        };
        group = group.element(Level::NOTE.message(format!("{value}{allowed}")));
    }
    if !problem.hint.is_empty() {
        group = group.element(Level::HELP.message(shown(&problem.hint)));
    }
    group
}

/// The key of a value in a file where the message leaves it open, as that of a table cell does: the line of column names is far away.
fn unsaid_key(problem: &Problem) -> Option<&str> {
    let key = problem.key.as_str();
    let said = key.is_empty() || key.len() > MAX_KEY || problem.names_key;
    (problem.place.line > 0 && !said).then_some(key)
}

/// The bytes of the line, as it is shown, that the caret underlines: one character there is one of the file.
fn underlined(line: &str, place: &Place) -> std::ops::Range<usize> {
    let byte = |characters: usize| {
        line.char_indices()
            .nth(characters)
            .map_or(line.len(), |(at, _)| at)
    };
    let first = place.column.saturating_sub(1);
    byte(first)..byte(first.saturating_add(place.width.max(1)))
}

/// Input is repeated without hidden characters, on one line, and not without end.
fn shown(text: impl AsRef<str>) -> String {
    let text = text.as_ref();
    match text.char_indices().nth(MAX_TEXT) {
        Some((end, _)) => format!("{}...", one_line(&text[..end])),
        None => one_line(text).into_owned(),
    }
}
