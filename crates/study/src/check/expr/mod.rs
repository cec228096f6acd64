//! The expressions of the validation rows: arithmetic and comparisons over reductions of named sources.
//!
//! `docs/validation_format.md` is the user's description. A text is split into tokens (`lexer`), parsed against the known names (`parse`)
//! and computed over tables (`eval`). Functions and reductions are listed once, in `functions`; `reduce` has the statistics. The module
//! does not depend on what the sources are.

mod eval;
mod functions;
mod lexer;
mod parse;
mod parser;
mod reduce;
mod syntax;

pub use eval::{Computed, Tables, compute};
pub use functions::{FUNCTIONS, Form, Function, REDUCTIONS, Reduction};
pub use parse::parse;
pub use parser::Names;
pub use reduce::{Table, short};
pub use syntax::{Expr, Fault, Gives, Loop, Order, Reduce};
