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
mod syntax;

pub use eval::{Computed, Tables, compute};
pub(crate) use functions::truth;
pub use functions::{FUNCTIONS, Form, Function, Gives, REDUCTIONS, Reduction};
pub use parser::{Names, parse};
pub use reduce::{Table, short};
pub use syntax::{Expr, Fault, Loop, Order, Reduce};
