//! Files of a study: put into place, locked, removed.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::Path;

use tempfile::NamedTempFile;

use super::checksums::{Checksums, Sum, Summing};
use super::names::{self, LOCK, RESULTS};
use cvtcycle_config::Problem;
use cvtcycle_output::files::{failed, is_temporary, problem, temporary_in};

/// Writes a file under a temporary name, down to the disk, and renames it. On an error nothing is left of it.
pub fn put(
    folder: &Path,
    name: &str,
    f: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
) -> io::Result<Sum> {
    let file: NamedTempFile = temporary_in(folder)?;
    // The bare file: the named one would add its temporary name to every error.
    let mut out = Summing::new(BufWriter::new(file.as_file()));
    f(&mut out)?;
    out.flush()?;
    let sum = out.finish();
    file.as_file().sync_all()?;
    file.persist(folder.join(name))
        .map_err(|error| error.error)?;
    Ok(sum)
}

/// Locks the directory for this process. The lock ends with the process, however that ends; the file stays and means nothing.
pub fn lock(path: &Path) -> Result<File, Problem> {
    let cannot =
        |error: &io::Error| failed(path, &format!("cannot lock {}", path.display()), error);
    let file = OpenOptions::new()
        .read(true)
        .write(true)
        .create(true)
        .truncate(false)
        .open(path.join(LOCK))
        .map_err(|error| cannot(&error))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => {
            let message = format!("another process is writing the study in {}", path.display());
            Err(problem(
                path,
                &message,
                "wait until it has ended, or choose another directory",
            ))
        }
        // Some network file systems know no locks; nothing is written over unless two studies are begun there at once.
        Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => Ok(file),
        Err(TryLockError::Error(error)) => Err(cannot(&error)),
    }
}

/// Removes what an interrupted process left half written; this process holds the lock.
pub fn remove_temporary(folder: &Path) -> io::Result<()> {
    remove_files(folder, is_temporary)
}

fn remove_files(folder: &Path, which: impl Fn(&str) -> bool) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if which(&entry.file_name().to_string_lossy()) && !entry.file_type()?.is_dir() {
            fs::remove_file(entry.path())?;
        }
    }
    Ok(())
}

/// Removes the results and parts of an earlier study, and nothing else.
pub fn clear(path: &Path) -> io::Result<()> {
    let results = Checksums::read(&path.join(RESULTS)).unwrap_or_default();
    remove_files(path, |name| {
        is_temporary(name) || (names::is_result(name) && results.get(name).is_some())
    })?;
    remove_files(path, |name| name == RESULTS)?;
    let parts = names::parts_folder(path);
    if parts.is_dir() {
        remove_files(&parts, |name| {
            is_temporary(name) || names::is_part_file(name)
        })?;
    }
    Ok(())
}
