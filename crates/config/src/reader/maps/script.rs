//! Tables of numbers in a MATLAB script, as ADVISOR and the engine maps of the EPA have them.
//!
//! Read are assignments of numbers, matrices, ranges, sums and products of them, and the functions that such files use. Bodies of `if`, `for` and other
//! blocks are passed over, and a name whose value cannot be found has none.

use std::collections::HashMap;

/// Most values of one matrix, and most nested brackets: a script is text of others.
const MOST: usize = 1_000_000;
const DEEPEST: usize = 50;

/// A matrix with the line of the file in which each row is written.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Matrix {
    pub rows: usize,
    pub columns: usize,
    /// Row by row.
    pub values: Vec<f64>,
    pub lines: Vec<usize>,
}

impl Matrix {
    fn number(x: f64, line: usize) -> Matrix {
        Matrix {
            rows: 1,
            columns: 1,
            values: vec![x],
            lines: vec![line],
        }
    }

    /// The value at a row and a column.
    pub fn at(&self, row: usize, column: usize) -> f64 {
        self.values[row * self.columns + column]
    }

    /// The values of a vector.
    pub fn vector(&self) -> Option<&[f64]> {
        (self.rows == 1 || self.columns == 1).then_some(&self.values)
    }

    pub fn transposed(&self) -> Matrix {
        let (rows, columns) = (self.columns, self.rows);
        let at = |k: usize| self.at(k % columns, k / columns);
        let line = self.lines.first().copied().unwrap_or_default();
        Matrix {
            rows,
            columns,
            values: (0..rows * columns).map(at).collect(),
            lines: vec![line; rows],
        }
    }

    fn scalar(&self) -> Option<f64> {
        (self.values.len() == 1).then(|| self.values[0])
    }

    fn map(self, of: impl Fn(f64) -> f64) -> Matrix {
        Matrix {
            values: self.values.into_iter().map(of).collect(),
            ..self
        }
    }

    /// Two matrices value by value; a number goes with each value of the other one.
    fn zip(self, other: Matrix, of: impl Fn(f64, f64) -> f64) -> Option<Matrix> {
        match (self.scalar(), other.scalar()) {
            (_, Some(b)) => Some(self.map(|a| of(a, b))),
            (Some(a), _) => Some(other.map(|b| of(a, b))),
            _ if (self.rows, self.columns) == (other.rows, other.columns) => {
                let values = self.values.iter().zip(&other.values);
                let values = values.map(|(a, b)| of(*a, *b)).collect();
                Some(Matrix { values, ..self })
            }
            _ => None,
        }
    }

    /// The product of linear algebra.
    fn times(self, other: Matrix) -> Option<Matrix> {
        if self.scalar().is_some() || other.scalar().is_some() {
            return self.zip(other, |a, b| a * b);
        }
        if self.columns != other.rows || self.rows * other.columns > MOST {
            return None;
        }
        let (rows, columns) = (self.rows, other.columns);
        let at = |k: usize| {
            let (i, j) = (k / columns, k % columns);
            (0..self.columns)
                .map(|n| self.at(i, n) * other.at(n, j))
                .sum()
        };
        Some(Matrix {
            values: (0..rows * columns).map(at).collect(),
            rows,
            columns,
            lines: self.lines,
        })
    }
}

/// The values of a script.
#[derive(Debug, Default)]
pub(super) struct Script {
    values: HashMap<String, Matrix>,
    /// Line of the last assignment of each name that has no value.
    unread: HashMap<String, usize>,
    /// Line of an assignment of a name in a block.
    in_blocks: HashMap<String, usize>,
}

