//! How much structure a text has, counted before it is parsed.
//!
//! A parsed table takes some kB, and two letters of a file (`a.`) can make one; and what is nested without bound is taken apart by a
//! recursion without bound. So both are counted first, word by word as TOML is cut into words, which needs no parser and is not misled
//! where the text is no TOML. Texts and comments do not count.

/// Most tables, and lists at the beginning of a line; the largest shipped file has 177.
pub(crate) const MAX_TABLES: usize = 20_000;
/// Most equals signs: keys with their values, and mistakes around them, of which the parser makes several each.
pub(crate) const MAX_KEYS: usize = 100_000;
/// Most names of one dotted key; the longest that is read has 7. The parser itself allows 80 open brackets.
pub(crate) const MAX_NAMES: usize = 16;
/// Most levels of a value that is kept: all that is read has fewer than ten.
pub(crate) const MAX_LEVELS: usize = 64;

/// Excess of a text, and the byte at which it begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Excess {
    Tables(usize),
    Keys(usize),
    Names(usize),
}

/// A word of the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Word {
    Line,
    Blank,
    Dot,
    Open,
    Brace,
    Equals,
    /// A sign that ends a key.
    Other,
    /// A bare word: of digits only, or another.
    Atom(bool),
    /// A text in quotes.
    Text,
}

/// The first place at which a text has too much structure.
pub(crate) fn excess(text: &str) -> Option<Excess> {
    let bytes = text.as_bytes();
    let (mut at, mut tables, mut keys) = (0, 0, 0);
    let (mut line_start, mut header) = (true, false);
    // The current dotted word: dots, and true if it can be a number such as 1.5.
    let (mut dots, mut number) = (0, true);
    while at < bytes.len() {
        let (word, length) = next(&bytes[at..]);
        match word {
            Word::Blank => {}
            Word::Dot => {
                dots += 1;
                number &= dots == 1;
                if dots >= MAX_NAMES {
                    return Some(Excess::Names(at));
                }
            }
            Word::Atom(digits) => number &= digits,
            Word::Text => number = false,
            Word::Open | Word::Brace | Word::Line | Word::Other | Word::Equals => {
                // One dot between digits is a decimal point, unless a value or the end of a header follows.
                let decimal = number && dots == 1 && word != Word::Equals && !header;
                tables += if decimal { 0 } else { dots };
                tables += usize::from(word == Word::Brace || (word == Word::Open && line_start));
                keys += usize::from(word == Word::Equals);
                header = word == Word::Open && (line_start || header);
                (dots, number) = (0, true);
            }
        }
        if tables > MAX_TABLES {
            return Some(Excess::Tables(at));
        }
        if keys > MAX_KEYS {
            return Some(Excess::Keys(at));
        }
        line_start = word == Word::Line || (line_start && word == Word::Blank);
        at += length;
    }
    None
}

/// The first word and its length in bytes.
fn next(bytes: &[u8]) -> (Word, usize) {
    let until = |ends: &[u8], from: usize| {
        bytes
            .iter()
            .skip(from)
            .position(|byte| ends.contains(byte))
            .map_or(bytes.len(), |at| from + at)
    };
    match bytes[0] {
        b'\n' | b'\r' => (Word::Line, 1),
        b' ' | b'\t' => (Word::Blank, 1),
        b'.' => (Word::Dot, 1),
        b'[' => (Word::Open, 1),
        b'{' => (Word::Brace, 1),
        b'=' => (Word::Equals, 1),
        b',' | b']' | b'}' => (Word::Other, 1),
        b'#' => (Word::Blank, until(b"\r\n", 0)),
        quote @ (b'"' | b'\'') => (Word::Text, quoted(bytes, quote)),
        _ => {
            let length = until(b".=,[]{} \t#\r\n", 0);
            (
                Word::Atom(
                    bytes[..length]
                        .iter()
                        .all(|byte| byte.is_ascii_digit() || b"+-_eE".contains(byte)),
                ),
                length,
            )
        }
    }
}

