//! Statements of a script in tokens.

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token {
    Number(f64),
    Name(String),
    /// A sign; those with a point in front, `.*`, are in [`Token::Each`].
    Sign(char),
    Each(char),
    /// End of a row in a matrix.
    Row,
    /// Blanks between two values of a matrix.
    Blank,
    /// Text in quotes.
    Text,
}

/// Tokens with their lines.
pub(super) struct Statement {
    pub(super) tokens: Vec<(Token, usize)>,
}

/// Splits a script into statements.
pub(super) fn statements(text: &str) -> Vec<Statement> {
    let mut all = Vec::new();
    let mut tokens: Vec<(Token, usize)> = Vec::new();
    let mut brackets: Vec<char> = Vec::new();
    let mut in_comment = false;
    for (number, raw) in (1..).zip(text.lines()) {
        match raw.trim() {
            "%{" => in_comment = true,
            "%}" => {
                in_comment = false;
                continue;
            }
            _ => {}
        }
        if in_comment {
            continue;
        }
        let continues = line(raw, number, &mut tokens, &mut brackets, &mut all);
        if continues {
            continue;
        }
        match brackets.last() {
            Some('[' | '{') => tokens.push((Token::Row, number)),
            Some(_) => {}
            None => finish(&mut tokens, &mut all),
        }
    }
    finish(&mut tokens, &mut all);
    all
}

fn finish(tokens: &mut Vec<(Token, usize)>, all: &mut Vec<Statement>) {
    let tokens = std::mem::take(tokens);
    if !tokens.is_empty() {
        all.push(Statement { tokens });
    }
}

/// Reads a line; true if the next one continues it.
fn line(
    raw: &str,
    number: usize,
    tokens: &mut Vec<(Token, usize)>,
    brackets: &mut Vec<char>,
    all: &mut Vec<Statement>,
) -> bool {
    let text: Vec<char> = raw.chars().collect();
    let mut at = 0;
    let mut blank = false;
    while let Some(&c) = text.get(at) {
        let rest = &text[at..];
        if c.is_whitespace() {
            blank = true;
            at += 1;
            continue;
        }
        if c == '%' || c == '#' {
            return false;
        }
        if rest.starts_with(&['.', '.', '.']) {
            return true;
        }
        let in_matrix = matches!(brackets.last(), Some('[' | '{'));
        let after_value = matches!(
            tokens.last().map(|(token, _)| token),
            Some(
                Token::Number(_)
                    | Token::Name(_)
                    | Token::Text
                    | Token::Sign(')' | ']' | '}' | '\'')
            )
        );
        if in_matrix && blank && after_value && starts_value(&text, at) {
            tokens.push((Token::Blank, number));
        }
        let is_transpose = c == '\'' && after_value && !(in_matrix && blank);
        blank = false;
        if c.is_ascii_digit() || c == '.' && text.get(at + 1).is_some_and(char::is_ascii_digit) {
            let end = at + number_len(rest);
            let word: String = text[at..end].iter().collect();
            match word.parse() {
                Ok(x) => tokens.push((Token::Number(x), number)),
                Err(_) => tokens.push((Token::Text, number)),
            }
            at = end;
        } else if c.is_alphabetic() || c == '_' {
            let is_part = |c: &char| c.is_alphanumeric() || *c == '_';
            let mut end = at;
            while text.get(end).is_some_and(is_part)
                || text.get(end) == Some(&'.')
                    && text.get(end + 1).is_some_and(|c| c.is_alphabetic())
            {
                end += 1;
            }
            tokens.push((Token::Name(text[at..end].iter().collect()), number));
            at = end;
        } else if (c == '\'' && !is_transpose) || c == '"' {
            let close = text[at + 1..].iter().position(|other| *other == c);
            tokens.push((Token::Text, number));
            at = close.map_or(text.len(), |n| at + n + 2);
        } else if c == '.'
            && text
                .get(at + 1)
                .is_some_and(|next| "*/\\^'".contains(*next))
        {
            let sign = text[at + 1];
            let token = match sign {
                '\'' => Token::Sign('\''),
                sign => Token::Each(sign),
            };
            tokens.push((token, number));
            at += 2;
        } else {
            match c {
                '(' | '[' | '{' => brackets.push(c),
                ')' | ']' | '}' => {
                    while matches!(tokens.last(), Some((Token::Row | Token::Blank, _))) {
                        tokens.pop();
                    }
                    brackets.pop();
                }
                ';' if in_matrix => {
                    tokens.push((Token::Row, number));
                    at += 1;
                    continue;
                }
                ';' | ',' if brackets.is_empty() => {
                    finish(tokens, all);
                    at += 1;
                    continue;
                }
                _ => {}
            }
            // `==` is no assignment.
            if c == '=' && text.get(at + 1) == Some(&'=')
                || "~<>".contains(c) && text.get(at + 1) == Some(&'=')
            {
                tokens.push((Token::Text, number));
                at += 2;
                continue;
            }
            tokens.push((Token::Sign(c), number));
            at += 1;
        }
    }
    false
}

/// True where a value of a matrix begins, behind a blank.
fn starts_value(text: &[char], at: usize) -> bool {
    let next = text.get(at + 1);
    match text[at] {
        '(' | '[' | '{' | '\'' | '_' => true,
        '.' => next.is_some_and(char::is_ascii_digit),
        // `1 - 2` is one value, `1 -2` are two.
        '+' | '-' => next.is_some_and(|next| !next.is_whitespace()),
        c => c.is_alphanumeric(),
    }
}

fn number_len(text: &[char]) -> usize {
    let digits = |from: usize| {
        text[from..]
            .iter()
            .take_while(|c| c.is_ascii_digit())
            .count()
    };
    let mut end = digits(0);
    // The point of `2.*x` belongs to the sign.
    let is_sign = |at: usize| text.get(at + 1).is_some_and(|c| "*/\\^'".contains(*c));
    if text.get(end) == Some(&'.') && !is_sign(end) {
        end += 1;
        end += digits(end);
    }
    if matches!(text.get(end), Some('e' | 'E' | 'd' | 'D')) {
        let sign = usize::from(matches!(text.get(end + 1), Some('+' | '-')));
        let count = if text.len() > end + 1 + sign {
            digits(end + 1 + sign)
        } else {
            0
        };
        if count > 0 {
            end += 1 + sign + count;
        }
    }
    end
}
