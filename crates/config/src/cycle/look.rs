//! A log with what is understood of it.

use super::{Cycle, bytes, likeness, read_columns};
use crate::Problems;
use crate::csv::Columns;
use crate::log::{Log, read};

/// A log as it was understood, and the cycle that it is.
#[derive(Debug)]
pub struct Look {
    /// The log; none of a file over distance or of a cycle without a channel of speed.
    pub log: Option<Log>,
    /// The cycle.
    pub cycle: Cycle,
}

/// Reads the log at a path, with what was understood of it.
///
/// # Errors
/// As [`crate::cycle::open`].
pub fn look(path: &str, columns: &Columns) -> Result<Look, Problems> {
    let bytes = bytes(crate::Argument::File, path, crate::files::bounded::LOG)?;
    let cycle = read_columns(path, &bytes, columns)?;
    Ok(Look {
        log: read(path, &bytes, columns, likeness::likeness).ok(),
        cycle,
    })
}
