//! Matrices of numbers.

/// Most values of one matrix: a script is text of others.
pub(super) const MOST: usize = 1_000_000;

/// A matrix with the line of the file in which each row is written.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Matrix {
    pub rows: usize,
    pub columns: usize,
    /// Row by row.
    pub values: Vec<f64>,
    pub lines: Vec<usize>,
}

impl Matrix {
    pub(super) fn number(x: f64, line: usize) -> Matrix {
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

    pub(super) fn scalar(&self) -> Option<f64> {
        (self.values.len() == 1).then(|| self.values[0])
    }

    pub(super) fn map(self, of: impl Fn(f64) -> f64) -> Matrix {
        Matrix {
            values: self.values.into_iter().map(of).collect(),
            ..self
        }
    }

    /// Two matrices value by value; a number goes with each value of the other one.
    pub(super) fn zip(self, other: Matrix, of: impl Fn(f64, f64) -> f64) -> Option<Matrix> {
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
    pub(super) fn times(self, other: Matrix) -> Option<Matrix> {
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

pub(super) fn side_by_side(left: Matrix, right: &Matrix) -> Option<Matrix> {
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

pub(super) fn below(rows: Vec<Matrix>) -> Option<Matrix> {
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
