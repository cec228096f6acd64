//! A study and its directory: parts go there, columns come from there.

use super::execute::PartWriter;
use super::manifest::{RUNS, TRACES};
use super::prepare::Study;
use super::store::{self, PartTable, StudyDir};
use super::study_table::TableSource;
use super::table::{Rows, Values};
use cvtcycle_config::Problem;

/// Writes the parts of a study into its directory.
pub struct DirWriter<'a> {
    study: &'a Study,
    dir: &'a StudyDir,
}

impl<'a> DirWriter<'a> {
    /// For a study in its directory.
    pub fn new(study: &'a Study, dir: &'a StudyDir) -> Self {
        DirWriter { study, dir }
    }
}

impl PartWriter for DirWriter<'_> {
    fn write(&self, part: u64, runs: &Rows, trace: Option<&Rows>) -> Result<(), Problem> {
        let index = usize::try_from(part).unwrap_or(usize::MAX);
        let trace = trace.map(|rows| PartTable {
            name: TRACES,
            columns: &self.study.trace_columns,
            rows,
            metadata: &[],
        });
        let runs = PartTable {
            name: RUNS,
            columns: &self.study.columns,
            rows: runs,
            metadata: &[],
        };
        let tables: Vec<PartTable> = trace.into_iter().chain([runs]).collect();
        self.dir.write_part(index, &tables)
    }
}

impl TableSource for store::Study {
    fn parts(&self) -> Vec<u64> {
        self.present().iter().map(|part| *part as u64).collect()
    }

    fn columns(&self, part: u64, names: &[&str]) -> Result<Vec<Values>, Problem> {
        self.part(usize::try_from(part).unwrap_or(usize::MAX), RUNS)?
            .read(names)
            .map(|rows| rows.values)
    }

    fn traces(&self, part: u64, names: &[&str]) -> Result<Vec<Values>, Problem> {
        self.part(usize::try_from(part).unwrap_or(usize::MAX), TRACES)?
            .read(names)
            .map(|rows| rows.values)
    }
}
