//! The directory of a study while it is written.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use serde_json::Value;

use super::checksums::{Checksums, Sum};
use super::csv::write_csv;
use super::disk::{clear, lock, put, remove_temporary};
use super::layout::Layout;
use super::manifest::{differences, lines};
use super::names::{self, LOCK, MANIFEST, PARTS, PLAN, RESULTS, SUMMARY};
use super::parquet::write_parquet;
use super::read::{Study, is_whole, marked_parts};
use crate::table::{Head, Rows};
use cvtcycle_config::Problem;
use cvtcycle_config::bounded::{self, ReadError};
use cvtcycle_output::files::{
    Created, check_directory, failed, list, names_in, problem, sync_directory, temporary_in,
};

/// A piece of a table: the rows of one part.
#[derive(Clone, Copy, Debug)]
pub struct PartTable<'a> {
    /// Name of the table, one of the layout's.
    pub name: &'a str,
    /// Heads of its columns.
    pub columns: &'a [Head],
    /// Its rows.
    pub rows: &'a Rows,
    /// Pairs for the metadata of the Parquet file.
    pub metadata: &'a [(&'a str, &'a str)],
}

/// The directory of a study that this process, and no other, writes.
#[derive(Debug)]
pub struct StudyDir {
    path: PathBuf,
    layout: Layout,
    whole: Mutex<BTreeSet<usize>>,
    // Held until it is dropped, by whatever ends the process.
    _lock: File,
}

impl StudyDir {
    /// Begins a study in a directory that does not exist or is empty, or, with `force`, in place of an earlier study, whose parts and
    /// results it removes. The manifest is JSON with a [`Layout`] under `layout`.
    ///
    /// # Errors
    /// A problem of `--out` that says what is in the way; nothing has then changed, unless the disk failed halfway.
    pub fn create(
        path: impl AsRef<Path>,
        manifest: &[u8],
        plan: &[u8],
        force: bool,
    ) -> Result<Self, Problem> {
        let path = path.as_ref().to_path_buf();
        let layout = layout_of(&path, manifest)?;
        check_directory(&path)?;
        let mut created = Created::new(&path).map_err(|error| {
            failed(
                &path,
                &format!("cannot create directory {}", path.display()),
                &error,
            )
        })?;
        check_contents(&path, force)?;
        let lock = lock(&path)?;
        // Once more: another process may have begun a study just before the lock.
        let earlier = check_contents(&path, force)?;
        let dir = StudyDir {
            path,
            layout,
            whole: Mutex::default(),
            _lock: lock,
        };
        // Better to learn now than after the first part that nothing can be written here.
        let begun = dir.begin(manifest, plan, earlier);
        if begun.is_err() && !earlier {
            // The directory must be empty to go again.
            drop(fs::remove_file(dir.path.join(LOCK)));
            drop(fs::remove_dir(names::parts_folder(&dir.path)));
        }
        begun?;
        created.keep();
        Ok(dir)
    }

    /// Takes up a study where it was left: with the same manifest, byte for byte. What an interrupted process left half written is
    /// removed; [`StudyDir::missing`] then tells the parts that are still to be computed.
    ///
    /// # Errors
    /// A problem that says that there is no study, that another process writes it, or what differs.
    pub fn resume(path: impl AsRef<Path>, manifest: &[u8], plan: &[u8]) -> Result<Self, Problem> {
        let path = path.as_ref().to_path_buf();
        let layout = layout_of(&path, manifest)?;
        let stored = || {
            bounded::read_file(path.join(MANIFEST), bounded::RECORD)
                .map_err(|error| no_study(&path, error))
        };
        // Looked for before the lock, which would leave its file in a directory of something else.
        stored()?;
        let lock = lock(&path)?;
        let stored = stored()?;
        if stored != manifest {
            return Err(other_settings(&path, (&stored, manifest), plan));
        }
        let dir = StudyDir {
            path,
            layout,
            whole: Mutex::default(),
            _lock: lock,
        };
        let same_plan =
            bounded::read_file(dir.path.join(PLAN), bounded::TOML).is_ok_and(|text| text == plan);
        let parts = names::parts_folder(&dir.path);
        let prepared = fs::create_dir_all(&parts)
            .and_then(|()| remove_temporary(&dir.path))
            .and_then(|()| remove_temporary(&parts));
        let prepared = prepared.and_then(|()| {
            if same_plan {
                Ok(())
            } else {
                dir.put_bytes(PLAN, plan).map(drop)
            }
        });
        prepared.map_err(|error| dir.cannot_write("the study", &error))?;
        for index in marked_parts(&dir.path, &dir.layout)
            .map_err(|error| dir.cannot_write("the parts", &error))?
        {
            if is_whole(&dir.path, &dir.layout, index) {
                dir.whole().insert(index);
            } else {
                // Not to stand for a part while its files are written again.
                let gone = fs::remove_file(parts.join(names::part_mark(index)));
                gone.map_err(|error| dir.cannot_write(&names::part_mark(index), &error))?;
            }
        }
        Ok(dir)
    }

    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Its parts and tables.
    #[must_use]
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// The parts that are not there yet, in their order.
    #[must_use]
    pub fn missing(&self) -> Vec<usize> {
        let whole = self.whole();
        (0..self.layout.parts)
            .filter(|index| !whole.contains(index))
            .collect()
    }

