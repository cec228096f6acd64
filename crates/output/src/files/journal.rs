//! Journal of a set of files: maps temporary names to final ones, so that an interrupted commit can be completed.

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::Path;

use super::lock::{DirLock, is_there, sync_directory};
use super::{JOURNAL, failed, is_temporary, problem, temporary_in};
use cvtcycle_config::bounded;
use cvtcycle_config::{Problem, ProblemKind};
use serde::{Deserialize, Serialize};

pub(super) const SCHEMA: u32 = 1;

/// Files being put into place.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Journal {
    pub(super) schema: u32,
    pub(super) build: String,
    /// Temporary and final name of each file.
    pub(super) files: Vec<(String, String)>,
    pub(super) remove: Vec<String>,
}

/// Completes a commit that a killed process left in a directory, if there is one. Takes no lock if there is none.
///
/// # Errors
/// A problem of `--out`: another process writes there, the directory cannot be written, or the journal is damaged.
pub fn settle(dir: &Path) -> Result<(), Problem> {
    if !is_there(&dir.join(JOURNAL)) {
        return Ok(());
    }
    let lock = DirLock::wait(dir)?;
    complete(&lock)?;
    lock.sweep(dir);
    Ok(())
}

/// Completes an interrupted commit for a process that already holds the lock.
///
/// # Errors
/// A problem of `--out`: the directory cannot be written, or another user wrote the journal, or it is damaged.
pub fn complete(lock: &DirLock) -> Result<(), Problem> {
    let root = lock.path();
    let file = root.join(JOURNAL);
    if !is_there(&file) {
        return Ok(());
    }
    let name = root.display();
    let interrupted =
        format!("a command was interrupted while it put its files into place in {name}");
    let failed = |error: io::Error| {
        let hint = "make the directory writable, or write the results anew in another one";
        failed(root, &interrupted, &error).hint(hint)
    };
    let is_own = is_own(root, &file).map_err(failed)?;
    if !is_own {
        let hint = "repeat the command as the user who ran it";
        return Err(problem(root, &interrupted, hint));
    }
    let Some(journal) = Journal::read(root, &file) else {
        let message = format!("{JOURNAL} in {name} is damaged");
        let hint = "remove it, and write the results anew in another directory";
        return Err(problem(root, &message, hint).kind(ProblemKind::Damaged));
    };
    journal
        .complete(root)
        .and_then(|()| fs::remove_file(&file))
        .map_err(failed)
}

impl Journal {
    /// Reads a journal, which may come from an unknown author; `None` if this program did not write it.
    fn read(root: &Path, file: &Path) -> Option<Self> {
        let is_plain = |path: &Path| fs::symlink_metadata(path).map(|found| found.is_file());
        if !is_plain(file).ok()? {
            return None;
        }
        let bytes = bounded::read_file(file, bounded::CHECKSUMS).ok()?;
        let journal: Journal = serde_json::from_slice(&bytes).ok()?;
        let is_written = |name: &str| {
            is_temporary(name) && is_plain_name(name) && is_plain(&root.join(name)).unwrap_or(true)
        };
        let (temporary, names): (Vec<_>, Vec<_>) = journal.files.iter().cloned().unzip();
        let fits = journal.schema == SCHEMA
            && temporary.iter().all(|name| is_written(name))
            && names
                .iter()
                .chain(&journal.remove)
                .all(|name| is_place(root, name));
        fits.then_some(journal)
    }

    /// Performs the remaining steps.
    fn complete(&self, root: &Path) -> io::Result<()> {
        let mut folders = BTreeSet::from([root.to_path_buf()]);
        for (temporary, name) in &self.files {
            let (temporary, target) = (root.join(temporary), root.join(name));
            let folder = target.parent().unwrap_or(root).to_path_buf();
            // A file without its temporary name already has its final one.
            if is_there(&temporary) {
                if !is_there(&folder) {
                    fs::create_dir(&folder)?;
                }
                fs::rename(temporary, target)?;
            }
            folders.insert(folder);
        }
        for name in &self.remove {
            match fs::remove_file(root.join(name)) {
                Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
                _ => {}
            }
        }
        folders.iter().for_each(|folder| sync_directory(folder));
        Ok(())
    }
}

/// Tests that a name has no path components.
pub(super) fn is_plain_name(name: &str) -> bool {
    Path::new(name).file_name().is_some_and(|last| last == name)
}

/// Tests that a name is a file in the directory, or in a folder in it that is not a link.
fn is_place(root: &Path, name: &str) -> bool {
    let is_own = |name: &str| is_plain_name(name) && !is_temporary(name) && name != JOURNAL;
    match name.split_once('/') {
        None => is_own(name),
        Some((folder, name)) => {
            let found = fs::symlink_metadata(root.join(folder));
            is_own(folder) && is_own(name) && found.map_or(true, |found| found.is_dir())
        }
    }
}

/// Tests that the user of this process owns a file. Journals of other users are not executed.
#[cfg(unix)]
fn is_own(root: &Path, file: &Path) -> io::Result<bool> {
    use std::os::unix::fs::MetadataExt;
    let mine = temporary_in(root)?.as_file().metadata()?.uid();
    Ok(fs::symlink_metadata(file)?.uid() == mine)
}

#[cfg(not(unix))]
fn is_own(root: &Path, _: &Path) -> io::Result<bool> {
    temporary_in(root).map(|_| true)
}
