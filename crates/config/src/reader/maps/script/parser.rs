//! Values of expressions.

use super::Script;
use super::matrix::{MOST, Matrix, below, side_by_side};
use super::tokens::Token;

/// Most nested brackets.
const DEEPEST: usize = 50;

pub(super) struct Parser<'s> {
    pub(super) script: &'s Script,
    pub(super) tokens: &'s [(Token, usize)],
    pub(super) at: usize,
    depth: usize,
}

impl<'s> Parser<'s> {
    pub(super) fn new(script: &'s Script, tokens: &'s [(Token, usize)]) -> Self {
        Parser {
            script,
            tokens,
            at: 0,
            depth: 0,
        }
    }

    pub(super) fn peek(&self) -> Option<&'s Token> {
        self.tokens.get(self.at).map(|(token, _)| token)
    }

    pub(super) fn line(&self) -> usize {
        let here = self.tokens.get(self.at).or_else(|| self.tokens.last());
        here.map_or(0, |(_, line)| *line)
    }

    pub(super) fn is_at_end(&self) -> bool {
        self.at == self.tokens.len()
    }

    pub(super) fn takes(&mut self, token: &Token) -> bool {
        let is = self.peek() == Some(token);
        self.at += usize::from(is);
        is
    }

    /// Sums, and ranges of them.
    pub(super) fn sum(&mut self) -> Option<Matrix> {
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

    pub(super) fn added(&mut self) -> Option<Matrix> {
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

    pub(super) fn product(&mut self) -> Option<Matrix> {
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
    pub(super) fn arguments(&mut self) -> Option<Vec<Matrix>> {
        if !self.takes(&Token::Sign('(')) {
            return None;
        }
        let mut all = vec![self.sum()?];
        while self.takes(&Token::Sign(',')) {
            all.push(self.sum()?);
        }
        self.takes(&Token::Sign(')')).then_some(all)
    }
}