    /// Whether all parts are there.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.whole().len() == self.layout.parts
    }

    /// Writes one part, down to the disk: whole, or as if it had not been tried.
    ///
    /// # Errors
    /// A problem of `--out` with the words of the operating system. Parts that are whole stay, and the study can be resumed.
    pub fn write_part(&self, index: usize, tables: &[PartTable]) -> Result<(), Problem> {
        let fits = tables.len() == self.layout.tables.len()
            && tables
                .iter()
                .zip(&self.layout.tables)
                .all(|(table, name)| table.name == name);
        if index >= self.layout.parts || !fits {
            return Err(problem(
                &self.path,
                &format!("part {index} is not one of the study's layout"),
                "",
            ));
        }
        let parts = names::parts_folder(&self.path);
        let mut list = Checksums::default();
        for table in tables {
            for ending in self.layout.endings() {
                let name = names::part_file(table.name, index, ending);
                let written = put(&parts, &name, |out| match *ending {
                    "csv" => write_csv(out, table.columns, table.rows),
                    _ => write_parquet(out, table.columns, table.rows, table.metadata),
                });
                list.0.push((
                    name.clone(),
                    written.map_err(|error| self.cannot_write(&name, &error))?,
                ));
            }
        }
        let mark = names::part_mark(index);
        let marked = put(&parts, &mark, |out| out.write_all(list.text().as_bytes()));
        marked.map_err(|error| self.cannot_write(&mark, &error))?;
        sync_directory(&parts);
        self.whole().insert(index);
        Ok(())
    }

    /// Writes the results over all parts into the directory itself, each whole or not at all, `summary.json` last, then the mark of a
    /// finished study.
    ///
    /// # Errors
    /// A problem of `--out`: parts are missing, a name is no plain one, or the words of the operating system.
    pub fn finish(&self, files: &[(String, Vec<u8>)]) -> Result<Vec<PathBuf>, Problem> {
        let missing = self.missing().len();
        if missing > 0 {
            let message = format!(
                "the study in {} is not complete: {missing} of {} parts are missing",
                self.path.display(),
                self.layout.parts
            );
            return Err(problem(&self.path, &message, "continue it with --resume"));
        }
        let twice = |k: usize, name: &str| {
            files[..k]
                .iter()
                .any(|(other, _)| other.eq_ignore_ascii_case(name))
        };
        if let Some((_, (name, _))) = files
            .iter()
            .enumerate()
            .find(|(k, (name, _))| !names::is_result(name) || twice(*k, name))
        {
            return Err(problem(
                &self.path,
                &format!("`{name}` cannot be the name of a result"),
                "",
            ));
        }
        let mut order: Vec<_> = files.iter().collect();
        order.sort_by_key(|(name, _)| name == SUMMARY);
        let mut list = Checksums::default();
        for (name, bytes) in order {
            let sum = self
                .put_bytes(name, bytes)
                .map_err(|error| self.cannot_write(name, &error))?;
            list.0.push((name.clone(), sum));
        }
        self.put_bytes(RESULTS, list.text().as_bytes())
            .map_err(|error| self.cannot_write(RESULTS, &error))?;
        Ok(files.iter().map(|(name, _)| self.path.join(name)).collect())
    }

    /// What is there so far, to be read.
    ///
    /// # Errors
    /// Those of [`Study::open`].
    pub fn study(&self) -> Result<Study, Problem> {
        Study::open(&self.path)
    }

    fn whole(&self) -> MutexGuard<'_, BTreeSet<usize>> {
        // A set of numbers cannot be left half changed.
        self.whole.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn begin(&self, manifest: &[u8], plan: &[u8], earlier: bool) -> Result<(), Problem> {
        let written = temporary_in(&self.path).map(drop).and_then(|()| {
            if earlier {
                // While the old manifest is there: an interruption leaves an old study with fewer parts.
                clear(&self.path)?;
            }
            fs::create_dir_all(names::parts_folder(&self.path))?;
            self.put_bytes(MANIFEST, manifest)
        });
        // From here on it is a study, which --resume can take up.
        written
            .and_then(|_| self.put_bytes(PLAN, plan))
            .map(drop)
            .map_err(|error| self.cannot_write("the study", &error))
    }

    /// A file in the directory itself.
    fn put_bytes(&self, name: &str, bytes: &[u8]) -> io::Result<Sum> {
        let sum = put(&self.path, name, |out| out.write_all(bytes))?;
        sync_directory(&self.path);
        Ok(sum)
    }

    fn cannot_write(&self, name: &str, error: &io::Error) -> Problem {
        let problem = failed(
            &self.path,
            &format!("cannot write {name} in {}", self.path.display()),
            error,
        );
        let hint = match error.kind() {
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
                "parts that are whole are kept; make room and continue with --resume".to_owned()
            }
            _ => format!(
                "parts that are whole are kept and --resume continues them; {}",
                problem.hint
            ),
        };
        problem.hint(hint)
    }
}

