//! Bytes to text, lines to fields.
//!
//! Written here and not taken from a CSV library because a problem states the character at which a value begins.

use crate::Problem;

/// The bytes of a value in its line, without surrounding blanks and quotes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// First byte.
    pub start: usize,
    /// The byte after the last one.
    pub end: usize,
}

/// The text of a file, without byte order mark.
///
/// # Errors
/// An empty or binary file, or one in another encoding than UTF-8.
pub fn decode(bytes: &[u8]) -> Result<&str, Problem> {
    check_encoding(bytes)?;
    let bytes = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
    if let Some(at) = bytes.iter().position(|&byte| byte == 0) {
        return Err(zero_byte(line_of(bytes, at)));
    }
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let line = line_of(bytes, error.valid_up_to());
        not_text(format!(
            "the file is not UTF-8 text: line {line} has a byte that is none"
        ))
        .hint("save it as CSV UTF-8; a spreadsheet's own format cannot be read")
    })?;
    if text.trim().is_empty() {
        return Err(empty());
    }
    if text.contains('\r') && !text.contains('\n') {
        return Err(bare_returns());
    }
    Ok(text)
}

/// First bytes of some files in UTF-8.
pub(super) const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

fn not_text(message: String) -> Problem {
    Problem::syntax(message).allowed("UTF-8 text")
}

/// Checks the first bytes of a file.
///
/// # Errors
/// They are those of UTF-16.
pub(super) fn check_encoding(bytes: &[u8]) -> Result<(), Problem> {
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return Err(not_text("the file is UTF-16 text".to_owned()).hint("save it as CSV UTF-8"));
    }
    Ok(())
}

/// A line has a zero byte.
pub(super) fn zero_byte(line: usize) -> Problem {
    not_text(format!(
        "the file is not text: it has a zero byte in line {line}"
    ))
    .hint("save the table as CSV; a spreadsheet's own format cannot be read")
}

/// Carriage returns alone end the lines.
pub(super) fn bare_returns() -> Problem {
    Problem::syntax("the lines end with a carriage return alone")
        .allowed("lines that end with LF or CR LF")
        .hint("save it with the line ends of today")
}

/// The file has no text.
pub fn empty() -> Problem {
    Problem::missing("the file is empty").hint("it needs a line of column names and rows below it")
}

fn line_of(bytes: &[u8], at: usize) -> usize {
    bytes.iter().take(at).filter(|&&byte| byte == b'\n').count() + 1
}

/// Separator of the columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Delimiter {
    Comma,
    Semicolon,
    Tab,
}

impl Delimiter {
    pub(super) const ALL: [Delimiter; 3] = [Delimiter::Comma, Delimiter::Semicolon, Delimiter::Tab];

    pub(super) fn sign(self) -> char {
        match self {
            Delimiter::Comma => ',',
            Delimiter::Semicolon => ';',
            Delimiter::Tab => '\t',
        }
    }

    pub(super) fn word(self) -> &'static str {
        match self {
            Delimiter::Comma => "comma",
            Delimiter::Semicolon => "semicolon",
            Delimiter::Tab => "tab",
        }
    }
}

/// Splits a line at a sign, such as a comma. A field in double quotes may hold that sign; a quote in it is written twice
/// and stays so.
///
/// # Errors
/// The byte of a quote that is not closed, or after which something follows.
pub fn split(line: &str, sign: char, fields: &mut Vec<Field>) -> Result<(), usize> {
    fields.clear();
    if line.is_ascii() && sign.is_ascii() && !line.contains('"') {
        split_plain(line.as_bytes(), sign as u8, fields);
        return Ok(());
    }
    let is_blank = |c: char| c.is_whitespace() && c != sign;
    let mut at = 0;
    loop {
        let rest = &line[at..];
        let blanks = rest.len() - rest.trim_start_matches(is_blank).len();
        let end = if rest[blanks..].starts_with('"') {
            let start = at + blanks + 1;
            let close = closing_quote(line, start).ok_or(start - 1)?;
            fields.push(Field { start, end: close });
            let after = &line[close + 1..];
            let next = after.find(sign).unwrap_or(after.len());
            if !after[..next].trim().is_empty() {
                return Err(start - 1);
            }
            close + 1 + next
        } else {
            let next = rest.find(sign).unwrap_or(rest.len());
            let start = at + blanks.min(next);
            let end = start + rest[..next].trim().len();
            fields.push(Field { start, end });
            at + next
        };
        if end >= line.len() {
            return Ok(());
        }
        at = end + 1;
    }
}

/// The same of a line without quotes and letters beyond ASCII, as most lines are.
fn split_plain(line: &[u8], sign: u8, fields: &mut Vec<Field>) {
    // The characters of `char::is_whitespace`; the standard library's own for bytes leaves one out.
    let is_blank = |byte: &u8| matches!(byte, b'\t'..=b'\r' | b' ');
    let mut at = 0;
    loop {
        let rest = &line[at..];
        let next = rest.iter().position(|byte| *byte == sign);
        let field = &rest[..next.unwrap_or(rest.len())];
        let first = field.iter().position(|byte| !is_blank(byte));
        let last = field.iter().rposition(|byte| !is_blank(byte));
        let (first, end) = match (first, last) {
            (Some(first), Some(last)) => (first, last + 1),
            // Nothing but blanks: empty at their end.
            _ => (field.len(), field.len()),
        };
        fields.push(Field {
            start: at + first,
            end: at + end,
        });
        let Some(next) = next else { return };
        at += next + 1;
    }
}

fn closing_quote(line: &str, start: usize) -> Option<usize> {
    let bytes = line.as_bytes();
    let mut at = start;
    while at < bytes.len() {
        if bytes[at] != b'"' {
            at += 1;
        } else if bytes.get(at + 1) == Some(&b'"') {
            at += 2;
        } else {
            return Some(at);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the standard library's `split` and `trim`. Lines are all of up to six of these characters.
    #[test]
    fn fields_are_the_trimmed_parts() {
        const SIGNS: [char; 6] = [',', ';', '\t', ' ', '\u{b}', 'a'];
        for number in 0..SIGNS.len().pow(6) {
            let digits = (0..6).map(|k| number / SIGNS.len().pow(k) % SIGNS.len());
            let text: String = digits.map(|digit| SIGNS[digit]).collect();
            for line in [text.as_str(), text.trim_end_matches('a')] {
                for sign in [',', ';', '\t'] {
                    let mut fields = Vec::new();
                    assert_eq!(split(line, sign, &mut fields), Ok(()));
                    let found: Vec<&str> = fields.iter().map(|f| &line[f.start..f.end]).collect();
                    let parts: Vec<&str> = line.split(sign).map(str::trim).collect();
                    assert_eq!(found, parts, "{line:?} at {sign:?}");
                    // With a letter beyond ASCII the line takes the other way: to the same places.
                    let (other, mut there) = (format!("{line}{sign}\u{e9}"), Vec::new());
                    assert_eq!(split(&other, sign, &mut there), Ok(()));
                    assert_eq!(there[..fields.len()], fields[..], "{line:?} at {sign:?}");
                }
            }
        }
    }
}
