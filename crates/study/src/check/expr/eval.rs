//! Expressions to numbers, ranges and truths.

use std::rc::Rc;

use super::reduce::reduce;
use super::{Expr, Function, Gives, Order, Reduction, Table};

/// Where the numbers come from.
pub trait Tables {
    /// The table of a source, or of its totals.
    ///
    /// # Errors
    /// Why it cannot be computed.
    fn table(&self, source: usize, totals: bool) -> Result<Rc<Table>, String>;

    /// A key's value in its own unit.
    ///
    /// # Errors
    /// Why there is none.
    fn key(&self, source: Option<usize>, path: &str, item: Option<usize>) -> Result<f64, String>;

    /// Takes note of rows of a source that would count but for gross slip.
    fn left_out(&self, rows: usize);

    /// Takes note of rows that count though they lie outside the validity of a model.
    fn outside(&self, rows: usize);
}

/// A computed result.
#[derive(Clone, Debug, PartialEq)]
pub enum Computed {
    /// One number.
    Number(f64),
    /// From the smallest to the largest.
    Range(f64, f64),
    /// Whether an order or sign holds, and the numbers behind it.
    Truth(bool, String),
}

/// Where an expression is computed: the row of the table around it, the variables of the loops around it.
pub struct Here<'a> {
    pub tables: &'a dyn Tables,
    pub row: Option<(&'a Table, usize)>,
    pub variables: Vec<f64>,
    /// Whether rows at gross slip are noted; they are once, not again for the numbers behind a truth.
    pub noting: bool,
}

/// Computes an expression.
///
/// # Errors
/// A sentence: no such row, no number.
pub fn compute(expr: &Expr, tables: &dyn Tables) -> Result<Computed, String> {
    let mut here = Here {
        tables,
        row: None,
        variables: Vec::new(),
        noting: true,
    };
    match expr.gives() {
        Gives::Number => Ok(Computed::Number(finite(here.eval(expr)?)?)),
        Gives::Truth => {
            let holds = here.eval(expr)? > 0.5;
            here.noting = false;
            Ok(Computed::Truth(holds, here.behind(expr)))
        }
        Gives::Range => {
            let values = match expr {
                Expr::Loop(_, list, body) => here.looped(list, body)?,
                Expr::Reduce(r) => {
                    let mut low = r.clone();
                    low.kind = Reduction::Min;
                    let mut high = r.clone();
                    high.kind = Reduction::Max;
                    let low = here.eval(&Expr::Reduce(low))?;
                    here.noting = false;
                    vec![low, here.eval(&Expr::Reduce(high))?]
                }
                _ => Vec::new(),
            };
            let (low, high) = values
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| {
                    (least(*x, l), most(*x, h))
                });
            Ok(Computed::Range(finite(low)?, finite(high)?))
        }
    }
}

fn finite(x: f64) -> Result<f64, String> {
    if x.is_finite() {
        Ok(x)
    } else {
        Err("the result is not a finite number".to_owned())
    }
}

/// The smaller number; NaN if one is NaN.
pub fn least(a: f64, b: f64) -> f64 {
    if a.is_nan() || a < b { a } else { b }
}

