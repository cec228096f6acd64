//! Operators, functions and reductions: name, form, meaning and computation, each one row.

use super::reduce::{Points, least, most};

/// Kind of the result of an expression.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gives {
    /// A number.
    Number,
    /// A smallest and a largest number.
    Range,
    /// Yes or no.
    Truth,
}

/// An operator or function of numbers.
#[derive(Debug)]
pub struct Function {
    /// Name or sign.
    pub name: &'static str,
    /// Meaning, one phrase.
    pub doc: &'static str,
    pub(super) compute: Compute,
}

/// The number of one argument, or the first argument combined with each further one.
#[derive(Debug)]
pub(super) enum Compute {
    One(fn(f64) -> f64),
    Several(fn(f64, f64) -> f64),
}

impl PartialEq for Function {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

const fn one(name: &'static str, doc: &'static str, compute: fn(f64) -> f64) -> Function {
    let compute = Compute::One(compute);
    Function { name, doc, compute }
}

const fn several(name: &'static str, doc: &'static str, compute: fn(f64, f64) -> f64) -> Function {
    let compute = Compute::Several(compute);
    Function { name, doc, compute }
}

/// Functions of numbers.
pub static FUNCTIONS: [Function; 9] = [
    one("abs", "magnitude", f64::abs),
    one("sqrt", "square root", f64::sqrt),
    one("ln", "natural logarithm", f64::ln),
    one("exp", "exponential", f64::exp),
    one("sin", "sine of degrees", |x| x.to_radians().sin()),
    one("cos", "cosine of degrees", |x| x.to_radians().cos()),
    one("tan", "tangent of degrees", |x| x.to_radians().tan()),
    several("min", "smallest argument", least),
    several("max", "largest argument", most),
];

/// Operators between two numbers, those that bind least first; equal ones from left to right.
pub(super) static OPERATORS: [&[Function]; 3] = [
    &[
        several("+", "sum", |a, b| a + b),
        several("-", "difference", |a, b| a - b),
    ],
    &[
        several("*", "product", |a, b| a * b),
        several("/", "quotient", |a, b| a / b),
    ],
    &[several("^", "power", f64::powf)],
];

/// The sign before a power.
pub(super) static NEGATIVE: Function = one("-", "negative", |x| -x);

/// Form of a reduction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// `VALUE`
    Value,
    /// `CONDITION`
    Condition,
    /// `VALUE over COLUMN`
    Over,
    /// `VALUE over COLUMN at NUMBER`
    OverAt,
    /// `VALUE`, of the totals of a run instead of its trace.
    Total,
}

impl Form {
    /// Evaluations that putting so many rows in order counts as; none where their order does not matter.
    pub(super) fn sorting(self, rows: usize) -> u64 {
        let comparisons = rows.checked_ilog2().map_or(0, u64::from) * rows as u64;
        match self {
            Form::Over | Form::OverAt => comparisons,
            Form::Value | Form::Condition | Form::Total => 0,
        }
    }
}

/// A reduction of the rows of a source.
#[derive(Debug)]
pub struct Reduction {
    /// Name.
    pub name: &'static str,
    /// Form.
    pub form: Form,
    /// Kind of the result; that of the value for [`Form::Total`].
    pub gives: Gives,
    /// Meaning, one phrase.
    pub doc: &'static str,
    /// The number, 1 and 0 for yes and no; of a range its width. Never called without rows, except for `count` and `any`.
    pub(super) compute: fn(Points) -> Result<f64, String>,
}

impl PartialEq for Reduction {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

macro_rules! reductions {
    ($($name:literal $form:ident $gives:ident $doc:literal $compute:expr;)*) => {
        /// Reductions.
        pub static REDUCTIONS: &[Reduction] = &[$(Reduction {
            name: $name,
            form: Form::$form,
            gives: Gives::$gives,
            doc: $doc,
            compute: $compute,
        }),*];
    };
}

reductions! {
    "min" Value Number "smallest value" |p| Ok(p.min());
    "max" Value Number "largest value" |p| Ok(p.max());
    "range" Value Range "smallest and largest value" |p| Ok(p.max() - p.min());
    "spread" Value Number "largest minus smallest value" |p| Ok(p.max() - p.min());
    "mean" Value Number "weighted mean" |p| Ok(p.weighted_sum() / p.weight());
    "sum" Value Number "sum of value times weight" |p| Ok(p.weighted_sum());
    "first" Value Number "value of the first row" |p| Ok(p.0[0].value);
    "last" Value Number "value of the last row" |p| Ok(p.0[p.0.len() - 1].value);
    "one" Value Number "value of the only row" |p| p.only();
    "count" Condition Number "rows that meet the condition" |p| Ok(p.met().count() as f64);
    "share" Condition Number "weight of the rows that meet the condition over the weight of all rows"
        |p| Ok(p.met().map(|p| p.weight).sum::<f64>() / p.weight());
    "all" Condition Truth "true if every row meets the condition" |p| Ok(truth(p.met().count() == p.0.len()));
    "any" Condition Truth "true if some row meets the condition" |p| Ok(truth(p.met().next().is_some()));
    "slope" Over Number "slope of the regression line over another column" |p| Ok(p.regression()?.0);
    "r2" Over Number "square of the correlation with another column" |p| Ok(p.regression()?.1);
    "rising" Over Truth "true if the value rises with another column, in every group" |p| p.monotone(1.0).map(truth);
    "falling" Over Truth "true if the value falls with another column, in every group" |p| p.monotone(-1.0).map(truth);
    "interp" OverAt Number "value interpolated where another column has a value" Points::interp;
    "cross" OverAt Number "place in another column where the value first crosses a level" Points::cross;
    "total" Total Number "value of the totals of a run" |p| p.only();
}

/// 1 for true, 0 for false.
pub(crate) fn truth(holds: bool) -> f64 {
    f64::from(u8::from(holds))
}
