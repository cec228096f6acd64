//! Drive cycles from names and files: the embedded ones, constant speeds, and CSV tables.
//!
//! | file | content |
//! |---|---|
//! | `embedded` | the regulations' cycles that the program carries |
//! | `find` | a cycle by name or path, `constant_90` and other constant speeds |
//! | `likeness` | a recording as a shipped cycle, in another unit or with other samples |
//! | `look` | a log with what is understood of it |
//! | `plain` | the tables of `embedded` to traces, without looking for mistakes |
//! | `read` | a CSV file to a checked cycle; `row` has its columns, those of other programs too, and checks its rows |
//! | `write` | a cycle as a file, of another program too |

mod embedded;
mod find;
mod likeness;
mod look;
mod plain;
mod read;
mod row;
#[cfg(test)]
mod tests;
mod write;

pub use cvtcycle_model::cycle::*;
pub(crate) use embedded::of_seconds;
pub use embedded::{embedded, names, shared};
pub use find::{ALIASES, CONSTANT, bytes, constant_speed, find, for_car, is_csv, name_of, open};
pub use look::{Look, look};
pub use read::{read_columns, read_csv};
pub use row::{FOREIGN, columns};
pub use write::{Format, Written, write};
