//! What a run leaves behind: rows, columns, energy ledgers, summary.

mod row;
mod ledger;
mod totals;
pub mod columns;
pub mod trace;
pub mod file;
pub mod files;
pub mod history;
pub mod record;
pub mod summary;

pub use history::History;
pub use ledger::{TERM_NAMES, Terms};
pub use row::{Component, Flags, Row};
pub use totals::{PhaseTotals, Totals};
