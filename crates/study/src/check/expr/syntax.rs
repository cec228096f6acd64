//! Parsed expressions.

pub use super::functions::Gives;
use super::functions::{Form, Function, Reduction};

/// An error in a text: place, message, remedy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// First character, counted from 0.
    pub at: usize,
    /// Number of characters.
    pub width: usize,
    /// The offending word.
    pub word: String,
    /// What is wrong.
    pub message: String,
    /// What to do.
    pub hint: String,
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

/// Evaluation of a body for each of several numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loop {
    /// True if the body holds for every number.
    Each,
    /// Smallest and largest value of the body.
    Span,
}

/// A reduction with its parts.
#[derive(Clone, Debug, PartialEq)]
pub struct Reduce {
    /// The reduction.
    pub of: &'static Reduction,
    /// Index of the source.
    pub source: usize,
    /// Value or condition of a row.
    pub value: Expr,
    /// The other column of [`Form::Over`] and [`Form::OverAt`].
    pub over: Option<Expr>,
    /// The place or level of [`Form::OverAt`].
    pub at: Option<Expr>,
    /// Condition of the rows that count.
    pub filter: Option<Expr>,
    /// Columns whose values divide the rows into groups.
    pub by: Vec<Expr>,
}

/// A parsed expression.
#[derive(Clone, Debug, PartialEq)]
pub enum Expr {
    /// A number.
    Number(f64),
    /// A column of the innermost reduction.
    Column(usize),
    /// A variable of a loop, counted from the outermost.
    Variable(usize),
    /// The expression in the previous row.
    Previous(Box<Expr>),
    /// Minus.
    Negate(Box<Expr>),
    /// Not.
    Not(Box<Expr>),
    /// `+`, `-`, `*`, `/` or `^`.
    Binary(char, Box<Expr>, Box<Expr>),
    /// A chain of comparisons: one more operand than orders.
    Compare(Vec<Expr>, Vec<Order>),
    /// True if every part holds.
    And(Vec<Expr>),
    /// True if some part holds.
    Or(Vec<Expr>),
    /// A function.
    Call(&'static Function, Vec<Expr>),
    /// A reduction of a source.
    Reduce(Box<Reduce>),
    /// A loop over numbers.
    Loop(Loop, Vec<Expr>, Box<Expr>),
    /// A key of the vehicle or fluid of a source, or of the candidate vehicle without one; with the index of an item for a list.
    Key(Option<usize>, String, Option<usize>),
}

impl Expr {
    /// The kind of result.
    #[must_use]
    pub fn gives(&self) -> Gives {
        match self {
            Expr::Compare(..)
            | Expr::And(_)
            | Expr::Or(_)
            | Expr::Not(_)
            | Expr::Loop(Loop::Each, ..) => Gives::Truth,
            Expr::Loop(Loop::Span, ..) => Gives::Range,
            Expr::Reduce(r) if r.of.form == Form::Total => r.value.gives(),
            Expr::Reduce(r) => r.of.gives,
            _ => Gives::Number,
        }
    }

    /// The parts of the expression.
    #[must_use]
    pub fn parts(&self) -> Vec<&Expr> {
        match self {
            Expr::Number(_) | Expr::Column(_) | Expr::Variable(_) | Expr::Key(..) => Vec::new(),
            Expr::Previous(a) | Expr::Negate(a) | Expr::Not(a) => vec![a],
            Expr::Binary(_, a, b) => vec![a, b],
            Expr::Compare(list, _) | Expr::And(list) | Expr::Or(list) | Expr::Call(_, list) => {
                list.iter().collect()
            }
            Expr::Loop(_, list, body) => list.iter().chain([&**body]).collect(),
            Expr::Reduce(r) => {
                let optional = [&r.over, &r.at, &r.filter].into_iter().flatten();
                [&r.value]
                    .into_iter()
                    .chain(optional)
                    .chain(&r.by)
                    .collect()
            }
        }
    }

    /// Appends the sources of the expression; none for the candidate vehicle.
    pub fn sources(&self, found: &mut Vec<Option<usize>>) {
        match self {
            Expr::Reduce(r) => found.push(Some(r.source)),
            Expr::Key(source, ..) => found.push(*source),
            _ => {}
        }
        self.parts()
            .into_iter()
            .for_each(|part| part.sources(found));
    }
}
