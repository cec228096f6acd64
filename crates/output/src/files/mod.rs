//! Files of a run: all appear under their names, or none.
mod journal;
mod lock;
mod set;
mod steps;
mod sum;

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use cvtcycle_config::{Argument, Problem, Setting};

pub use journal::{complete, settle};
pub use lock::{DirLock, sync_directory};
pub use set::{FileSet, FileWriter};
pub use sum::{Sum, Summing, Sums, hex, sha256, sum_of};

/// Files that identify a directory as one of an earlier run or calibration.
const MARKS: [&str; 3] = ["summary.json", "calibration.json", "findings.json"];
/// File that identifies a directory as one of a study.
const STUDY: &str = "study.json";
/// Prefix and suffix of the names of incomplete files.
const TEMPORARY: (&str, &str) = (".cvtcycle-", ".tmp");
/// Journal of a commit in progress.
const JOURNAL: &str = ".cvtcycle-commit.json";
/// Lock file, used where the directory itself cannot be locked.
pub const LOCK: &str = ".lock";
/// Maximum number of names listed of a directory's contents.
const LISTED: usize = 8;

/// Directory that receives the files of a run and is locked against other processes.
///
/// Files are written under temporary names and renamed by [`OutputDir::commit`], all or none. Dropped before
/// that, it removes them again, with the directories that it created.
///
/// ```
/// use cvtcycle_output::files::OutputDir;
/// let path = std::env::temp_dir().join("cvtcycle_output_dir");
/// let mut dir = OutputDir::create(&path, true)?;
/// dir.put("summary.json", "{}")?;
/// assert!(!path.join("summary.json").exists());
/// let paths = dir.commit()?;
/// assert!(paths[0].exists());
/// # std::fs::remove_dir_all(path).expect("the directory of this example");
/// # Ok::<(), cvtcycle_config::Problem>(())
/// ```
#[derive(Debug)]
pub struct OutputDir {
    path: PathBuf,
    earlier: Vec<String>,
    set: FileSet,
    sums: Sums,
}

impl OutputDir {
    /// Creates the directory, or takes it over if it is empty, or, with `force`, if it holds an
    /// earlier run. Fails at once if no file can be created in it.
    ///
    /// # Errors
    /// A problem of `--out` that names the obstacle.
    pub fn create(path: impl AsRef<Path>, force: bool) -> Result<Self, Problem> {
        let path = path.as_ref().to_path_buf();
        check_directory(&path)?;
        let set = FileSet::begin(DirLock::create(&path)?)?;
        let what = format!("cannot read directory {}", path.display());
        let earlier = names_in(&path).map_err(|error| failed(&path, &what, &error))?;
        check_contents(&path, &earlier, force)?;
        set.sweep();
        let dir = OutputDir {
            path,
            earlier,
            set,
            sums: Sums::new(),
        };
        // Fails before the simulation if the directory is not writable.
        temporary_in(&dir.path).map_err(|error| dir.cannot_write("a file", &error))?;
        Ok(dir)
    }

    /// Writes one file through `f`, down to the disk, under a temporary name.
    ///
    /// # Errors
    /// A problem of `--out` with the words of the operating system, or for a name that is not a
    /// plain file name or was used before in this run.
    pub fn write(
        &mut self,
        name: &str,
        f: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
    ) -> Result<(), Problem> {
        self.check_name(name, &[])?;
        let written = self.set.write(Path::new(name), f);
        let sum = written.map_err(|error| self.cannot_write(name, &error))?;
        self.sums.insert(name.to_owned(), hex(&sum));
        Ok(())
    }

    /// Writes several files in parallel, each as [`OutputDir::write`] does. They are listed in this order, independent of timing.
    ///
    /// # Errors
    /// The first error in this order, as of [`OutputDir::write`].
    pub fn write_all(&mut self, files: Vec<(String, FileWriter)>) -> Result<(), Problem> {
        let (names, writers): (Vec<String>, Vec<FileWriter>) = files.into_iter().unzip();
        for (k, name) in names.iter().enumerate() {
            self.check_name(name, &names[..k])?;
        }
        let paths = names.iter().map(Path::new);
        let written = self.set.write_all(paths.zip(writers).collect());
        for (name, sum) in names.into_iter().zip(written) {
            let sum = sum.map_err(|error| self.cannot_write(&name, &error))?;
            self.sums.insert(name, hex(&sum));
        }
        Ok(())
    }

    /// The directory.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// SHA-256 of the files written so far, by name.
    pub fn sums(&self) -> &Sums {
        &self.sums
    }

    /// Writes one file from memory.
    ///
    /// # Errors
    /// As [`OutputDir::write`].
    pub fn put(&mut self, name: &str, bytes: impl AsRef<[u8]>) -> Result<(), Problem> {
        self.write(name, |out| out.write_all(bytes.as_ref()))
    }

    /// Lists the names that an earlier run left in the directory and this run has not written.
    pub fn left_over(&self) -> Vec<String> {
        let is_left = |name: &&String| !self.set.names().any(|other| other == Path::new(name));
        self.earlier.iter().filter(is_left).cloned().collect()
    }