impl Script {
    /// Reads a script.
    pub fn new(text: &str) -> Script {
        let mut script = Script::default();
        let mut depth = 0usize;
        for statement in statements(text) {
            let first = statement.tokens.first().map(|(token, _)| token);
            if let Some(Token::Name(word)) = first {
                match word.as_str() {
                    "if" | "for" | "while" | "switch" | "try" | "function" | "parfor" => {
                        // A function of a file without `end` has the rest as its body.
                        depth += usize::from(word != "function");
                        let ends =
                            |(token, _): &(Token, usize)| *token == Token::Name("end".to_owned());
                        depth -= usize::from(
                            depth > 0
                                && statement.tokens.iter().skip(1).any(ends)
                                && word != "function",
                        );
                        continue;
                    }
                    "end" => {
                        depth = depth.saturating_sub(1);
                        continue;
                    }
                    _ => {}
                }
            }
            match (depth, statement.tokens.as_slice()) {
                (0, _) => script.run(&statement),
                (_, [(Token::Name(name), line), rest @ ..])
                    if rest.iter().any(|(token, _)| *token == Token::Sign('=')) =>
                {
                    script.in_blocks.insert(name.clone(), *line);
                }
                _ => {}
            }
        }
        script
    }

    /// The value of a name; with a `*` in front that of any name which ends so.
    pub fn find(&self, name: &str) -> Option<(&str, &Matrix)> {
        let end = name.strip_prefix('*');
        let mut found: Vec<(&String, &Matrix)> = self
            .values
            .iter()
            .filter(|(own, _)| match end {
                Some(end) => own.ends_with(end),
                None => *own == name,
            })
            .collect();
        found.sort_by_key(|(own, _)| *own);
        let (own, matrix) = found.first()?;
        Some((own.as_str(), matrix))
    }

    /// Line of a block in which a name gets another value, which is passed over.
    pub fn in_block(&self, name: &str) -> Option<usize> {
        self.in_blocks.get(name).copied()
    }

    /// Line at which a name gets a value that cannot be found.
    pub fn unread(&self, name: &str) -> Option<usize> {
        self.unread.get(name).copied()
    }

    /// The value of an expression of the script's names.
    pub fn value(&self, text: &str) -> Option<Matrix> {
        let statement = statements(text).into_iter().next()?;
        let mut parser = Parser::new(self, &statement.tokens);
        let value = parser.sum()?;
        parser.is_at_end().then_some(value)
    }

