//! A text to words: numbers, names, signs.

use super::Fault;

/// A word with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Word {
    pub what: What,
    pub at: usize,
    pub width: usize,
}

/// What a word is.
#[derive(Clone, Debug, PartialEq)]
pub enum What {
    Number(f64),
    Name(String),
    Sign(&'static str),
    End,
}

/// Signs, longer ones first.
const SIGNS: [&str; 15] = [
    "<=", ">=", "==", "<", ">", "+", "-", "*", "/", "^", "(", ")", ",", ":", "=",
];

/// Splits a text.
///
/// # Errors
/// The first character that belongs to no word.
pub fn words(text: &str) -> Result<Vec<Word>, Fault> {
    let chars: Vec<char> = text.chars().collect();
    let mut found = Vec::new();
    let mut at = 0;
    while at < chars.len() {
        let start = at;
        let c = chars[at];
        if c.is_whitespace() {
            at += 1;
            continue;
        }
        let what = if c.is_ascii_digit()
            || (c == '.' && chars.get(at + 1).is_some_and(char::is_ascii_digit))
        {
            at = number_end(&chars, at);
            let word: String = chars[start..at].iter().collect();
            What::Number(
                word.parse()
                    .map_err(|_| fault(&chars, start, at, "is no number"))?,
            )
        } else if c.is_ascii_alphabetic() || c == '_' {
            while at < chars.len()
                && (chars[at].is_ascii_alphanumeric() || chars[at] == '_' || chars[at] == '.')
            {
                at += 1;
            }
            What::Name(chars[start..at].iter().collect())
        } else {
            let sign = SIGNS.iter().find(|sign| {
                sign.chars()
                    .enumerate()
                    .all(|(k, s)| chars.get(at + k) == Some(&s))
            });
            let sign = sign.ok_or_else(|| fault(&chars, at, at + 1, "has no meaning here"))?;
            at += sign.len();
            What::Sign(sign)
        };
        found.push(Word {
            what,
            at: start,
            width: at - start,
        });
    }
    found.push(Word {
        what: What::End,
        at: chars.len(),
        width: 1,
    });
    Ok(found)
}

fn number_end(chars: &[char], mut at: usize) -> usize {
    let digit = |at: usize| chars.get(at).is_some_and(char::is_ascii_digit);
    while digit(at) || (chars.get(at) == Some(&'.') && digit(at + 1)) {
        at += 1;
    }
    if matches!(chars.get(at), Some('e' | 'E')) {
        let signed = matches!(chars.get(at + 1), Some('+' | '-'));
        let first = at + 1 + usize::from(signed);
        if digit(first) {
            at = first;
            while digit(at) {
                at += 1;
            }
        }
    }
    at
}

fn fault(chars: &[char], start: usize, end: usize, what: &str) -> Fault {
    let word: String = chars[start..end].iter().collect();
    Fault {
        at: start,
        width: end - start,
        message: format!("`{word}` {what}"),
        word,
        hint: String::new(),
    }
}
