//! The expressions of the validation rows: arithmetic and comparisons over reductions of named sources.
//!
//! `docs/validation_format.md` is the user's description. A text is split into words ([`words`]), parsed against the names that exist
//! ([`parse`]) and computed over tables ([`eval`]); nothing here knows what the sources are.

mod calls;
mod eval;
mod parse;
mod reduce;
mod words;

#[cfg(test)]
mod tests;

pub use eval::{Computed, Tables, compute, short};
pub use parse::{Names, parse};

/// Something wrong in a text: where, what, and what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// First character, counted from 0.
    pub at: usize,
    /// Number of characters.
    pub width: usize,
    /// The word that is wrong.
    pub word: String,
    /// What is wrong.
    pub message: String,
    /// What to do.
    pub hint: String,
}

/// A table of numbers: one list for each column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Columns in the order of their names.
    pub columns: Vec<Vec<f64>>,
    /// Weight of each row in means, sums and shares (seconds in a run, 1 elsewhere).
    pub weight: Vec<f64>,
    /// Rows that no reduction looks at, because the belt slips grossly there; empty where there are none.
    pub gross: Vec<bool>,
    /// Rows outside the validity of a model, which count and are told; empty where nothing says so.
    pub outside: Vec<bool>,
}

/// Comparison of two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// `<`
    Less,
    /// `<=`
    AtMost,
    /// `>`
    More,
    /// `>=`
    AtLeast,
    /// `==`, to 1e-9 of the larger number.
    Equal,
}

/// Functions of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    /// Magnitude.
    Abs,
    /// Square root.
    Sqrt,
    /// Natural logarithm.
    Ln,
    /// Exponential.
    Exp,
    /// Sine of an angle in degrees.
    Sin,
    /// Cosine of an angle in degrees.
    Cos,
    /// Tangent of an angle in degrees.
    Tan,
    /// Smallest argument.
    Min,
    /// Largest argument.
    Max,
}

/// What is made of the rows of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reduction {
    /// Smallest value.
    Min,
    /// Largest value.
    Max,
    /// Smallest and largest value.
    Range,
    /// Largest minus smallest value.
    Spread,
    /// Weighted mean.
    Mean,
    /// Sum of value times weight.
    Sum,
    /// Value of the first row.
    First,
    /// Value of the last row.
    Last,
    /// Value of the only row.
    One,
    /// Rows that meet the condition.
    Count,
    /// Weight of the rows that meet the condition over the weight of all rows.
    Share,
    /// Whether every row meets the condition.
    All,
    /// Whether some row meets the condition.
    Any,
    /// Slope of the regression line over another column.
    Slope,
    /// Square of the correlation with another column.
    R2,
    /// Whether the value rises with another column, in every group.
    Rising,
    /// Whether the value falls with another column, in every group.
    Falling,
    /// Value interpolated where another column has a value.
    Interp,
    /// Place in another column where the value first crosses a level.
    Cross,
    /// The totals of a run instead of its trace.
    Total,
}

/// Goes through a list of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loop {
    /// Whether the body holds for every number.
    Each,
    /// Smallest and largest value of the body.
    Span,
}

/// A reduction with its parts.
#[derive(Clone, Debug, PartialEq)]
pub struct Reduce {
    /// What is made of the rows.
    pub kind: Reduction,
    /// Index of the source.
    pub source: usize,
    /// Value or condition of a row.
    pub value: Expr,
    /// The other column of slope, r2, rising, falling, interp, cross.
    pub over: Option<Expr>,
    /// The place of interp, the level of cross.
    pub at: Option<Expr>,
    /// Rows that count.
    pub filter: Option<Expr>,
    /// Columns whose values divide the rows into groups.
    pub by: Vec<Expr>,
}

/// A parsed expression.
#[derive(Clone, Debug, PartialEq)]
pub enum Expr {
    /// A number.
    Number(f64),
    /// A column of the table around it.
    Column(usize),
    /// A variable of a loop around it, counted from the outermost.
    Variable(usize),
    /// The expression in the row before.
    Previous(Box<Expr>),
    /// Minus.
    Negate(Box<Expr>),
    /// Not.
    Not(Box<Expr>),
    /// `+`, `-`, `*`, `/` or `^`.
    Binary(char, Box<Expr>, Box<Expr>),
    /// A chain of comparisons: one more operand than orders.
    Compare(Vec<Expr>, Vec<Order>),
    /// Every part holds.
    And(Vec<Expr>),
    /// Some part holds.
    Or(Vec<Expr>),
    /// A function.
    Call(Function, Vec<Expr>),
    /// A reduction of a source.
    Reduce(Box<Reduce>),
    /// A loop over numbers.
    Loop(Loop, Vec<Expr>, Box<Expr>),
    /// A key of a source's vehicle or fluid, of the subject where none is named; an item of it for a list, counted from 0.
    Key(Option<usize>, String, Option<usize>),
}

/// What an expression gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gives {
    /// A number.
    Number,
    /// A smallest and a largest number.
    Range,
    /// Yes or no.
    Truth,
}

impl Expr {
    /// What the expression gives.
    #[must_use]
    pub fn gives(&self) -> Gives {
        match self {
            Expr::Compare(..)
            | Expr::And(_)
            | Expr::Or(_)
            | Expr::Not(_)
            | Expr::Loop(Loop::Each, ..) => Gives::Truth,
            Expr::Loop(Loop::Span, ..) => Gives::Range,
            Expr::Reduce(r) => match r.kind {
                Reduction::Range => Gives::Range,
                Reduction::All | Reduction::Any | Reduction::Rising | Reduction::Falling => {
                    Gives::Truth
                }
                Reduction::Total => r.value.gives(),
                _ => Gives::Number,
            },
            _ => Gives::Number,
        }
    }

    /// Adds the sources that the expression looks at; none stands for the subject.
    pub fn sources(&self, found: &mut Vec<Option<usize>>) {
        let all = |list: &[Expr], found: &mut Vec<Option<usize>>| {
            list.iter().for_each(|part| part.sources(found))
        };
        match self {
            Expr::Number(_) | Expr::Column(_) | Expr::Variable(_) => {}
            Expr::Previous(inner) | Expr::Negate(inner) | Expr::Not(inner) => inner.sources(found),
            Expr::Binary(_, a, b) => {
                a.sources(found);
                b.sources(found);
            }
            Expr::Compare(list, _) | Expr::And(list) | Expr::Or(list) | Expr::Call(_, list) => {
                all(list, found)
            }
            Expr::Reduce(r) => {
                found.push(Some(r.source));
                r.value.sources(found);
                [&r.over, &r.at, &r.filter]
                    .into_iter()
                    .flatten()
                    .for_each(|part| part.sources(found));
                all(&r.by, found);
            }
            Expr::Loop(_, list, body) => {
                all(list, found);
                body.sources(found);
            }
            Expr::Key(source, ..) => found.push(*source),
        }
    }
}