/// The larger number; NaN if one is NaN.
pub fn most(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

fn truth(holds: bool) -> f64 {
    f64::from(u8::from(holds))
}

impl Here<'_> {
    /// The number of an expression; 1 and 0 for yes and no.
    pub fn eval(&mut self, expr: &Expr) -> Result<f64, String> {
        Ok(match expr {
            Expr::Number(x) => *x,
            Expr::Column(k) => match self.row {
                Some((table, row)) => table.columns[*k][row],
                None => f64::NAN,
            },
            Expr::Variable(k) => self.variables.get(*k).copied().unwrap_or(f64::NAN),
            Expr::Previous(inner) => match self.row {
                Some((table, row)) if row > 0 => {
                    let own = self.row.replace((table, row - 1));
                    let value = self.eval(inner);
                    self.row = own;
                    value?
                }
                _ => f64::NAN,
            },
            Expr::Negate(inner) => -self.eval(inner)?,
            Expr::Not(inner) => truth(self.eval(inner)? <= 0.5),
            Expr::Binary(sign, a, b) => binary(*sign, self.eval(a)?, self.eval(b)?),
            Expr::Compare(list, orders) => self.compare(list, orders)?,
            Expr::And(list) => self.both(list, true)?,
            Expr::Or(list) => self.both(list, false)?,
            Expr::Call(function, list) => {
                let values: Result<Vec<f64>, String> =
                    list.iter().map(|part| self.eval(part)).collect();
                call(*function, &values?)
            }
            Expr::Reduce(r) => reduce(self, r)?,
            Expr::Loop(_, list, body) => truth(self.looped(list, body)?.iter().all(|x| *x > 0.5)),
            Expr::Key(source, path, item) => self.tables.key(*source, path, *item)?,
        })
    }

    fn both(&mut self, list: &[Expr], all: bool) -> Result<f64, String> {
        for part in list {
            if (self.eval(part)? > 0.5) != all {
                return Ok(truth(!all));
            }
        }
        Ok(truth(all))
    }

    fn compare(&mut self, list: &[Expr], orders: &[Order]) -> Result<f64, String> {
        let values: Result<Vec<f64>, String> = list.iter().map(|part| self.eval(part)).collect();
        let values = values?;
        // Within a table a row without the number does not count; outside of one a missing number must not pass for a "no".
        if self.row.is_none() && values.iter().any(|x| x.is_nan()) {
            return Err("a number of the comparison does not exist".to_owned());
        }
        Ok(truth(
            values
                .windows(2)
                .zip(orders)
                .all(|(pair, order)| order.holds(pair[0], pair[1])),
        ))
    }

    fn looped(&mut self, list: &[Expr], body: &Expr) -> Result<Vec<f64>, String> {
        let mut found = Vec::new();
        for item in list {
            let value = self.eval(item)?;
            self.variables.push(value);
            let result = self.eval(body);
            self.variables.pop();
            found.push(result?);
        }
        Ok(found)
    }

    /// The numbers behind a truth.
    fn behind(&mut self, expr: &Expr) -> String {
        match expr {
            Expr::Compare(list, orders) => {
                let numbers: Vec<String> = list
                    .iter()
                    .map(|part| self.eval(part).map_or_else(|_| "-".into(), short))
                    .collect();
                let mut text = numbers[0].clone();
                for (order, number) in orders.iter().zip(&numbers[1..]) {
                    text += &format!(" {} {number}", order.sign());
                }
                text
            }
            Expr::And(list) | Expr::Or(list) => {
                let parts: Vec<String> = list.iter().map(|part| self.behind(part)).collect();
                parts.join("; ")
            }
            Expr::Not(inner) => format!("not {}", self.behind(inner)),
            Expr::Loop(_, list, body) => {
                let mut parts = Vec::new();
                for item in list {
                    let Ok(value) = self.eval(item) else { continue };
                    self.variables.push(value);
                    parts.push(format!("{}: {}", short(value), self.behind(body)));
                    self.variables.pop();
                }
                parts.join("; ")
            }
            Expr::Reduce(r) => super::reduce::behind(self, r),
            other => self.eval(other).map_or_else(|_| "-".into(), short),
        }
    }
}

impl Order {
    fn holds(self, a: f64, b: f64) -> bool {
        let scale = 1e-9 * most(a.abs(), b.abs());
        match self {
            Order::Less => a < b,
            Order::AtMost => a <= b + scale,
            Order::More => a > b,
            Order::AtLeast => a >= b - scale,
            Order::Equal => (a - b).abs() <= scale,
        }
    }

    fn sign(self) -> &'static str {
        match self {
            Order::Less => "<",
            Order::AtMost => "<=",
            Order::More => ">",
            Order::AtLeast => ">=",
            Order::Equal => "=",
        }
    }
}

fn binary(sign: char, a: f64, b: f64) -> f64 {
    match sign {
        '+' => a + b,
        '-' => a - b,
        '*' => a * b,
        '/' => a / b,
        _ => a.powf(b),
    }
}

fn call(function: Function, list: &[f64]) -> f64 {
    let x = list.first().copied().unwrap_or(f64::NAN);
    match function {
        Function::Abs => x.abs(),
        Function::Sqrt => x.sqrt(),
        Function::Ln => x.ln(),
        Function::Exp => x.exp(),
        Function::Sin => x.to_radians().sin(),
        Function::Cos => x.to_radians().cos(),
        Function::Tan => x.to_radians().tan(),
        Function::Min => list.iter().copied().fold(f64::INFINITY, least),
        Function::Max => list.iter().copied().fold(f64::NEG_INFINITY, most),
    }
}

/// A number with four significant figures. What is below 1e-9 is rounding in every unit of the rows and shown as 0.
#[must_use]
pub fn short(x: f64) -> String {
    let size = x.abs();
    if !x.is_finite() {
        return "-".to_owned();
    }
    if size < 1e-9 {
        return "0".to_owned();
    }
    if !(1e-3..1e6).contains(&size) {
        return format!("{x:.3e}");
    }
    let whole = if size >= 1.0 {
        size.log10().floor() as i32 + 1
    } else {
        0
    };
    let decimals = usize::try_from((4 - whole).clamp(0, 4)).unwrap_or(0);
    let text = format!("{x:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}
