//! What the book in `docs/book` takes from the program: figures, tables, and mathematics as MathML.

pub mod figures;
pub mod latex;
pub mod pictures;
mod sketch;
