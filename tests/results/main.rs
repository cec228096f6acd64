//! Output files, plots, reports and the comparison with published values.

#[path = "../common/mod.rs"]
mod common;
#[path = "../fixtures/mod.rs"]
mod fixtures;

mod history;
mod outputs;
mod pictures;
mod record;
mod report;
mod validate;
