//! Parts of a study for tests: in memory, or on disk with the table of runs only.

use std::collections::BTreeMap;
use std::sync::Mutex;

use cvtcycle::config::Problem;
use cvtcycle::output::table::Head;
use cvtcycle::study::PartWriter;
use cvtcycle::study::store::{PartTable, Rows, StudyDir};

/// Collects the table of runs of each part.
#[derive(Default)]
pub struct MemorySink(pub Mutex<BTreeMap<u64, Rows>>);

impl PartWriter for MemorySink {
    fn write(&self, part: u64, runs: &Rows, _: Option<&Rows>) -> Result<(), Problem> {
        self.0.lock().unwrap().insert(part, runs.clone());
        Ok(())
    }
}

/// Writes a part with the table of runs only.
pub fn write_runs(study: &StudyDir, part: usize, columns: &[Head], rows: &Rows) {
    let table = PartTable {
        name: "runs",
        columns,
        rows,
        metadata: &[],
    };
    study.write_part(part, &[table]).unwrap();
}