fn layout_of(path: &Path, manifest: &[u8]) -> Result<Layout, Problem> {
    let parsed = serde_json::from_slice::<Value>(manifest).ok();
    parsed
        .as_ref()
        .and_then(Layout::of)
        .ok_or_else(|| problem(path, "the study has no manifest with a layout", ""))
}

/// Whether the directory holds an earlier study. Refuses what is not to be written over.
fn check_contents(path: &Path, force: bool) -> Result<bool, Problem> {
    let mut found = names_in(path).map_err(|error| {
        failed(
            path,
            &format!("cannot read directory {}", path.display()),
            &error,
        )
    })?;
    // What is left of a study that never began.
    let empty =
        |folder: PathBuf| fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_none());
    found.retain(|name| name != LOCK && !(name == PARTS && empty(names::parts_folder(path))));
    let earlier = found.iter().any(|name| name == MANIFEST);
    if found.is_empty() || (earlier && force) {
        return Ok(earlier);
    }
    let name = path.display();
    Err(if earlier {
        let message = format!("{name} holds a study: {}", list(&found));
        problem(
            path,
            &message,
            "continue it with --resume, replace it with --force, or choose another name",
        )
    } else {
        let message = format!("{name} holds files of something else: {}", list(&found));
        problem(path, &message, "choose another name, or an empty directory")
    })
}

fn no_study(path: &Path, error: ReadError) -> Problem {
    if error.kind() == ErrorKind::NotFound || error.kind() == ErrorKind::NotADirectory {
        return problem(
            path,
            &format!("there is no study in {} to resume", path.display()),
            "leave --resume out to begin it, or check the path",
        );
    }
    let message = format!("cannot read {MANIFEST} in {}", path.display());
    match error {
        ReadError::Unreadable(error) => failed(path, &message, &error),
        refused => problem(path, &format!("{message}: {refused}"), refused.hint(""))
            .allowed(refused.allowed("")),
    }
}

fn other_settings(path: &Path, (stored, now): (&[u8], &[u8]), plan: &[u8]) -> Problem {
    let hint = "resume it with the same plan, files and program, or begin anew with --force or in another directory";
    let name = path.display();
    let (Ok(stored), Ok(now)) = (serde_json::from_slice(stored), serde_json::from_slice(now))
    else {
        return problem(
            path,
            &format!("{MANIFEST} in {name} is damaged"),
            "begin the study anew with --force or in another directory",
        );
    };
    let mut found = differences(&stored, &now);
    // The line of the plan says more than what follows from it.
    if let Some(stored) = bounded::read_file(path.join(PLAN), bounded::TOML)
        .ok()
        .filter(|stored| stored != plan)
    {
        found.insert(
            0,
            lines(
                PLAN,
                &String::from_utf8_lossy(&stored),
                &String::from_utf8_lossy(plan),
            ),
        );
    }
    let Some(first) = found.first() else {
        return problem(
            path,
            &format!("{MANIFEST} in {name} was written in another form"),
            hint,
        );
    };
    let more = match found.len() - 1 {
        0 => String::new(),
        1 => " (and one more value)".to_owned(),
        n => format!(" (and {n} more values)"),
    };
    let message = format!(
        "the study in {name} is another one: `{}` is {} there and {} now{more}",
        first.path, first.stored, first.now
    );
    problem(path, &message, hint)
}
