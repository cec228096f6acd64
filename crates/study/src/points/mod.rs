//! Operating points of the belt in a table, row by row: what `cvtcycle belt` reads and computes.
//!
//! A table may have any length: one line is in memory at a time.

mod columns;
mod model;
mod rows;
mod table;

pub use columns::{NUMBERS, OUTPUTS, Point, output_columns};
pub use model::{Model, Solved};
pub use table::{Counts, Done, Job, Take, read};
