//! Result files: columns, traces, summaries, records of what a run was made from, and files that are whole or absent.

pub mod columns;
pub mod trace;
pub mod file;
pub mod files;
pub mod hash;
pub mod history;
pub mod loss_table;
pub mod losses;
pub mod provenance;
pub mod record;
pub mod summary;
pub mod variator;

pub use cvtcycle_model::drive::{Component, Flags, PhaseTotals, Row, TERM_NAMES, Terms, Totals};
pub use history::History;