/// Length of a text in quotes; one that is not closed ends with its line, or, in three quotes, with the file.
fn quoted(bytes: &[u8], quote: u8) -> usize {
    let long = bytes.starts_with(&[quote; 3]);
    let mut at = if long { 3 } else { 1 };
    while let Some(&byte) = bytes.get(at) {
        match byte {
            b'\\' if quote == b'"' => {
                at += 1 + usize::from(bytes.get(at + 1).is_some_and(|next| b"\\\"".contains(next)))
            }
            b'\n' if !long => return at,
            _ if byte == quote && !long => return at + 1,
            _ if byte == quote && bytes[at..].starts_with(&[quote; 3]) => {
                let end = at + 3;
                // Two more belong to the text.
                return end
                    + bytes[end..]
                        .iter()
                        .take(2)
                        .take_while(|byte| **byte == quote)
                        .count();
            }
            _ => at += 1,
        }
    }
    bytes.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_counted_in_all_their_forms() {
        let many = MAX_TABLES / 2;
        for table in [
            "[a]\n",
            "[[a]]\n",
            "  [a]\n",
            "x={}\n",
            "a.b=1\n",
            "1.1=1\n",
            "a . b = 1\n",
            "\"a\".b=1\n",
            "[1.1]\n",
        ] {
            assert_eq!(excess(&table.repeat(many)), None, "{table}");
            assert!(
                matches!(excess(&table.repeat(2 * many + 1)), Some(Excess::Tables(_))),
                "{table}"
            );
        }
        // Two tables a line.
        for table in ["[a.b]\n", "x={a.b=1}\n", "a.b.c=1\n", "1.1.1=1\n"] {
            assert!(excess(&table.repeat(many + 1)).is_some(), "{table}");
        }
    }

    #[test]
    fn what_makes_no_table_does_not_count() {
        for line in [
            "1.5, 2.5,\n",
            "x = 1.5\n",
            "x = -1.5e-3 # a.b.c [x] {\n",
            "x = \"a.b [ {\"\n",
            "x = '''\n[a]\n'''\n",
            "x = [[1], [2]]\n",
        ] {
            assert_eq!(excess(&line.repeat(2 * MAX_TABLES)), None, "{line}");
        }
        assert_eq!(excess(&"x = \"\\\"{{\\\\\"\n".repeat(MAX_TABLES)), None);
        assert_eq!(
            excess(&format!(
                "x = \"\"\"{}\"\"\"\"\"\n",
                "{\n".repeat(2 * MAX_TABLES)
            )),
            None
        );
        // A text that is not closed ends with its line.
        assert!(excess(&"x = \"a\n{}".repeat(MAX_TABLES + 1)).is_some());
    }

    #[test]
    fn keys_are_counted_by_their_equals_signs() {
        for (text, at) in [("=", MAX_KEYS), ("a=1\n", 4 * MAX_KEYS + 1)] {
            assert_eq!(excess(&text.repeat(MAX_KEYS)), None);
            assert_eq!(excess(&text.repeat(MAX_KEYS + 1)), Some(Excess::Keys(at)));
        }
    }

    #[test]
    fn long_keys_are_refused_wherever_they_stand() {
        let key = |names: usize| vec!["a"; names].join(".");
        for (before, after) in [
            ("", " = 1"),
            ("[", "]"),
            ("x = { ", " = 1 }"),
            ("] ", " \""),
            ("} ", " ] ["),
        ] {
            assert_eq!(
                excess(&format!("{before}{}{after}\n", key(MAX_NAMES))),
                None,
                "{before}"
            );
            assert!(
                matches!(
                    excess(&format!("{before}{}{after}\n", key(MAX_NAMES + 1))),
                    Some(Excess::Names(_))
                ),
                "{before}"
            );
        }
        assert_eq!(excess(&format!("# {}\nx = \"{}\"", key(99), key(99))), None);
    }
}
