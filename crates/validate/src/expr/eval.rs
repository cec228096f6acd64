//! Expressions to numbers, ranges and truths.

use std::rc::Rc;

use super::functions::{Compute, Form, Gives, truth};
use super::reduce::{Point, Points, Table, least, most, short};
use super::{Expr, Order, Reduce};

/// Most evaluations that the rows of a command, or the observations of one evaluation of a fit, may take together; the shipped rows take less
/// than a third. One is about the work of a sum of two numbers: each part of an expression is one, each row that is looked at is one, finding
/// a table or a key is eight, sorting rows is n log2 n. Loops and reductions within each other multiply.
pub const MAX_EVALUATIONS: u64 = 100_000_000;
/// Evaluations that finding a table or a key counts as.
const LOOKING_UP: u64 = 8;
/// Most bytes of the numbers behind a truth, to which more are not added.
const MAX_BEHIND: usize = 4000;

/// Source of the numbers.
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

    /// Takes so many evaluations, of a part of an expression or of a row, from those that are left.
    ///
    /// # Errors
    /// None are left.
    fn spend(&self, evaluations: u64) -> Result<(), String>;

    /// Records rows of a source that would count but for gross slip.
    fn left_out(&self, rows: usize);

    /// Records rows that count although they lie outside the validity of a model.
    fn outside(&self, rows: usize);
}

/// A computed result.
#[derive(Clone, Debug, PartialEq)]
pub enum Computed {
    /// One number.
    Number(f64),
    /// From the smallest to the largest.
    Range(f64, f64),
    /// True if an order or sign holds, and the numbers behind it.
    Truth(bool, String),
}

/// Context of an evaluation: the row of the innermost table, the variables of the loops.
struct Context<'a> {
    tables: &'a dyn Tables,
    row: Option<(&'a Table, usize)>,
    variables: Vec<f64>,
    /// True while rows at gross slip are recorded: once, not again for the numbers behind a truth.
    recording: bool,
}

/// Computes an expression.
///
/// # Errors
/// A sentence: no such row, no number.
pub fn compute(expr: &Expr, tables: &dyn Tables) -> Result<Computed, String> {
    let mut context = Context {
        tables,
        row: None,
        variables: Vec::new(),
        recording: true,
    };
    match expr.gives() {
        Gives::Number => Ok(Computed::Number(finite(context.eval(expr)?)?)),
        Gives::Truth => {
            let holds = context.eval(expr)? > 0.5;
            context.recording = false;
            let mut list = Listed::default();
            context.behind(expr, &mut list);
            Ok(Computed::Truth(holds, list.text))
        }
        Gives::Range => {
            let (low, high) = match expr {
                Expr::Loop(_, list, body) => ends(context.looped(list, body)?.into_iter()),
                Expr::Reduce(r) => {
                    let points = context.points(r)?;
                    (points.min(), points.max())
                }
                _ => (f64::NAN, f64::NAN),
            };
            Ok(Computed::Range(finite(low)?, finite(high)?))
        }
    }
}

/// Computes a number from one row of a table; reductions and keys have no number there.
///
/// # Errors
/// As [`compute`].
pub fn compute_row(expr: &Expr, table: &Table, row: usize) -> Result<f64, String> {
    let mut context = Context {
        tables: &OneRow,
        row: Some((table, row)),
        variables: Vec::new(),
        recording: false,
    };
    finite(context.eval(expr)?)
}

/// No table but the row itself.
struct OneRow;

impl Tables for OneRow {
    fn table(&self, _: usize, _: bool) -> Result<Rc<Table>, String> {
        Err("there is no source".to_owned())
    }

    fn key(&self, _: Option<usize>, path: &str, _: Option<usize>) -> Result<f64, String> {
        Err(format!("the key {path} is not known here"))
    }

    /// An expression of one row has as many parts as its text.
    fn spend(&self, _: u64) -> Result<(), String> {
        Ok(())
    }

    fn left_out(&self, _: usize) {}

    fn outside(&self, _: usize) {}
}

fn finite(x: f64) -> Result<f64, String> {
    let finite = x.is_finite().then_some(x);
    finite.ok_or_else(|| "the result is not a finite number".to_owned())
}

fn ends(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let both = (f64::INFINITY, f64::NEG_INFINITY);
    values.fold(both, |(low, high), x| (least(x, low), most(x, high)))
}