    /// Gives every file its name and returns their paths in the order of writing.
    ///
    /// # Errors
    /// A problem of `--out`; the directory is then as it was before the run.
    pub fn commit(self) -> Result<Vec<PathBuf>, Problem> {
        let OutputDir { path, set, .. } = self;
        let paths = set.names().map(|name| path.join(name)).collect();
        let unplaced = |(file, error): (PathBuf, io::Error)| {
            failed(&path, &format!("cannot write {}", file.display()), &error)
        };
        set.commit().map_err(unplaced)?;
        Ok(paths)
    }

    /// Checks the name of a new file against those of the set and against `others`.
    fn check_name(&self, name: &str, others: &[String]) -> Result<(), Problem> {
        if !journal::is_plain_name(name) || name.contains(['/', '\\', ':']) {
            let message = format!("`{name}` cannot be the name of an output file");
            let hint = "rename the vehicle or cycle that gives the file its name";
            return Err(problem(&self.path, &message, hint));
        }
        // Some file systems ignore case.
        let lower = name.to_lowercase();
        let is_same = |other: &Path| other.to_string_lossy().to_lowercase() == lower;
        let mut names = self.set.names().chain(others.iter().map(Path::new));
        if names.any(is_same) {
            let message = format!("two files of the run would be named {name}");
            let hint = "give every vehicle of the run a name of its own";
            return Err(problem(&self.path, &message, hint));
        }
        Ok(())
    }

    fn cannot_write(&self, name: &str, error: &io::Error) -> Problem {
        let target = if name.contains('.') {
            self.path.join(name).display().to_string()
        } else {
            format!("{name} in {}", self.path.display())
        };
        failed(&self.path, &format!("cannot write {target}"), error)
    }
}

/// Checks that a path can be used as a directory.
pub fn check_directory(path: &Path) -> Result<(), Problem> {
    if path.as_os_str().is_empty() {
        let message = "the name of the output directory is empty";
        let hint = "name a directory, for example run1";
        return Err(problem(path, message, hint));
    }
    if path.exists() && !path.is_dir() {
        let message = format!("{} exists and is not a directory", path.display());
        return Err(problem(path, &message, "choose another name"));
    }
    Ok(())
}

/// Creates a file under a temporary name in a directory.
pub fn temporary_in(directory: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(TEMPORARY.0).suffix(TEMPORARY.1);
    // Temporary files are private by default; results follow the user's umask.
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(directory)
}

/// Tests for the name of an incomplete file of an interrupted run.
pub fn is_temporary(name: &str) -> bool {
    name.starts_with(TEMPORARY.0) && name.ends_with(TEMPORARY.1)
}

/// Lists the names in a directory, sorted, without lock, journal and incomplete files.
pub fn names_in(path: &Path) -> io::Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(path)? {
        let name = entry?.file_name().to_string_lossy().into_owned();
        if !is_temporary(&name) && ![LOCK, JOURNAL].contains(&name.as_str()) {
            names.push(name);
        }
    }
    names.sort();
    Ok(names)
}

fn is_mark(name: &str) -> bool {
    MARKS.contains(&name)
}

fn check_contents(path: &Path, names: &[String], force: bool) -> Result<(), Problem> {
    // Results of a study also contain the files of a run, and must not be replaced by one.
    let marked = names.iter().any(|name| is_mark(name)) && !names.iter().any(|name| name == STUDY);
    if names.is_empty() || (marked && force) {
        return Ok(());
    }
    let (of, instead, settings): (_, _, &'static [Setting]) = match marked {
        true => (
            "the files of an earlier run",
            "replace them",
            &[Setting::Replace],
        ),
        false => ("files of something else", "an empty directory", &[]),
    };
    let message = format!("{} holds {of}: {}", path.display(), list(names));
    let hint = format!("choose another name, or {instead}");
    Err(problem(path, &message, &hint).settings(settings))
}

/// Lists the names of a directory, up to a maximum.
pub fn list(names: &[String]) -> String {
    listed(names, LISTED)
}

/// Lists the first `max` names and the number of the remaining ones.
pub fn listed(names: &[String], max: usize) -> String {
    let list = names[..names.len().min(max)].join(", ");
    match names.len().saturating_sub(max) {
        0 => list,
        more => format!("{list} and {more} more"),
    }
}

/// Converts an operating system error in writing into a problem.
pub fn failed(path: &Path, what: &str, error: &io::Error) -> Problem {
    use io::ErrorKind::{
        NotADirectory, PermissionDenied, QuotaExceeded, ReadOnlyFilesystem, StorageFull,
    };
    let hint = match error.kind() {
        PermissionDenied | ReadOnlyFilesystem => "choose a directory in which you may write",
        StorageFull | QuotaExceeded => "free some space, or choose a directory on another disk",
        NotADirectory => "a part of the path is a file; choose another name",
        _ => "check the path, or choose another directory",
    };
    // Strips the temporary name that is appended to the error if a file could not be created.
    let words = error.to_string();
    let words = words.split(" at path \"").next().unwrap_or_default();
    problem(path, &format!("{what}: {words}"), hint)
}

/// Creates a problem of the output.
pub fn problem(path: &Path, message: &str, hint: &str) -> Problem {
    Problem::output(message.to_string())
        .at(Argument::Output)
        .value(path.display().to_string())
        .hint(hint.to_string())
}
