//! A text to tokens: numbers, names, signs.

use super::syntax::Fault;

/// A token with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Token {
    pub kind: TokenKind,
    pub at: usize,
    pub width: usize,
}

/// Kind of a token.
#[derive(Clone, Debug, PartialEq)]
pub enum TokenKind {
    Number(f64),
    Name(String),
    Sign(&'static str),
    End,
}

impl TokenKind {
    /// The text of the token; empty at the end.
    pub fn text(&self) -> String {
        match self {
            TokenKind::Number(x) => x.to_string(),
            TokenKind::Name(name) => name.clone(),
            TokenKind::Sign(sign) => (*sign).to_owned(),
            TokenKind::End => String::new(),
        }
    }
}

/// Signs, longer ones first.
const SIGNS: [&str; 15] = [
    "<=", ">=", "==", "<", ">", "+", "-", "*", "/", "^", "(", ")", ",", ":", "=",
];

/// Splits a text; the last token is the end.
///
/// # Errors
/// The first character that belongs to no token.
pub fn tokens(text: &str) -> Result<Vec<Token>, Fault> {
    let chars: Vec<char> = text.chars().collect();
    let digit = |at: usize| chars.get(at).is_some_and(char::is_ascii_digit);
    let mut found = Vec::new();
    let mut at = 0;
    while at < chars.len() {
        let start = at;
        let c = chars[at];
        if c.is_whitespace() {
            at += 1;
            continue;
        }
        let kind = if digit(at) || (c == '.' && digit(at + 1)) {
            at = number_end(&chars, at);
            let number = chars[start..at].iter().collect::<String>().parse();
            TokenKind::Number(number.map_err(|_| fault(&chars, start, at, "is no number"))?)
        } else if c.is_ascii_alphabetic() || c == '_' {
            let in_name = |c: &&char| c.is_ascii_alphanumeric() || matches!(c, '_' | '.');
            at += chars[at..].iter().take_while(in_name).count();
            TokenKind::Name(chars[start..at].iter().collect())
        } else {
            let here = |sign: &&&str| {
                sign.chars()
                    .eq(chars[at..].iter().copied().take(sign.len()))
            };
            let sign = SIGNS.iter().find(here);
            let sign = sign.ok_or_else(|| fault(&chars, at, at + 1, "has no meaning here"))?;
            at += sign.len();
            TokenKind::Sign(sign)
        };
        found.push(Token {
            kind,
            at: start,
            width: at - start,
        });
    }
    found.push(Token {
        kind: TokenKind::End,
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
