//! The files of a run: all of them appear under their names, or none.
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::{NamedTempFile, TempPath};

use cvtcycle_config::{Argument, Problem, Setting};

/// The files that mark a directory as one of an earlier run or calibration.
const MARKS: [&str; 2] = ["summary.json", "calibration.json"];
/// The file that marks a directory as one of a study.
const STUDY: &str = "study.json";
/// Names of files that are still being written begin and end like this.
const TEMPORARY: (&str, &str) = (".cvtcycle-", ".tmp");
/// A directory's contents are listed up to this number of names.
const LISTED: usize = 8;

/// A directory that receives the files of a run.
///
/// Files are written under temporary names and renamed by [`OutputDir::commit`]. Dropped before
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
    // Before `created`: fields are dropped in this order, and a directory must be empty to go.
    written: Vec<(String, TempPath)>,
    created: Created,
}

impl OutputDir {
    /// Creates the directory, or takes it over if it is empty, or, with `force`, if it holds an
    /// earlier run. Fails at once if no file can be created in it.
    ///
    /// # Errors
    /// A problem of `--out` that says what is in the way.
    pub fn create(path: impl AsRef<Path>, force: bool) -> Result<Self, Problem> {
        let path = path.as_ref().to_path_buf();
        check_directory(&path)?;
        let cannot = |what: &str, error| {
            let what = format!("cannot {what} directory {}", path.display());
            failed(&path, &what, &error)
        };
        let created = Created::new(&path).map_err(|error| cannot("create", error))?;
        let earlier = names_in(&path).map_err(|error| cannot("read", error))?;
        check_contents(&path, &earlier, force)?;
        let dir = OutputDir {
            path,
            earlier,
            written: Vec::new(),
            created,
        };
        // Better to learn now than after the simulation that nothing can be written here.
        dir.temporary()
            .map_err(|error| dir.cannot_write("a file", &error))?;
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
        self.check_name(name)?;
        let written = self.temporary().and_then(|file| {
            // The bare file: the named one would add its temporary name to every error.
            let mut out = BufWriter::new(file.as_file());
            f(&mut out)?;
            out.flush()?;
            drop(out);
            file.as_file().sync_all()?;
            Ok(file.into_temp_path())
        });
        let temporary = written.map_err(|error| self.cannot_write(name, &error))?;
        self.written.push((name.to_string(), temporary));
        Ok(())
    }

    /// Writes one file from memory.
    ///
    /// # Errors
    /// As [`OutputDir::write`].
    pub fn put(&mut self, name: &str, bytes: impl AsRef<[u8]>) -> Result<(), Problem> {
        self.write(name, |out| out.write_all(bytes.as_ref()))
    }

    /// Names that an earlier run left in the directory and that this run has not written.
    pub fn left_over(&self) -> Vec<String> {
        let is_left = |name: &&String| !self.written.iter().any(|(other, _)| other == *name);
        self.earlier.iter().filter(is_left).cloned().collect()
    }

    /// Gives every file its name and returns their paths in the order of writing.
    ///
    /// # Errors
    /// A problem of `--out`; the directory is then as it was before the run.
    pub fn commit(mut self) -> Result<Vec<PathBuf>, Problem> {
        let paths = self.written.iter().map(|(name, _)| self.path.join(name));
        let paths: Vec<PathBuf> = paths.collect();
        let mut written = std::mem::take(&mut self.written);
        // The mark comes last, so that a directory with missing files never has it.
        written.sort_by_key(|(name, _)| is_mark(name));
        let mut swap = Swap::default();
        for (name, temporary) in written {
            let spare = self.temporary().map(NamedTempFile::into_temp_path);
            let done = spare.and_then(|spare| swap.put(temporary, self.path.join(&name), spare));
            done.map_err(|error| self.cannot_write(&name, &error))?;
        }
        swap.keep();
        self.created.keep();
        sync_directory(&self.path);
        Ok(paths)
    }

    fn temporary(&self) -> io::Result<NamedTempFile> {
        temporary_in(&self.path)
    }

