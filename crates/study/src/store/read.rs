//! A study that is read, whether it is finished, interrupted or being written.

use std::collections::{HashMap, HashSet};
use std::fs;
use std::io;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use serde_json::Value;

use super::file_problem;
use super::files::{Checksums, NO_LINK, Sum, link_in, sha256, sum_of};
use super::names::Layout;
use super::names::{self, MANIFEST, MAX_PART_ROWS, PLAN, RESULTS, RUNS};
use super::parquet_read::{MEND, ParquetFile, check_sum, unreadable};
use super::table::{Head, Rows};
use cvtcycle_config::Problem;
use cvtcycle_config::ProblemKind::{Conflict, Damaged, Missing, TooLarge, UnknownName, Unreadable};
use cvtcycle_config::bounded::{self, ReadError};

/// How far a study has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Status {
    /// Parts that are marked as whole.
    pub present: usize,
    /// Parts that the study will have.
    pub expected: usize,
    /// True if the results were written.
    pub finished: bool,
}

impl Status {
    /// True if all parts are present.
    pub fn is_complete(self) -> bool {
        self.present == self.expected
    }
}

/// A study on disk, read part by part.
#[derive(Debug)]
pub struct Study {
    path: PathBuf,
    manifest: Value,
    /// SHA-256 of the manifest's bytes.
    opened: Sum,
    layout: Layout,
    present: Vec<usize>,
    files: Mutex<Files>,
}

/// Files of parts that stay open: of a larger study those that were opened first. Each holds its footer, some 0.1 MB.
const MAX_OPEN: usize = 64;

/// State of the files of parts.
#[derive(Debug, Default)]
struct Files {
    /// Those whose checksum was found right: it is computed once only.
    right: HashSet<String>,
    /// Those that are open: their footers are read once only.
    open: HashMap<String, Arc<ParquetFile>>,
}

impl Study {
    /// Opens the study in a directory. Parts that appear later are not seen.
    ///
    /// # Errors
    /// A problem: no study is there, it cannot be read, or its manifest is damaged.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, Problem> {
        let path = path.as_ref().to_path_buf();
        let file = path.join(MANIFEST);
        let no_study = |error: ReadError| match error.kind() {
            io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => {
                let name = path.display();
                let message = format!("there is no study in {name}: it has no {MANIFEST}");
                let hint = "name a directory that `cvtcycle study` has written";
                file_problem(Missing, &path, message, hint)
            }
            _ => unreadable(&file, &error),
        };
        if let Some(message) = link_in(&path) {
            return Err(file_problem(Unreadable, &path, message, NO_LINK));
        }
        let bytes = bounded::read_file(&file, bounded::RECORD).map_err(no_study)?;
        let damaged = || file_problem(Damaged, &file, "the manifest of the study is damaged", "");
        let manifest = bounded::json(&bytes).map_err(|found| match found.kind {
            TooLarge => found.in_file(file.display().to_string()),
            _ => damaged(),
        })?;
        let layout = Layout::from_manifest(&manifest).ok_or_else(damaged)?;
        let parts = names::parts_folder(&path);
        let marked = marked_parts(&path, &layout);
        let mut present = marked.map_err(|error| unreadable(&parts, &error.into()))?;
        present.sort_unstable();
        Ok(Study {
            path,
            manifest,
            opened: sha256(&bytes),
            layout,
            present,
            files: Mutex::default(),
        })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Manifest that the study was begun with.
    pub fn manifest(&self) -> &Value {
        &self.manifest
    }

    /// Parts and tables.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Checks, after parts were read, that they are those of the manifest that was read before them.
    ///
    /// # Errors
    /// A problem that names the directory.
    pub fn unchanged(&self) -> Result<(), Problem> {
        let now = bounded::read_file(self.path.join(MANIFEST), bounded::RECORD);
        if now.is_ok_and(|bytes| sha256(&bytes) == self.opened) {
            return Ok(());
        }
        let message = format!(
            "the study in {} was replaced while it was read",
            self.path.display()
        );
        Err(file_problem(Conflict, &self.path, message, "read it again"))
    }

    /// The plan, byte for byte.
    ///
    /// # Errors
    /// A problem that names the file.
    pub fn plan(&self) -> Result<Vec<u8>, Problem> {
        let file = self.path.join(PLAN);
        bounded::read_file(&file, bounded::TOML).map_err(|error| unreadable(&file, &error))
    }

    /// The parts that are there, in their order.
    pub fn present(&self) -> &[usize] {
        &self.present
    }

    /// How far it has come.
    pub fn status(&self) -> Status {
        let finished = Checksums::read(&self.path.join(RESULTS)).is_some();
        Status {
            present: self.present.len(),
            expected: self.layout.parts,
            finished,
        }
    }

