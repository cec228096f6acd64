//! Characters of a stranger's text that a reader does not see and that change what he sees: they rewrite the screen, end a line or turn
//! its direction.

use std::borrow::Cow;

/// Put in place of a hidden character.
const REPLACEMENT: char = '\u{FFFD}';

/// True for a character that steers a terminal or the direction of a text, and for one that is no character: the controls of ASCII and
/// Latin-1 except line feed and tab, the line and paragraph separators, the controls of direction, the byte order mark, and the code points
/// U+FDD0 to U+FDEF, which are for use within a program.
#[must_use]
pub fn is_hidden(c: char) -> bool {
    match c {
        '\n' | '\t' => false,
        '\u{061C}' | '\u{200E}' | '\u{200F}' => true,
        '\u{2028}'..='\u{202E}' | '\u{2066}'..='\u{2069}' => true,
        '\u{FDD0}'..='\u{FDEF}' | '\u{FEFF}' => true,
        _ => c.is_control(),
    }
}

/// The text with U+FFFD in place of each hidden character.
#[must_use]
pub fn visible(text: &str) -> Cow<'_, str> {
    replaced(text, is_hidden)
}

/// The text as one line: with U+FFFD in place of each hidden character, line feed and tab.
#[must_use]
pub fn one_line(text: &str) -> Cow<'_, str> {
    replaced(text, |c| is_hidden(c) || matches!(c, '\n' | '\t'))
}

fn replaced(text: &str, bad: impl Fn(char) -> bool) -> Cow<'_, str> {
    if text.contains(&bad) {
        let shown = |c| if bad(c) { REPLACEMENT } else { c };
        text.chars().map(shown).collect()
    } else {
        text.into()
    }
}
