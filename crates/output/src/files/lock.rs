//! One process writes in a directory, and what it makes there goes with it if it ends halfway.
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::Duration;

use cvtcycle_config::{Problem, ProblemKind};

use super::{JOURNAL, LOCK, failed, is_temporary, problem};

/// A lock that another process holds is tried again so often, at this interval: putting files into place takes a moment, a run longer.
const TRIES: usize = 20;
const INTERVAL: Duration = Duration::from_millis(10);
/// The same for a command that has computed its results and needs the lock for that moment only.
const PATIENT: usize = 500;

/// A directory in which this process, and no other, writes. The lock ends with the process, however that ends.
///
/// On Unix the directory itself is locked; elsewhere, and on file systems that lock no directories, an empty file in it, which means nothing
/// once it is not locked; where there are no locks at all, only two commands that begin at once are not kept apart. Directories that were
/// made for it go again when it is dropped, if they are empty, unless [`DirLock::keep`] was called.
#[derive(Debug)]
pub struct DirLock {
    path: PathBuf,
    created: Vec<PathBuf>,
    held: Option<File>,
    /// Whether a file in the directory is locked, and not the directory itself.
    by_file: bool,
}

/// How an attempt ended.
enum Attempt {
    /// Locked, or there are no locks.
    Locked { held: Option<File>, by_file: bool },
    /// Another process holds the lock.
    Busy,
    /// What was locked was removed or replaced meanwhile.
    Gone,
}

impl DirLock {
    /// Makes what is missing of a directory, and locks it.
    ///
    /// # Errors
    /// A problem of `--out`: another process writes there, or the words of the operating system.
    pub fn create(path: &Path) -> Result<Self, Problem> {
        Self::within(TRIES, path, true)
    }

    /// Locks a directory that is there.
    ///
    /// # Errors
    /// As [`DirLock::create`].
    pub fn take(path: &Path) -> Result<Self, Problem> {
        Self::within(TRIES, path, false)
    }

    /// Locks a directory that is there, and waits some seconds for another process that puts its files into place.
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
                held: None,
                by_file: false,
            };
            if makes {
                make(path, &mut lock.created).map_err(|error| cannot("create", &error))?;
            }
            match attempt(path) {
                Ok(Attempt::Locked { held, by_file }) => {
                    (lock.held, lock.by_file) = (held, by_file);
                    return Ok(lock);
                }
                // The process that holds the lock, or made the directory anew, uses it now.
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

    /// Lets the directories stay that were made for it.
    pub fn keep(&mut self) {
        self.created.clear();
    }

    /// Removes what ended processes left half written in the directory, or in a folder in it: plain files under temporary names that
    /// no process holds. Nothing while a set of files waits to be put into place.
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
            // Fails if somebody else has put a file there meanwhile, and then it must stay.
            drop(fs::remove_dir(dir));
        }
        // Only now may another process begin.
        drop(self.held.take());
    }
}

/// Whether there is something of that name, be it a link.
pub(super) fn is_there(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok()
}

/// Makes what is missing of a directory, and notes what was made here, outermost first: what another process makes at the same time is not.
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
    // What is no directory is not opened: a pipe would be waited for.
    if !fs::metadata(path)?.is_dir() {
        return Err(io::Error::new(
            ErrorKind::NotADirectory,
            "is not a directory",
        ));
    }
    if cfg!(unix) {
        match File::open(path) {
            Ok(dir) => match attempt_on(dir, path, false) {
                // Of the directory there are no locks here.
                Err(_) => {}
                attempt => return attempt,
            },
            // It may be written and not read.
            Err(error) if error.kind() == ErrorKind::PermissionDenied => {}
            Err(error) => return Err(error),
        }
    }
    let name = path.join(LOCK);
    // A link is not followed.
    if fs::symlink_metadata(&name).is_ok_and(|found| !found.is_file()) {
        let message = format!("{LOCK} in it is not a plain file");
        return Err(io::Error::new(ErrorKind::InvalidInput, message));
    }
    let mut options = OpenOptions::new();
    options.read(true).write(true).create(true).truncate(false);
    match attempt_on(options.open(&name)?, &name, true) {
        Err(error) if error.kind() == ErrorKind::Unsupported => Ok(Attempt::Locked {
            held: None,
            by_file: true,
        }),
        attempt => attempt,
    }
}

fn attempt_on(opened: File, path: &Path, by_file: bool) -> io::Result<Attempt> {
    match opened.try_lock() {
        Ok(()) if is_at(&opened, path) => Ok(Attempt::Locked {
            held: Some(opened),
            by_file,
        }),
        Ok(()) => Ok(Attempt::Gone),
        Err(TryLockError::WouldBlock) => Ok(Attempt::Busy),
        Err(TryLockError::Error(error)) => Err(error),
    }
}

/// Whether what was opened is what has that path now.
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

/// Makes the renames last through a power cut, where directories can be synced at all.
pub fn sync_directory(path: &Path) {
    if let Ok(dir) = File::open(path) {
        drop(dir.sync_all());
    }
}
