//! Names in expressions: functions, and parts of matrices.

use super::matrix::{MOST, Matrix};
use super::parser::Parser;
use super::tokens::Token;

impl Parser<'_> {
    pub(super) fn named(&mut self, name: &str, line: usize) -> Option<Matrix> {
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
