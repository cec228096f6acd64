//! Operating points of the belt in a table, row by row: what `cvtcycle belt` reads and computes.
//!
//! A table may have any length: one line is in memory at a time.

mod columns;
mod model;
mod rows;
mod table;

pub use columns::{OUTPUTS, Point, output_columns};
pub use model::{Model, Solved};
pub use rows::NUMBERS;
pub use table::{Counts, Done, Job, Take, read};
