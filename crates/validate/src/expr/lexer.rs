//! A text to tokens: numbers, names, signs.

use super::Fault;

/// A token with its place, counted in characters.
#[derive(Clone, Debug, PartialEq)]
pub struct Token {
    pub kind: TokenKind,
    /// As written; empty at the end.
    pub text: String,
    pub at: usize,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TokenKind {
    Number(f64),
    Name,
    Sign,
    End,
}

impl Token {
    /// A fault at the token.
    pub fn fault(&self, message: String, hint: String) -> Fault {
        Fault {
            at: self.at,
            width: self.text.chars().count().max(1),
            word: self.text.clone(),
            message,
            hint,
        }
    }
}

/// Signs, longer ones first.
const SIGNS: [&str; 15] = [
    "<=", ">=", "==", "<", ">", "+", "-", "*", "/", "^", "(", ")", ",", ":", "=",
];

/// Most tokens of an expression; the longest shipped one has 139. A tree of so many is at most half as deep, which every recursion over
/// it has room for on a stack of 1 MiB.
pub const MAX_TOKENS: usize = 1000;

/// Splits a text; the last token is the end.
///
/// # Errors
/// The first character that belongs to no token, or the first token that is too many.
pub fn tokens(text: &str) -> Result<Vec<Token>, Fault> {
    let chars: Vec<char> = text.chars().collect();
    let token = |kind, from: usize, to: usize| Token {
        kind,
        text: chars[from..to].iter().collect(),
        at: from,
    };
    let digit = |at: usize| chars.get(at).is_some_and(char::is_ascii_digit);
    let mut found: Vec<Token> = Vec::new();
    let mut at = 0;
    while let Some(&c) = chars.get(at) {
        let rest = &chars[at..];
        let (kind, width) = if c.is_whitespace() {
            at += 1;
            continue;
        } else if digit(at) || (c == '.' && digit(at + 1)) {
            let end = number_end(&chars, at);
            let number = token(TokenKind::End, at, end);
            let bad = |_| number.fault(format!("`{}` is no number", number.text), String::new());
            (
                TokenKind::Number(number.text.parse().map_err(bad)?),
                end - at,
            )
        } else if c.is_ascii_alphabetic() || c == '_' {
            let in_name = |c: &&char| c.is_ascii_alphanumeric() || matches!(c, '_' | '.');
            (TokenKind::Name, rest.iter().take_while(in_name).count())
        } else {
            let here = |sign: &&&str| sign.chars().eq(rest.iter().copied().take(sign.len()));
            let unknown = || {
                let message = format!("`{c}` has no meaning here");
                token(TokenKind::End, at, at + 1).fault(message, String::new())
            };
            let sign = SIGNS.iter().find(here).ok_or_else(unknown)?;
            (TokenKind::Sign, sign.len())
        };
        let next = token(kind, at, at + width);
        if found.len() == MAX_TOKENS {
            return Err(next.fault(
                format!("the expression has more than {MAX_TOKENS} words, numbers and signs"),
                "compute a part of it in a row of its own".to_owned(),
            ));
        }
        found.push(next);
        at += width;
    }
    found.push(token(TokenKind::End, at, at));
    Ok(found)
}

/// The index after a number: digits, points within them, an exponent.
fn number_end(chars: &[char], mut at: usize) -> usize {
    let digit = |at: usize| chars.get(at).is_some_and(char::is_ascii_digit);
    while digit(at) || (chars.get(at) == Some(&'.') && digit(at + 1)) {
        at += 1;
    }
    if matches!(chars.get(at), Some('e' | 'E')) {
        let signed = matches!(chars.get(at + 1), Some('+' | '-'));
        let first = at + 1 + usize::from(signed);
        if digit(first) {
            at = first
                + chars[first..]
                    .iter()
                    .take_while(|c| c.is_ascii_digit())
                    .count();
        }
    }
    at
}
