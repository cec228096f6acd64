//! CSV tables of the user: a schema states the columns, one reader checks header and rows and finds all problems at once.
//!
//! | file | content |
//! |---|---|
//! | `schema` | columns as data: name, cells, range, group |
//! | `header` | the lines above the rows: title, column names, units |
//! | `dialect` | the signs between columns and in numbers |
//! | `heading` | column names and units as other programs write them |
//! | `named` | columns that the user names |
//! | `names` | the column that a name means |
//! | `table` | rows of a table against its schema; tables that are in memory |
//! | `stream` | tables of any length, one line in memory at a time |
//! | `text` | bytes to text, lines to fields |
//! | `collector` | problems with their places, limited in number |

mod collector;
mod dialect;
mod header;
mod heading;
mod named;
mod names;
mod schema;
mod stream;
mod table;
mod text;

pub use collector::{Cell, Collector, Line};
pub(crate) use collector::{MAX_LINE_LEN, long_line};
pub use heading::{Foreign, UNITS};
pub use named::Columns;
pub(crate) use named::Entry;
pub use schema::{Cells, Column, Schema};
pub use stream::Lines;
pub use table::{Row, Table, Value, first_fields, read};
pub use text::Field;
pub(crate) use text::{empty, split};
