//! The content of one `[[data]]` while it is read.

use super::types::{BenchPoints, Group, Measured, Observable, Observation};
use crate::check::rows::RowFile;
use crate::check::source::Source;
use cvtcycle_config::Place;

/// Sources, keys and rows that the groups of a plan may use.
pub(super) struct Context<'a> {
    /// The plan's own sources, then the common ones.
    pub sources: &'a [Source],
    /// Known keys.
    pub keys: &'a [String],
    /// Validation rows of the program.
    pub rows: &'a [RowFile],
    /// The plan, as problems cite it.
    pub file: &'a str,
}

/// Content of a group; views, benches and runs are counted within it.
#[derive(Default)]
pub(super) struct Found {
    pub group: Option<Group>,
    /// Fold of each observation by name.
    pub folds: Vec<String>,
    pub observations: Vec<Observation>,
    /// Lists of sources; none for the plan's own.
    pub views: Vec<Option<Vec<Source>>>,
    pub made: Made,
    pub rows: Vec<String>,
}

/// Benches, runs and files of the observations, counted within the group.
#[derive(Default)]
pub(super) struct Made {
    pub benches: Vec<BenchPoints>,
    pub runs: Vec<Source>,
    /// Path and SHA-256 of each file.
    pub files: Vec<(String, String)>,
}

/// Labels of an observation.
pub(super) struct About {
    pub label: String,
    pub what: String,
    pub unit: String,
    pub place: Place,
}

/// An observation of the group.
pub(super) fn observation(
    about: About,
    measured: Measured,
    sd: f64,
    observable: Observable,
) -> Observation {
    let About {
        label,
        what,
        unit,
        place,
    } = about;
    Observation {
        group: 0,
        fold: 0,
        label,
        what,
        column: String::new(),
        unit,
        measured,
        sd,
        weight_sd: sd,
        observable,
        place,
    }
}
