//! Locks a directory for one writing process, and removes what the process created there if it ends early.
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::Duration;

use cvtcycle_config::{Problem, ProblemKind};

use super::{JOURNAL, LOCK, failed, is_temporary, problem};

/// Number and interval of attempts on a lock that another process holds: putting files into place takes a moment, a run longer.
const TRIES: usize = 20;
const INTERVAL: Duration = Duration::from_millis(10);
/// Number of attempts by a command that has computed its results and needs the lock only to write them.
const PATIENT: usize = 500;

/// Directory in which only this process writes. The lock ends with the process, even if it is killed.
///
/// On Unix the directory itself is locked; elsewhere, and on file systems that cannot lock directories, an empty file in it, which has no
/// meaning once it is unlocked. Without file locks, two commands that start at the same time are not kept apart. Directories created for the
/// lock are removed when it is dropped, if they are empty, unless [`DirLock::keep`] was called.
#[derive(Debug)]
pub struct DirLock {
    path: PathBuf,
    created: Vec<PathBuf>,
    locked_file: Option<File>,
    /// True if a file in the directory is locked instead of the directory itself.
    by_file: bool,
}

/// Result of an attempt to lock.
enum Attempt {
    /// Locked, or there are no locks.
    Locked {
        locked_file: Option<File>,
        by_file: bool,
    },
    /// Another process holds the lock.
    Busy,
    /// The locked path was removed or replaced meanwhile.
    Gone,
}

impl DirLock {
    /// Creates the missing parts of a directory, and locks it.
    ///
    /// # Errors
    /// A problem of `--out`: another process writes there, or an error of the operating system.
    pub fn create(path: &Path) -> Result<Self, Problem> {
        Self::within(TRIES, path, true)
    }

    /// Locks an existing directory.
    ///
    /// # Errors
    /// As [`DirLock::create`].
    pub fn take(path: &Path) -> Result<Self, Problem> {
        Self::within(TRIES, path, false)
    }

    /// Locks an existing directory; waits some seconds for another process that is putting its files into place.
    ///
    /// # Errors
    /// As [`DirLock::create`].
    pub fn wait(path: &Path) -> Result<Self, Problem> {
        Self::within(PATIENT, path, false)
    }

    fn within(tries: usize, path: &Path, makes: bool) -> Result<Self, Problem> {
        let cannot = |what: &str, error: &io::Error| {
            let what = format!("cannot {what} directory {}", path.display());
            failed(path, &what, error)
        };
        for k in 0..tries {
            if k > 0 {
                sleep(INTERVAL);
            }
            let mut lock = DirLock {
                path: path.to_path_buf(),
                created: Vec::new(),
                locked_file: None,
                by_file: false,
            };
            if makes {
                make(path, &mut lock.created).map_err(|error| cannot("create", &error))?;
            }
            match attempt(path) {
                Ok(Attempt::Locked {
                    locked_file,
                    by_file,
                }) => {
                    (lock.locked_file, lock.by_file) = (locked_file, by_file);
                    return Ok(lock);
                }
                // The process that holds the lock, or recreated the directory, uses it now.
                Ok(Attempt::Busy | Attempt::Gone) => lock.keep(),
                Err(error) if makes && error.kind() == ErrorKind::NotFound => {}
                Err(error) => return Err(cannot("lock", &error)),
            }
        }
        let message = format!("another process is writing in {}", path.display());
        let hint = "wait until it has ended, or choose another directory";
        Err(problem(path, &message, hint).kind(ProblemKind::Locked))
    }

    /// The directory.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Keeps the directories that were created for it.
    pub fn keep(&mut self) {
        self.created.clear();
    }

    /// Removes files that ended processes left incomplete in the directory, or in a folder in it: unlocked plain files under temporary names.
    /// Does nothing while a commit is pending.
    pub fn sweep(&self, folder: &Path) {
        let Ok(entries) = fs::read_dir(folder) else {
            return;
        };
        if is_there(&folder.join(JOURNAL)) {
            return;
        }
        for entry in entries.flatten() {
            let plain = entry.file_type().is_ok_and(|kind| kind.is_file());
            if !plain || !is_temporary(&entry.file_name().to_string_lossy()) {
                continue;
            }
            let file = OpenOptions::new().read(true).write(true).open(entry.path());
            if file.is_ok_and(|file| file.try_lock().is_ok()) {
                drop(fs::remove_file(entry.path()));
            }
        }
    }

