//! Generated parts of the book in `docs/book`: figures, tables, and mathematics as MathML.

pub mod figures;
pub mod latex;
pub mod pictures;
mod sketch;