    fn check_name(&self, name: &str) -> Result<(), Problem> {
        let plain = Path::new(name).file_name().is_some_and(|last| last == name);
        if !plain || name.contains(['/', '\\', ':']) {
            let message = format!("`{name}` cannot be the name of an output file");
            let hint = "rename the vehicle or cycle that gives the file its name";
            return Err(problem(&self.path, &message, hint));
        }
        // Not all file systems tell upper from lower case.
        let lower = name.to_lowercase();
        if self
            .written
            .iter()
            .any(|(other, _)| other.to_lowercase() == lower)
        {
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

/// Directories that did not exist before, outermost first; removed on drop if they are empty.
#[derive(Debug, Default)]
pub struct Created(Vec<PathBuf>);

impl Created {
    /// Creates what is missing of a directory.
    pub fn new(path: &Path) -> io::Result<Self> {
        let missing = |dir: &&Path| !dir.as_os_str().is_empty() && !dir.exists();
        let new = path.ancestors().take_while(missing).map(Path::to_path_buf);
        let mut new: Vec<PathBuf> = new.collect();
        new.reverse();
        // Kept first: what was created before an error must go again.
        let created = Created(new);
        fs::create_dir_all(path)?;
        Ok(created)
    }

    /// Lets them stay.
    pub fn keep(&mut self) {
        self.0.clear();
    }
}

impl Drop for Created {
    fn drop(&mut self) {
        for dir in self.0.iter().rev() {
            // Fails if somebody else has put a file there meanwhile, and then it must stay.
            drop(fs::remove_dir(dir));
        }
    }
}

/// Files put into place, undone on drop unless kept.
#[derive(Default)]
struct Swap {
    done: Vec<(PathBuf, Option<TempPath>)>,
}

impl Swap {
    /// Renames `new` to `target`; an earlier file of that name waits under the name `spare`.
    fn put(&mut self, new: TempPath, target: PathBuf, spare: TempPath) -> io::Result<()> {
        let spare = match fs::symlink_metadata(&target) {
            Ok(meta) if meta.is_dir() => {
                let kind = io::ErrorKind::IsADirectory;
                return Err(io::Error::new(kind, "is a directory"));
            }
            Ok(_) => {
                fs::rename(&target, &spare)?;
                Some(spare)
            }
            Err(_) => None,
        };
        let renamed = new.persist(&target).map_err(|error| error.error);
        self.done.push((target, spare));
        renamed
    }

    fn keep(mut self) {
        // The earlier files go with their temporary names.
        self.done.clear();
    }
}

impl Drop for Swap {
    fn drop(&mut self) {
        for (target, spare) in self.done.drain(..).rev() {
            // Nothing more can be done if the way back fails as well.
            match spare {
                Some(spare) => drop(spare.persist(&target)),
                None => drop(fs::remove_file(&target)),
            }
        }
    }
}

/// Checks that a path can be that of a directory.
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

/// A file under a temporary name in a directory.
pub fn temporary_in(directory: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(TEMPORARY.0).suffix(TEMPORARY.1);
    // Temporary files are private by default; results are as readable as the user's umask says.
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(directory)
}

/// Whether a name is that of a file that was being written when a run was interrupted.
pub fn is_temporary(name: &str) -> bool {
    name.starts_with(TEMPORARY.0) && name.ends_with(TEMPORARY.1)
}

/// Names in a directory, sorted, without what an interrupted run may have left half written.
pub fn names_in(path: &Path) -> io::Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(path)? {
        let name = entry?.file_name().to_string_lossy().into_owned();
        if !is_temporary(&name) {
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
    // The results of a study bear the mark of a run as well, and are not to be replaced by one.
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

/// The names of a directory, of many the first.
pub fn list(names: &[String]) -> String {
    listed(names, LISTED)
}

/// The first names, and how many more there are.
pub fn listed(names: &[String], max: usize) -> String {
    let list = names[..names.len().min(max)].join(", ");
    match names.len().saturating_sub(max) {
        0 => list,
        more => format!("{list} and {more} more"),
    }
}

/// Makes the renames last through a power cut, where directories can be synced at all.
pub fn sync_directory(path: &Path) {
    if let Ok(dir) = fs::File::open(path) {
        drop(dir.sync_all());
    }
}

/// The problem of an operating system error in writing.
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
    // Without the temporary name that is appended where a file could not be created.
    let words = error.to_string();
    let words = words.split(" at path \"").next().unwrap_or_default();
    problem(path, &format!("{what}: {words}"), hint)
}

/// A problem of the output.
pub fn problem(path: &Path, message: &str, hint: &str) -> Problem {
    Problem::output(message.to_string())
        .at(Argument::Output)
        .value(path.display().to_string())
        .hint(hint.to_string())
}
