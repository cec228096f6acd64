//! Drive cycles from names and files: the embedded ones, constant speeds, and CSV tables.
//!
//! | file | content |
//! |---|---|
//! | `embedded` | the regulations' cycles that the program carries |
//! | `find` | a cycle by name or path, `constant_90` and other constant speeds |
//! | `read` | a CSV file to a checked cycle; `row` has its columns and checks its rows |

mod embedded;
mod find;
mod read;
mod row;

pub use cvtcycle_model::cycle::*;
pub use embedded::{embedded, names};
pub use find::{ALIASES, CONSTANT, bytes, constant_speed, find, is_csv, name_of};
pub use read::read_csv;
