//! Problems that are found before any key is read: bytes that are no text, text that is no TOML.
use std::ops::Range;

use super::units::{decimal_comma, number_hint};
use crate::problem::source::{MAX_VALUE, Source, shortened};
use crate::problem::{Problem, Problems};
use cvtcycle_model::keys::Quantity;

/// Bytes of a line up to which slips are looked for: longer lines are not written by hand, and the search
/// takes time with the square of the length.
const MAX_LINE: usize = 1000;

/// The text of an input file.
///
/// # Errors
/// One problem if the bytes are not UTF-8 text or hold nothing but white space.
pub fn decode(file: &str, bytes: &[u8]) -> Result<String, Problems> {
    let problem =
        |message: &str, hint: &str| Problem::syntax(message).in_file(file).hint(hint).into();
    let binary = || {
        problem(
            "binary file, expected text",
            "save the file as plain text in UTF-8",
        )
    };
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let text = std::str::from_utf8(bytes).map_err(|_| binary())?;
    if text.contains('\0') {
        return Err(binary());
    }
    if text.trim().is_empty() {
        return Err(problem(
            "file is empty",
            "was it saved? lines are `key = value` below a `[table]`",
        ));
    }
    Ok(text.to_string())
}

/// Lines of which the errors are shown; the rest is counted.
const MAX_SHOWN: usize = 100;

/// The parser's errors as problems, one per line: what follows the first error of a line is
/// mostly its consequence.
pub(crate) fn problems(source: &Source, errors: &[toml::de::Error]) -> Problems {
    let mut ordered: Vec<(Range<usize>, &str)> = errors
        .iter()
        .map(|error| {
            (
                error.span().unwrap_or(source.text.len()..source.text.len()),
                error.message(),
            )
        })
        .collect();
    ordered.sort_by_key(|(span, _)| span.start);
    let mut found = Problems::new();
    let mut more = 0;
    let mut line_end = None;
    for (span, parser) in ordered {
        let start = source.clamp(span.start);
        if line_end.is_none_or(|end| start > end) {
            line_end = Some(
                source.text[start..]
                    .find('\n')
                    .map_or(source.text.len(), |length| start + length),
            );
            if found.len() < MAX_SHOWN {
                found.push(syntax_problem(source, span, parser));
            } else {
                more += 1;
            }
        }
    }
    if more > 0 {
        found.push(Problem::more(source.input.clone(), more));
    }
    found
}

fn syntax_problem(source: &Source, span: Range<usize>, parser: &str) -> Problem {
    let start = source.line_start(span.start);
    let line = source.line_at(span.start);
    let (slip, hint) = match slip(line) {
        Some((range, hint)) => (Some(start + range.start..start + range.end), hint),
        None if parser.contains("recurs") => (None, "no input is nested as deep: is a bracket too many open?".to_string()),
        None if parser.contains("duplicate key") => (None, "remove one of the two entries".to_string()),
        None => (None, "a line is `key = value` or a `[table]`; text is written in quotes, every bracket is closed".to_string()),
    };
    let message = match &slip {
        Some(_) => "not a valid value".to_string(),
        None => format!("not valid TOML: {parser}"),
    };
    let span = slip.unwrap_or(span);
    Problem::syntax(message)
        .value(shortened(
            source.text.get(span.clone()).unwrap_or_default(),
            MAX_VALUE,
        ))
        .at(source.place(span))
        .hint(hint)
}

/// The usual slips in a line that TOML refuses: place of the value and what to write.
fn slip(line: &str) -> Option<(Range<usize>, String)> {
    if line.len() > MAX_LINE {
        return None;
    }
    line.match_indices('=').find_map(|(equals, _)| {
        let rest = &line[equals + 1..];
        let value = rest.trim_start();
        let at = equals + 1 + (rest.len() - value.len());
        let end = value.find(['#', '}']).unwrap_or(value.len());
        let value = value[..end].trim_end();
        if let Some((length, point)) = decimal_comma(value) {
            return Some((
                at..at + length,
                format!("write {point} with a decimal point"),
            ));
        }
        let number = value.split(',').next().unwrap_or_default().trim_end();
        if let Some((figure, unit)) = number_with_unit(number) {
            // The first name of the line, which may be followed by `{ value = …`.
            let key = line.split('=').next().unwrap_or_default().trim();
            let hint = number_hint(figure, unit, Quantity::from_key(key).unit());
            return Some((at..at + number.len(), hint));
        }
        let bare = value.starts_with(char::is_alphabetic)
            && value
                .chars()
                .all(|c| c.is_alphanumeric() || c == '_' || c == '-' || c == ' ')
            && !["true", "false", "nan", "inf"].contains(&value);
        bare.then(|| {
            (
                at..at + value.len(),
                format!("text is written in quotes: \"{value}\""),
            )
        })
    })
}

/// Splits "3 mm" into the figure and the unit.
pub(crate) fn number_with_unit(text: &str) -> Option<(&str, &str)> {
    let text = text.trim();
    let end = text.find(|c: char| !(c.is_ascii_digit() || "+-.,".contains(c)))?;
    let (figure, unit) = (&text[..end], text[end..].trim_start());
    let is_unit = unit.starts_with(|c: char| c.is_alphabetic() || c == '°' || c == '%')
        && unit.chars().count() <= 12
        && !unit.contains(':');
    (figure.contains(|c: char| c.is_ascii_digit()) && is_unit).then_some((figure, unit))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_text() {
        assert_eq!(decimal_comma("2,40"), Some((4, "2.40".into())));
        assert_eq!(decimal_comma("2.40"), None);
        assert_eq!(decimal_comma(",40"), None);
        assert_eq!(number_with_unit("3 mm"), Some(("3", "mm")));
        assert_eq!(number_with_unit("-40°C"), Some(("-40", "°C")));
        assert_eq!(number_with_unit("mm"), None);
        assert_eq!(number_with_unit("3"), None);
    }
}
