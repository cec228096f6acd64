//! What a run leaves behind: rows, columns, energy ledgers, summary.

mod row;
mod ledger;
mod totals;
pub mod columns;
pub mod trace;
pub mod file;
pub mod files;
pub mod summary;

pub use ledger::{TERM_NAMES, Terms};
pub use row::{Component, Flags, Row};
pub use totals::{PhaseTotals, Totals};