impl Context<'_> {
    /// The number of an expression; 1 and 0 for yes and no.
    fn eval(&mut self, expr: &Expr) -> Result<f64, String> {
        self.tables.spend(1)?;
        Ok(match expr {
            Expr::Number(x) => *x,
            Expr::Column(k) => self
                .row
                .map_or(f64::NAN, |(table, row)| table.column(*k)[row]),
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
            Expr::Not(inner) => truth(self.eval(inner)? <= 0.5),
            Expr::Compare(list, orders) => self.compare(list, orders)?,
            Expr::And(list) => self.both(list, true)?,
            Expr::Or(list) => self.both(list, false)?,
            Expr::Call(function, list) => {
                let first = self.eval(&list[0])?;
                match function.compute {
                    Compute::One(of) => of(first),
                    Compute::Several(of) => (list[1..].iter())
                        .try_fold(first, |so_far, next| {
                            Ok::<f64, String>(of(so_far, self.eval(next)?))
                        })?,
                }
            }
            Expr::Reduce(r) => {
                let points = self.points(r)?;
                self.tables.spend(r.of.form.sorting(points.0.len()))?;
                (r.of.compute)(points)?
            }
            Expr::Loop(_, list, body) => truth(self.looped(list, body)?.iter().all(|x| *x > 0.5)),
            Expr::Key(source, path, item) => {
                self.tables.spend(LOOKING_UP)?;
                self.tables.key(*source, path, *item)?
            }
        })
    }

    fn all(&mut self, list: &[Expr]) -> Result<Vec<f64>, String> {
        list.iter().map(|part| self.eval(part)).collect()
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
        let mut before = self.eval(&list[0])?;
        let (mut is_missing, mut holds) = (before.is_nan(), true);
        for (part, order) in list[1..].iter().zip(orders) {
            let next = self.eval(part)?;
            is_missing |= next.is_nan();
            holds &= order.holds(before, next);
            before = next;
        }
        // Within a table a row without the number does not count; outside of one a missing number must not pass for a "no".
        if self.row.is_none() && is_missing {
            return Err("a number of the comparison does not exist".to_owned());
        }
        Ok(truth(holds))
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

    /// The rows that a reduction uses, checked.
    fn points(&mut self, r: &Reduce) -> Result<Points, String> {
        let table = self.tables.table(r.source, r.of.form == Form::Total)?;
        let points = self.rows(r, &table)?;
        let is_condition = r.of.form == Form::Condition;
        if points.is_empty() && !matches!(r.of.name, "count" | "any") {
            let gross = table.gross.iter().filter(|gross| **gross).count();
            let left_out = if gross > 0 {
                format!("; {gross} rows of the source are at gross slip and left out")
            } else {
                String::new()
            };
            return Err(format!("no row is left to look at{left_out}"));
        }
        if !is_condition && points.iter().any(|p| p.value.is_nan() || p.over.is_nan()) {
            return Err("a row has no number there".to_owned());
        }
        let at = r.at.as_ref().map_or(Ok(f64::NAN), |at| self.eval(at))?;
        Ok(Points(points, at))
    }

    fn rows(&mut self, r: &Reduce, table: &Table) -> Result<Vec<Point>, String> {
        self.tables.spend(LOOKING_UP)?;
        let mut found = Vec::new();
        let (mut left_out, mut outside) = (0, 0);
        let mut inner = Context {
            tables: self.tables,
            row: None,
            variables: self.variables.clone(),
            recording: self.recording,
        };
        for row in 0..table.rows() {
            inner.tables.spend(1)?;
            inner.row = Some((table, row));
            if let Some(filter) = &r.filter
                && inner.eval(filter)? <= 0.5
            {
                continue;
            }
            if table.gross.get(row) == Some(&true) {
                left_out += 1;
                continue;
            }
            outside += usize::from(table.outside.get(row) == Some(&true));
            found.push(Point {
                value: inner.eval(&r.value)?,
                over: r.over.as_ref().map_or(Ok(0.0), |over| inner.eval(over))?,
                weight: table.weight[row],
                group: inner.all(&r.by)?,
            });
        }
        if self.recording {
            self.tables.left_out(left_out);
            self.tables.outside(outside);
        }
        Ok(found)
    }

    fn text(&mut self, expr: &Expr) -> String {
        self.eval(expr).map_or_else(|_| "-".into(), short)
    }

    /// Lists the numbers behind a truth; nothing is evaluated for which there is no room.
    fn behind(&mut self, expr: &Expr, list: &mut Listed) {
        if list.is_full {
            return;
        }
        match expr {
            Expr::Compare(parts, orders) => {
                let mut text = self.text(&parts[0]);
                for (order, part) in orders.iter().zip(&parts[1..]) {
                    text += &format!(" {} {}", order.sign(), self.text(part));
                }
                list.add(&text);
            }
            Expr::And(parts) | Expr::Or(parts) => {
                parts.iter().for_each(|part| self.behind(part, list));
            }
            Expr::Not(inner) => list.within("not ", |list| self.behind(inner, list)),
            Expr::Loop(_, items, body) => {
                for item in items {
                    if list.is_full {
                        break;
                    }
                    let Ok(value) = self.eval(item) else { continue };
                    self.variables.push(value);
                    let name = format!("{}: ", short(value));
                    list.within(&name, |list| self.behind(body, list));
                    self.variables.pop();
                }
            }
            Expr::Reduce(r) if r.of.gives == Gives::Truth => {
                let text = self.behind_rows(r);
                list.add(text.as_deref().unwrap_or("-"));
            }
            other => list.add(&self.text(other)),
        }
    }

    /// The numbers behind a truth over rows.
    fn behind_rows(&mut self, r: &Reduce) -> Result<String, String> {
        let table = self.tables.table(r.source, false)?;
        let points = Points(self.rows(r, &table)?, f64::NAN);
        let count = points.0.len();
        if r.of.form == Form::Condition {
            return Ok(format!("{} of {count} rows", points.met().count()));
        }
        let (low, high) = (short(points.min()), short(points.max()));
        Ok(format!("{low} to {high} over {count} rows"))
    }
}

/// A list in words, as long as there is room.
#[derive(Default)]
struct Listed {
    text: String,
    /// Text before the next entry.
    begin: String,
    is_full: bool,
}

impl Listed {
    /// Adds entries, the first of which begins with a word.
    fn within(&mut self, word: &str, entries: impl FnOnce(&mut Self)) {
        let outer = self.begin.len();
        self.begin += word;
        entries(self);
        self.begin.truncate(outer);
    }

    fn add(&mut self, entry: &str) {
        let is_first = self.text.is_empty();
        self.is_full = !is_first && self.text.len() + self.begin.len() + entry.len() > MAX_BEHIND;
        if !is_first {
            self.text += "; ";
        }
        if self.is_full {
            self.text += "...";
        } else {
            self.text += &self.begin;
            self.text += entry;
            self.begin.clear();
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

    /// The shortest sign.
    fn sign(self) -> &'static str {
        let own = Order::SIGNS.iter().rfind(|(_, order)| *order == self);
        own.map_or("", |(sign, _)| sign)
    }
}
