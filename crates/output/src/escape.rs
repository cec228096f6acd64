//! Escapes text for files in other forms: markup is escaped, and hidden characters become U+FFFD.

use std::fmt::Write;

use cvtcycle_config::{Problem, Problems, is_hidden, visible};
use serde::Serialize;

/// Escapes text for Markdown and the HTML in it: one line, without characters that end a table cell or begin markup.
///
/// ```
/// # use cvtcycle_output::escape::markdown;
/// assert_eq!(markdown("a|b <c>\n$d$"), r"a\|b &lt;c&gt; \$d\$");
/// ```
#[must_use]
pub fn markdown(text: &str) -> String {
    escaped(text, |c, out| match c {
        '<' => out.push_str("&lt;"),
        '>' => out.push_str("&gt;"),
        '&' => out.push_str("&amp;"),
        c if r"\`*_[]|#~!$".contains(c) => out.extend(['\\', c]),
        c => out.push(c),
    })
}

/// Escapes text for an element or an attribute of XML, as one line.
///
/// ```
/// # use cvtcycle_output::escape::xml;
/// assert_eq!(xml("a < \"b\"\u{1b}\tc"), "a &lt; &quot;b&quot;\u{fffd} c");
/// ```
#[must_use]
pub fn xml(text: &str) -> String {
    escaped(text, |c, out| match c {
        '&' => out.push_str("&amp;"),
        '<' => out.push_str("&lt;"),
        '>' => out.push_str("&gt;"),
        '"' => out.push_str("&quot;"),
        // XML 1.0 cannot represent these.
        '\u{fffe}' | '\u{ffff}' => out.push('\u{fffd}'),
        c => out.push(c),
    })
}

/// Percent-encodes a path as part of an address: every byte except letters, digits, `-._~` and `/`.
///
/// ```
/// # use cvtcycle_output::escape::url_path;
/// assert_eq!(url_path("my car (v2)/ü.svg".as_bytes()), "my%20car%20%28v2%29/%C3%BC.svg");
/// ```
#[must_use]
pub fn url_path(path: &[u8]) -> String {
    let mut out = String::with_capacity(path.len());
    for &byte in path {
        if byte.is_ascii_alphanumeric() || b"-._~/".contains(&byte) {
            out.push(char::from(byte));
        } else {
            // Writing to a text does not fail.
            let _ = write!(out, "%{byte:02X}");
        }
    }
    out
}

/// Formats a value as indented JSON with a line end, hidden characters as `\uXXXX`.
///
/// # Errors
/// A map has keys that are not text; no value of this program has.
pub fn json_text(value: &impl Serialize) -> Result<String, Problems> {
    let mut json =
        serde_json::to_string_pretty(value).map_err(|error| Problem::invalid(error.to_string()))?;
    if !json.contains(is_hidden) {
        json.push('\n');
        return Ok(json);
    }
    let mut text = String::with_capacity(json.len() + 1);
    for c in json.chars() {
        match is_hidden(c) {
            true => push_escaped(&mut text, c),
            false => text.push(c),
        }
    }
    text.push('\n');
    Ok(text)
}

/// Appends a character as `\uXXXX`.
pub fn push_escaped(text: &mut String, c: char) {
    for unit in c.encode_utf16(&mut [0; 2]) {
        // Writing to a text does not fail.
        let _ = write!(text, "\\u{unit:04x}");
    }
}

fn escaped(text: &str, put: impl Fn(char, &mut String)) -> String {
    let line = text.replace(['\n', '\r', '\t'], " ");
    let mut out = String::with_capacity(text.len());
    visible(&line).chars().for_each(|c| put(c, &mut out));
    out
}