    fn run(&mut self, statement: &Statement) {
        let tokens = &statement.tokens;
        let Some(equals) = tokens
            .iter()
            .position(|(token, _)| *token == Token::Sign('='))
        else {
            return;
        };
        let (left, right) = (&tokens[..equals], &tokens[equals + 1..]);
        let line = tokens.first().map_or(0, |(_, line)| *line);
        let name_of = |tokens: &[(Token, usize)]| match tokens {
            [(Token::Name(name), _)] => Some(name.clone()),
            _ => None,
        };
        if let Some(name) = name_of(left) {
            let mut parser = Parser::new(self, right);
            let value = parser.sum().filter(|_| parser.is_at_end());
            match value {
                Some(value) => {
                    self.unread.remove(&name);
                    self.values.insert(name, value);
                }
                None => {
                    self.values.remove(&name);
                    self.unread.insert(name, line);
                }
            }
            return;
        }
        let names: Vec<&String> = left
            .iter()
            .filter_map(|(token, _)| match token {
                Token::Name(name) => Some(name),
                _ => None,
            })
            .collect();
        let is_call = matches!(right, [(Token::Name(word), _), ..] if word == "meshgrid");
        if let ([x, y], true) = (names.as_slice(), is_call) {
            let (x, y) = ((*x).clone(), (*y).clone());
            let mut parser = Parser::new(self, &right[1..]);
            if let Some([across, down]) = parser
                .arguments()
                .and_then(|all| <[Matrix; 2]>::try_from(all).ok())
            {
                let (columns, rows) = (across.values.len(), down.values.len());
                if rows * columns > MOST {
                    return;
                }
                let grid = |of: &dyn Fn(usize) -> f64| Matrix {
                    rows,
                    columns,
                    values: (0..rows * columns).map(of).collect(),
                    lines: vec![line; rows],
                };
                self.values.insert(x, grid(&|k| across.values[k % columns]));
                self.values.insert(y, grid(&|k| down.values[k / columns]));
                return;
            }
        }
        // A part of a matrix, or several values: what they were is not known any more.
        for name in left.iter().take(1).filter_map(|(token, _)| match token {
            Token::Name(name) => Some(name.clone()),
            _ => None,
        }) {
            self.values.remove(&name);
            self.unread.insert(name, line);
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
enum Token {
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
struct Statement {
    tokens: Vec<(Token, usize)>,
}

/// Splits a script into statements.
fn statements(text: &str) -> Vec<Statement> {
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

struct Parser<'s> {
    script: &'s Script,
    tokens: &'s [(Token, usize)],
    at: usize,
    depth: usize,
}

impl<'s> Parser<'s> {
    fn new(script: &'s Script, tokens: &'s [(Token, usize)]) -> Self {
        Parser {
            script,
            tokens,
            at: 0,
            depth: 0,
        }
    }

    fn peek(&self) -> Option<&'s Token> {
        self.tokens.get(self.at).map(|(token, _)| token)
    }

    fn line(&self) -> usize {
        let here = self.tokens.get(self.at).or_else(|| self.tokens.last());
        here.map_or(0, |(_, line)| *line)
    }

    fn is_at_end(&self) -> bool {
        self.at == self.tokens.len()
    }

    fn takes(&mut self, token: &Token) -> bool {
        let is = self.peek() == Some(token);
        self.at += usize::from(is);
        is
    }

    /// Sums, and ranges of them.
    fn sum(&mut self) -> Option<Matrix> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return None;
        }
        let first = self.added()?;
        let mut ends = vec![first];
        while ends.len() < 3 && self.takes(&Token::Sign(':')) {
            ends.push(self.added()?);
        }
        self.depth -= 1;
        match ends.as_slice() {
            [_] => ends.pop(),
            all => {
                let line = all[0].lines.first().copied().unwrap_or_default();
                let ends: Option<Vec<f64>> = all.iter().map(Matrix::scalar).collect();
                let ends = ends?;
                let (from, step, to) = match ends.as_slice() {
                    [from, to] => (*from, 1.0, *to),
                    [from, step, to] => (*from, *step, *to),
                    _ => return None,
                };
                let count = ((to - from) / step * (1.0 + 1e-12) + 1e-12).floor();
                if !(0.0..MOST as f64).contains(&count) {
                    return None;
                }
                let values: Vec<f64> = (0..=count as u32)
                    .map(|k| from + f64::from(k) * step)
                    .collect();
                Some(Matrix {
                    rows: 1,
                    columns: values.len(),
                    values,
                    lines: vec![line],
                })
            }
        }
    }

    fn added(&mut self) -> Option<Matrix> {
        let mut left = self.product()?;
        loop {
            if self.takes(&Token::Sign('+')) {
                left = left.zip(self.product()?, |a, b| a + b)?;
            } else if self.takes(&Token::Sign('-')) {
                left = left.zip(self.product()?, |a, b| a - b)?;
            } else {
                return Some(left);
            }
        }
    }

    fn product(&mut self) -> Option<Matrix> {
        let mut left = self.signed()?;
        loop {
            if self.takes(&Token::Sign('*')) {
                left = left.times(self.signed()?)?;
            } else if self.takes(&Token::Sign('/')) {
                let right = self.signed()?;
                right.scalar()?;
                left = left.zip(right, |a, b| a / b)?;
            } else if self.takes(&Token::Each('*')) {
                left = left.zip(self.signed()?, |a, b| a * b)?;
            } else if self.takes(&Token::Each('/')) {
                left = left.zip(self.signed()?, |a, b| a / b)?;
            } else {
                return Some(left);
            }
        }
    }

    fn signed(&mut self) -> Option<Matrix> {
        let mut factor = 1.0;
        while let Some(Token::Sign(sign @ ('+' | '-'))) = self.peek() {
            self.at += 1;
            factor *= if *sign == '-' { -1.0 } else { 1.0 };
        }
        let value = self.power()?;
        Some(if factor < 0.0 {
            value.map(|x| -x)
        } else {
            value
        })
    }

    fn power(&mut self) -> Option<Matrix> {
        let base = self.postfix()?;
        if self.takes(&Token::Sign('^')) {
            let power = self.exponent()?.scalar()?;
            return base.scalar().map(|x| Matrix {
                values: vec![x.powf(power)],
                ..base
            });
        }
        if self.takes(&Token::Each('^')) {
            return base.zip(self.exponent()?, f64::powf);
        }
        Some(base)
    }

    fn exponent(&mut self) -> Option<Matrix> {
        let is_negative = self.takes(&Token::Sign('-'));
        let value = self.postfix()?;
        Some(if is_negative {
            value.map(|x| -x)
        } else {
            value
        })
    }

    fn postfix(&mut self) -> Option<Matrix> {
        let mut value = self.primary()?;
        while self.takes(&Token::Sign('\'')) {
            value = value.transposed();
        }
        Some(value)
    }

    fn primary(&mut self) -> Option<Matrix> {
        let line = self.line();
        let token = self.peek()?;
        self.at += 1;
        match token {
            Token::Number(x) => Some(Matrix::number(*x, line)),
            Token::Sign('(') => {
                let value = self.sum()?;
                self.takes(&Token::Sign(')')).then_some(value)
            }
            Token::Sign('[') => self.matrix(),
            Token::Name(name) => self.named(name, line),
            _ => None,
        }
    }

    fn matrix(&mut self) -> Option<Matrix> {
        let mut rows: Vec<Matrix> = Vec::new();
        let mut row: Option<Matrix> = None;
        loop {
            match self.peek()? {
                Token::Sign(']') => {
                    self.at += 1;
                    rows.extend(row);
                    return below(rows);
                }
                Token::Row => {
                    self.at += 1;
                    rows.extend(row.take());
                }
                Token::Blank | Token::Sign(',') => self.at += 1,
                _ => {
                    let next = self.sum()?;
                    row = Some(match row {
                        None => next,
                        Some(before) => side_by_side(before, &next)?,
                    });
                }
            }
        }
    }

    /// Values between round brackets.
    fn arguments(&mut self) -> Option<Vec<Matrix>> {
        if !self.takes(&Token::Sign('(')) {
            return None;
        }
        let mut all = vec![self.sum()?];
        while self.takes(&Token::Sign(',')) {
            all.push(self.sum()?);
        }
        self.takes(&Token::Sign(')')).then_some(all)
    }

    fn named(&mut self, name: &str, line: usize) -> Option<Matrix> {
        let is_call = self.peek() == Some(&Token::Sign('('));
        if let Some(known) = self.script.values.get(name) {
            if !is_call {
                return Some(known.clone());
            }
            return self.part(known);
        }
        if !is_call {
            let number = match name {
                "pi" => std::f64::consts::PI,
                "eps" => f64::EPSILON,
                "NaN" | "nan" => f64::NAN,
                "inf" | "Inf" => f64::INFINITY,
                _ => return None,
            };
            return Some(Matrix::number(number, line));
        }
        let all = self.arguments()?;
        let vector = |values: Vec<f64>| Matrix {
            rows: 1,
            columns: values.len(),
            values,
            lines: vec![line],
        };
        let filled = |x: f64, all: &[Matrix]| {
            let sizes: Vec<f64> = all.iter().flat_map(|of| of.values.clone()).collect();
            let (rows, columns) = match sizes.as_slice() {
                [n] => (*n, *n),
                [rows, columns] => (*rows, *columns),
                _ => return None,
            };
            let fits = rows >= 0.0 && columns >= 0.0 && rows * columns <= MOST as f64;
            fits.then(|| Matrix {
                rows: rows as usize,
                columns: columns as usize,
                values: vec![x; rows as usize * columns as usize],
                lines: vec![line; rows as usize],
            })
        };
        match (name, all.as_slice()) {
            ("ones", sizes) => filled(1.0, sizes),
            ("zeros", sizes) => filled(0.0, sizes),
            ("size", [of]) => Some(vector(vec![of.rows as f64, of.columns as f64])),
            ("size", [of, k]) => {
                let k = k.scalar()?;
                Some(Matrix::number(
                    if k > 1.5 { of.columns } else { of.rows } as f64,
                    line,
                ))
            }
            ("length", [of]) => Some(Matrix::number(of.rows.max(of.columns) as f64, line)),
            ("numel", [of]) => Some(Matrix::number(of.values.len() as f64, line)),
            ("max", [of]) => Some(Matrix::number(
                of.vector()?
                    .iter()
                    .copied()
                    .fold(f64::NEG_INFINITY, f64::max),
                line,
            )),
            ("min", [of]) => Some(Matrix::number(
                of.vector()?.iter().copied().fold(f64::INFINITY, f64::min),
                line,
            )),
            ("linspace", [from, to, count]) => {
                let (from, to, count) = (from.scalar()?, to.scalar()?, count.scalar()?);
                let fits = (2.0..MOST as f64).contains(&count);
                let at = |k: u32| from + (to - from) * f64::from(k) / (count - 1.0);
                fits.then(|| vector((0..count as u32).map(at).collect()))
            }
            ("abs", [_]) => all.into_iter().next().map(|of| of.map(f64::abs)),
            ("round", [_]) => all.into_iter().next().map(|of| of.map(f64::round)),
            ("double" | "single", [_]) => all.into_iter().next(),
            ("transpose", [of]) => Some(of.transposed()),
            ("flipud", [of]) => {
                let rows = (0..of.rows).rev();
                let values = rows
                    .clone()
                    .flat_map(|i| (0..of.columns).map(move |k| of.at(i, k)));
                Some(Matrix {
                    values: values.collect(),
                    lines: rows.filter_map(|i| of.lines.get(i).copied()).collect(),
                    ..of.clone()
                })
            }
            ("fliplr", [of]) => {
                let values =
                    (0..of.rows).flat_map(|i| (0..of.columns).rev().map(move |k| of.at(i, k)));
                Some(Matrix {
                    values: values.collect(),
                    ..of.clone()
                })
            }
            _ => None,
        }
    }

    /// A part of a matrix: rows and columns by numbers, ranges, `end` and `:`.
    fn part(&mut self, of: &Matrix) -> Option<Matrix> {
        self.at += 1;
        let mut all: Vec<Vec<usize>> = Vec::new();
        let count = {
            // The number of indices decides what `end` is.
            let mut depth = 1;
            let rest = &self.tokens[self.at..];
            let mut commas = 0;
            for (token, _) in rest {
                match token {
                    Token::Sign('(' | '[') => depth += 1,
                    Token::Sign(')' | ']') => depth -= 1,
                    Token::Sign(',') if depth == 1 => commas += 1,
                    _ => {}
                }
                if depth == 0 {
                    break;
                }
            }
            commas + 1
        };
        let sizes = match count {
            1 => vec![of.values.len()],
            2 => vec![of.rows, of.columns],
            _ => return None,
        };
        for (k, size) in sizes.iter().enumerate() {
            if k > 0 && !self.takes(&Token::Sign(',')) {
                return None;
            }
            all.push(self.indices(*size)?);
        }
        if !self.takes(&Token::Sign(')')) {
            return None;
        }
        match all.as_slice() {
            [one] => {
                // Column by column.
                let at = |k: &usize| of.at(k % of.rows, k / of.rows);
                let values: Vec<f64> = one.iter().map(at).collect();
                let line = of.lines.first().copied().unwrap_or_default();
                Some(match of.columns {
                    1 => Matrix {
                        rows: values.len(),
                        columns: 1,
                        lines: vec![line; values.len()],
                        values,
                    },
                    _ => Matrix {
                        rows: 1,
                        columns: values.len(),
                        lines: vec![line],
                        values,
                    },
                })
            }
            [rows, columns] => Some(Matrix {
                rows: rows.len(),
                columns: columns.len(),
                values: rows
                    .iter()
                    .flat_map(|i| columns.iter().map(|k| of.at(*i, *k)))
                    .collect(),
                lines: rows
                    .iter()
                    .filter_map(|i| of.lines.get(*i).copied())
                    .collect(),
            }),
            _ => None,
        }
    }

    fn indices(&mut self, size: usize) -> Option<Vec<usize>> {
        if self.peek() == Some(&Token::Sign(':')) {
            self.at += 1;
            return Some((0..size).collect());
        }
        let from = self.added_or_end(size)?;
        let list = if self.takes(&Token::Sign(':')) {
            let to = self.added_or_end(size)?;
            let (from, to) = (from.scalar()?, to.scalar()?);
            if !(from >= 1.0 && to <= size as f64) {
                return None;
            }
            (from as usize..=to as usize).map(|k| k as f64).collect()
        } else {
            from.values
        };
        let index =
            |x: &f64| (*x >= 1.0 && *x <= size as f64 && x.fract() == 0.0).then(|| *x as usize - 1);
        list.iter().map(index).collect()
    }

    fn added_or_end(&mut self, size: usize) -> Option<Matrix> {
        if self.takes(&Token::Name("end".to_owned())) {
            let mut last = size as f64;
            if self.takes(&Token::Sign('-')) {
                last -= self.product()?.scalar()?;
            }
            return Some(Matrix::number(last, self.line()));
        }
        self.added()
    }
}

fn side_by_side(left: Matrix, right: &Matrix) -> Option<Matrix> {
    if left.rows != right.rows || left.values.len() + right.values.len() > MOST {
        return None;
    }
    let columns = left.columns + right.columns;
    let row = |i: usize| {
        let [a, b] = [(&left, left.columns), (right, right.columns)]
            .map(|(of, n)| &of.values[i * n..(i + 1) * n]);
        a.iter().chain(b).copied().collect::<Vec<f64>>()
    };
    let values = (0..left.rows).flat_map(row).collect();
    Some(Matrix {
        columns,
        values,
        ..left
    })
}

fn below(rows: Vec<Matrix>) -> Option<Matrix> {
    let columns = rows.first()?.columns;
    let size: usize = rows.iter().map(|row| row.values.len()).sum();
    if size > MOST || rows.iter().any(|row| row.columns != columns) {
        return None;
    }
    Some(Matrix {
        rows: rows.iter().map(|row| row.rows).sum(),
        columns,
        lines: rows.iter().flat_map(|row| row.lines.clone()).collect(),
        values: rows.into_iter().flat_map(|row| row.values).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: by hand.
    #[test]
    fn expressions_have_their_values() {
        let script = Script::new(
            "% a comment\na=[1 2\n3 -4]; b = 2*pi/60;\nc=[0.5:0.5:2]*1000; % rpm\nd=a';\ne=[1 - 2, 3 -4 ...\n 5];\nf=a(1,:)/2; g=[a;5 6]; h='it''s';\n\
             [T,w]=meshgrid([1 2 3],[10 20]);\nk=T.*w/10;\nl=a(:,2)';\nm.n_Nm=[1,2;3,4];\nif 0\na=7;\nend\no=ones(2,3)*4;\np=unknown(3);\nq=flipud(a);\nr=c(end);\n",
        );
        let values = |name: &str| script.find(name).map(|(_, found)| found.values.clone());
        assert_eq!(values("a"), Some(vec![1.0, 2.0, 3.0, -4.0]));
        assert_eq!(
            script.find("a").map(|(_, a)| a.lines.clone()),
            Some(vec![2, 3])
        );
        assert_eq!(values("b"), Some(vec![std::f64::consts::PI * 2.0 / 60.0]));
        assert_eq!(values("c"), Some(vec![500.0, 1000.0, 1500.0, 2000.0]));
        assert_eq!(values("d"), Some(vec![1.0, 3.0, 2.0, -4.0]));
        assert_eq!(values("e"), Some(vec![-1.0, 3.0, -4.0, 5.0]));
        assert_eq!(values("f"), Some(vec![0.5, 1.0]));
        assert_eq!(values("g"), Some(vec![1.0, 2.0, 3.0, -4.0, 5.0, 6.0]));
        assert_eq!(values("k"), Some(vec![1.0, 2.0, 3.0, 2.0, 4.0, 6.0]));
        assert_eq!(values("l"), Some(vec![2.0, -4.0]));
        assert_eq!(values("*.n_Nm"), Some(vec![1.0, 2.0, 3.0, 4.0]));
        assert_eq!(values("o"), Some(vec![4.0; 6]));
        assert_eq!(values("q"), Some(vec![3.0, -4.0, 1.0, 2.0]));
        assert_eq!(values("r"), Some(vec![2000.0]));
        assert_eq!((values("p"), script.unread("p")), (None, Some(17)));
        assert_eq!(
            script.value("a/2").map(|a| a.values),
            Some(vec![0.5, 1.0, 1.5, -2.0])
        );
    }
}
