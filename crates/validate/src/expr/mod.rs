//! The expressions of the validation rows: arithmetic and comparisons over reductions of named sources.
//!
//! `docs/validation_format.md` is the user's description. A text is split into tokens (`lexer`), parsed against the known names (`parser`)
//! and computed over tables (`eval`). Operators, functions and reductions are rows of `functions`; `reduce` has the statistics. The module
//! does not depend on what the sources are.

mod eval;
mod functions;
mod lexer;
mod parser;
mod reduce;

pub use eval::{Computed, MAX_EVALUATIONS, Tables, compute, compute_row};
pub(crate) use functions::truth;
pub use functions::{FUNCTIONS, Form, Function, Gives, REDUCTIONS, Reduction};
pub use lexer::MAX_TOKENS;
pub use parser::{Names, parse};
pub use reduce::{Table, short};

/// An error in a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// First character, counted from 0.
    pub at: usize,
    /// Number of characters.
    pub width: usize,
    /// The offending word.
    pub word: String,
    /// Description of the fault.
    pub message: String,
    /// Advice; may be empty.
    pub hint: String,
}

/// Comparison of two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// `<`
    Less,
    /// `<=`, to 1e-9 of the larger number.
    AtMost,
    /// `>`
    More,
    /// `>=`, to 1e-9 of the larger number.
    AtLeast,
    /// `==`, to 1e-9 of the larger number.
    Equal,
}

impl Order {
    /// Signs, longer ones first; the last one of an order is how it is shown.
    const SIGNS: [(&'static str, Order); 6] = [
        ("<=", Order::AtMost),
        (">=", Order::AtLeast),
        ("==", Order::Equal),
        ("=", Order::Equal),
        ("<", Order::Less),
        (">", Order::More),
    ];
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
    /// Not.
    Not(Box<Expr>),
    /// A chain of comparisons: one more operand than orders.
    Compare(Vec<Expr>, Vec<Order>),
    /// True if every part holds.
    And(Vec<Expr>),
    /// True if some part holds.
    Or(Vec<Expr>),
    /// An operator or function of numbers.
    Call(&'static Function, Vec<Expr>),
    /// A reduction of a source.
    Reduce(Box<Reduce>),
    /// A loop over numbers.
    Loop(Loop, Vec<Expr>, Box<Expr>),
    /// A key of the vehicle or fluid of a source, or of the candidate vehicle without one; with the index of an item for a list.
    Key(Option<usize>, String, Option<usize>),
}

impl Reduce {
    /// Everything that is computed with, thus all but the columns of the groups.
    pub(super) fn numbers(&self) -> impl Iterator<Item = &Expr> {
        let optional = [&self.over, &self.at, &self.filter].into_iter().flatten();
        std::iter::once(&self.value).chain(optional)
    }
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
            Expr::Previous(inner) | Expr::Not(inner) => vec![inner],
            Expr::Compare(list, _) | Expr::And(list) | Expr::Or(list) | Expr::Call(_, list) => {
                list.iter().collect()
            }
            Expr::Loop(_, list, body) => list.iter().chain([&**body]).collect(),
            Expr::Reduce(r) => r.numbers().chain(&r.by).collect(),
        }
    }

    /// True if a range is part of a larger expression: nothing can be computed with it.
    pub(super) fn has_inner_range(&self) -> bool {
        let is_range = |part: &Expr| part.gives() == Gives::Range || part.has_inner_range();
        // The numbers of a loop and the columns of groups are not computed with.
        match self {
            Expr::Loop(_, _, body) => is_range(body),
            Expr::Reduce(r) => r.numbers().any(is_range),
            _ => self.parts().into_iter().any(is_range),
        }
    }

    /// The sources of the expression; none for the candidate vehicle.
    #[must_use]
    pub fn sources(&self) -> Vec<Option<usize>> {
        let own = match self {
            Expr::Reduce(r) => Some(Some(r.source)),
            Expr::Key(source, ..) => Some(*source),
            _ => None,
        };
        let parts = self.parts().into_iter().flat_map(Expr::sources);
        own.into_iter().chain(parts).collect()
    }
}