    /// One table of a part.
    ///
    /// # Errors
    /// A problem that names the file: it is missing or damaged, or no such part or table is there.
    pub fn part(&self, index: usize, table: &str) -> Result<Arc<ParquetFile>, Problem> {
        let folder = names::parts_folder(&self.path);
        let name = names::part_file(table, index, "parquet");
        let path = folder.join(&name);
        let mut files = self.files.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(file) = files.open.get(&name) {
            return Ok(Arc::clone(file));
        }
        if !self.layout.tables.iter().any(|other| other == table) {
            let tables = self.layout.tables.join(", ");
            let message = format!("the study has no table `{table}`, only {tables}");
            return Err(file_problem(UnknownName, &self.path, message, ""));
        }
        let file = bounded::open_file(&path).map_err(|error| unreadable(&path, &error))?;
        if !files.right.contains(&name) {
            let list = Checksums::read(&folder.join(names::part_mark(index)));
            let right = list.as_ref().and_then(|list| list.get(&name));
            let message = "the list of checksums of this part is damaged";
            let right = right.ok_or_else(|| file_problem(Damaged, &path, message, MEND))?;
            check_sum(&path, &file, right)?;
            files.right.insert(name.clone());
        }
        let file = ParquetFile::open_known(&path, file)?;
        let file = Arc::new(file.with_rows(&self.rows_due(index, table))?);
        if files.open.len() < MAX_OPEN {
            files.open.insert(name, Arc::clone(&file));
        }
        Ok(file)
    }

    /// Rows that a table of a part may have: of runs those of its points, as far as the manifest says how many there are.
    fn rows_due(&self, index: usize, table: &str) -> RangeInclusive<u64> {
        let number = |key: &str| self.manifest[key].as_u64().filter(|_| table == RUNS);
        let of_runs = || {
            let (points, size) = (number("points")?, number("points_per_part")?);
            let cars = self.manifest["cars"].as_array()?.len() as u64;
            let before = size.checked_mul(index as u64)?;
            points.saturating_sub(before).min(size).checked_mul(cars)
        };
        match of_runs().filter(|rows| *rows <= MAX_PART_ROWS) {
            Some(rows) => rows..=rows,
            None => 0..=MAX_PART_ROWS,
        }
    }

    /// Heads of the columns of a table; none as long as no part is there.
    ///
    /// # Errors
    /// Those of [`Study::part`].
    pub fn heads(&self, table: &str) -> Result<Vec<Head>, Problem> {
        match self.present.first() {
            Some(&index) => Ok(self.part(index, table)?.columns().to_vec()),
            None => Ok(Vec::new()),
        }
    }

    /// Number of rows of a table in all parts that are there.
    ///
    /// # Errors
    /// Those of [`Study::part`].
    pub fn rows(&self, table: &str) -> Result<u64, Problem> {
        let rows = |&index: &usize| self.part(index, table).map(|file| file.rows());
        self.present.iter().map(rows).sum()
    }

    /// Some columns of a table over all parts that are there. Of the table nothing else is in memory.
    ///
    /// # Errors
    /// Those of [`Study::part`], and for a column that is not there.
    pub fn read(&self, table: &str, names: &[&str]) -> Result<Rows, Problem> {
        let read = |&index: &usize| self.part(index, table)?.read(names);
        let mut parts = self.present.iter().map(read);
        let mut all = parts.next().unwrap_or_else(|| Ok(Rows::default()))?;
        for part in parts {
            all.append(part?);
        }
        Ok(all)
    }
}

/// Parts with a mark, in no order.
pub(super) fn marked_parts(study: &Path, layout: &Layout) -> io::Result<Vec<usize>> {
    let entries = match fs::read_dir(names::parts_folder(study)) {
        // Between manifest and folder a study can have been killed.
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries?,
    };
    let mut found = Vec::new();
    for entry in entries {
        found.extend(names::marked_part(&entry?.file_name().to_string_lossy()));
    }
    found.retain(|index| *index < layout.parts);
    Ok(found)
}

/// Checks that all files of a part are present, with the checksums in its mark.
pub(super) fn is_whole(study: &Path, layout: &Layout, index: usize) -> bool {
    let folder = names::parts_folder(study);
    let Some(list) = Checksums::read(&folder.join(names::part_mark(index))) else {
        return false;
    };
    let as_written = |name: &String| {
        let file = bounded::open_file(folder.join(name)).ok();
        let sum = file.and_then(|file| sum_of(&file).ok());
        sum.is_some() && sum.as_ref() == list.get(name)
    };
    layout.files(index).iter().all(as_written)
}
