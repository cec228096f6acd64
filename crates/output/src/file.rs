//! A single output file that appears under its name when complete, or not at all.

use std::fs;
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use super::files::{DirLock, failed, problem, sync_directory, temporary_in};
use cvtcycle_config::{Problem, Setting};

/// File written under a temporary name in its own directory. Dropping it before [`OutputFile::commit`] removes it.
#[derive(Debug)]
pub struct OutputFile {
    path: PathBuf,
    out: BufWriter<NamedTempFile>,
    force: bool,
}

impl OutputFile {
    /// Begins a file. Fails at once if it cannot be written in its directory, or if a file of that name exists and `force` is not set.
    ///
    /// # Errors
    /// A problem of `--out` that names the obstacle.
    pub fn create(path: impl AsRef<Path>, force: bool) -> Result<Self, Problem> {
        let path = path.as_ref().to_path_buf();
        if path.file_name().is_none() {
            let message = "the name of the output file is empty";
            let hint = "name a file, for example points.csv";
            return Err(problem(&path, message, hint));
        }
        check_target(&path, force)?;
        let folder = folder(&path);
        if let Ok(lock) = DirLock::take(&folder) {
            lock.sweep(&folder);
        }
        let what = format!("cannot write in {}", folder.display());
        let out = temporary_in(&folder).map_err(|error| failed(&path, &what, &error))?;
        // The lock keeps other processes from removing the file as a leftover. Without file locks no process looks for leftovers.
        drop(out.as_file().try_lock());
        Ok(OutputFile {
            path,
            out: BufWriter::new(out),
            force,
        })
    }

    /// Path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Gives the file its name.
    ///
    /// # Errors
    /// A problem of `--out`; a file of that name has then neither appeared nor changed.
    pub fn commit(self) -> Result<PathBuf, Problem> {
        let OutputFile { path, out, force } = self;
        // Another process may have created the file meanwhile.
        check_target(&path, force)?;
        let file = out.into_inner().map_err(io::IntoInnerError::into_error);
        let written = file.and_then(|file| {
            file.as_file().sync_all()?;
            place(file, &path, force)
        });
        match written {
            Err(error) if error.kind() == ErrorKind::AlreadyExists && !force => {
                check_target(&path, force)?;
                return Err(cannot_write(&path, &error));
            }
            written => written.map_err(|error| cannot_write(&path, &error))?,
        }
        sync_directory(&folder(&path));
        Ok(path)
    }

    /// Converts a write error into a problem.
    pub fn cannot_write(&self, error: &io::Error) -> Problem {
        cannot_write(&self.path, error)
    }
}

impl Write for OutputFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.out.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Renames a file. Without `force`, checks that the name is free in the same step where the file system supports it.
fn place(file: NamedTempFile, path: &Path, force: bool) -> io::Result<()> {
    let placed = match force {
        true => file.persist(path),
        false => match file.persist_noclobber(path) {
            Err(refused) if refused.error.kind() != ErrorKind::AlreadyExists => {
                refused.file.persist(path)
            }
            placed => placed,
        },
    };
    placed.map(drop).map_err(|error| error.error)
}

fn folder(path: &Path) -> PathBuf {
    let parent = path
        .parent()
        .filter(|parent| !parent.as_os_str().is_empty());
    parent.unwrap_or(Path::new(".")).to_path_buf()
}

fn cannot_write(path: &Path, error: &io::Error) -> Problem {
    failed(path, &format!("cannot write {}", path.display()), error)
}

fn check_target(path: &Path, force: bool) -> Result<(), Problem> {
    let Ok(found) = fs::symlink_metadata(path) else {
        return Ok(());
    };
    let name = path.display();
    if path.is_dir() {
        let hint = "name a file, for example one in it";
        return Err(problem(path, &format!("{name} is a directory"), hint));
    }
    if !found.is_file() && !found.is_symlink() {
        let message = format!("{name} exists and is not a plain file");
        return Err(problem(path, &message, "choose another name"));
    }
    if force {
        return Ok(());
    }
    let hint = "choose another name, or replace it";
    Err(problem(path, &format!("{name} exists"), hint).settings(&[Setting::Replace]))
}
