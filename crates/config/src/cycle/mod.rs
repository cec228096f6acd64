//! Drive cycles from names and files: the embedded ones, constant speeds, and CSV tables.
//!
//! | file | content |
//! |---|---|
//! | `embedded` | the regulations' cycles that the program carries |
//! | `find` | a cycle by name or path |
//! | `constant` | `constant_90` and other constant speeds |
//! | `read` | a CSV file to a checked cycle; `schema` has its columns, `row` checks its rows |

mod constant;
mod embedded;
mod find;
mod read;
mod row;
mod schema;

pub use constant::constant_speed;
pub use cvtcycle_model::cycle::*;
pub use embedded::{embedded, names};
pub use find::{bytes, find, is_csv};
pub use read::read_csv;