    /// Removes the file that earlier versions locked, where the directory itself is locked now.
    pub fn remove_old_file(&self) {
        let file = self.path.join(LOCK);
        let is_old = |found: fs::Metadata| found.is_file() && found.len() == 0;
        if !self.by_file && fs::symlink_metadata(&file).is_ok_and(is_old) {
            drop(fs::remove_file(file));
        }
    }
}

impl Drop for DirLock {
    fn drop(&mut self) {
        if self.by_file {
            drop(fs::remove_file(self.path.join(LOCK)));
        }
        for dir in self.created.iter().rev() {
            // Fails if another process has put a file there meanwhile; the directory must then stay.
            drop(fs::remove_dir(dir));
        }
        // Unlocking last keeps other processes out until here.
        drop(self.locked_file.take());
    }
}

/// Tests that a path exists, without following a link.
pub(super) fn is_there(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok()
}

/// Creates the missing parts of a directory and records them, outermost first. Parts that another process creates at the same time are not
/// recorded.
fn make(path: &Path, made: &mut Vec<PathBuf>) -> io::Result<()> {
    let is_missing = |dir: &&Path| !dir.as_os_str().is_empty() && !dir.exists();
    let missing: Vec<&Path> = path.ancestors().take_while(is_missing).collect();
    for dir in missing.into_iter().rev() {
        match fs::create_dir(dir) {
            Ok(()) => made.push(dir.to_path_buf()),
            Err(error) if error.kind() == ErrorKind::AlreadyExists && dir.is_dir() => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

fn attempt(path: &Path) -> io::Result<Attempt> {
    // Only directories are opened: opening a pipe would block.
    if !fs::metadata(path)?.is_dir() {
        return Err(io::Error::new(
            ErrorKind::NotADirectory,
            "is not a directory",
        ));
    }
    if cfg!(unix) {
        match File::open(path) {
            Ok(dir) => match attempt_on(dir, path, false) {
                // The file system cannot lock directories.
                Err(_) => {}
                attempt => return attempt,
            },
            // The directory may be writable and not readable.
            Err(error) if error.kind() == ErrorKind::PermissionDenied => {}
            Err(error) => return Err(error),
        }
    }
    let name = path.join(LOCK);
    // Links are not followed.
    if fs::symlink_metadata(&name).is_ok_and(|found| !found.is_file()) {
        let message = format!("{LOCK} in it is not a plain file");
        return Err(io::Error::new(ErrorKind::InvalidInput, message));
    }
    let mut options = OpenOptions::new();
    options.read(true).write(true).create(true).truncate(false);
    match attempt_on(options.open(&name)?, &name, true) {
        Err(error) if error.kind() == ErrorKind::Unsupported => Ok(Attempt::Locked {
            locked_file: None,
            by_file: true,
        }),
        attempt => attempt,
    }
}

fn attempt_on(opened: File, path: &Path, by_file: bool) -> io::Result<Attempt> {
    match opened.try_lock() {
        Ok(()) if is_at(&opened, path) => Ok(Attempt::Locked {
            locked_file: Some(opened),
            by_file,
        }),
        Ok(()) => Ok(Attempt::Gone),
        Err(TryLockError::WouldBlock) => Ok(Attempt::Busy),
        Err(TryLockError::Error(error)) => Err(error),
    }
}

/// Tests that an opened file is still the one at that path.
#[cfg(unix)]
fn is_at(opened: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let place = |found: fs::Metadata| (found.dev(), found.ino());
    let now = fs::metadata(path).map(place);
    opened
        .metadata()
        .is_ok_and(|found| now.is_ok_and(|now| now == place(found)))
}

#[cfg(not(unix))]
fn is_at(_: &File, path: &Path) -> bool {
    is_there(path)
}

/// Makes the renames durable across a power cut, where directories can be synced.
pub fn sync_directory(path: &Path) {
    if let Ok(dir) = File::open(path) {
        drop(dir.sync_all());
    }
}
