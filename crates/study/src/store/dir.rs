//! The directory of a study while it is written.

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::csv::write_csv;
use super::files::{Checksums, Sum};
use super::files::{NO_LINK, clear, link_in, put};
use super::manifest::{Difference, differences, lines};
use super::names::Layout;
use super::names::{self, MANIFEST, PARTS, PLAN, RESULTS, SUMMARY};
use super::parquet::{RUN_KEY, run_of, write_parquet};
use super::read::{Study, is_whole, marked_parts};
use super::table::{Head, Rows};
use cvtcycle_config::bounded::{self, ReadError};
use cvtcycle_config::{Problem, ProblemKind, Setting};
use cvtcycle_output::files::{
    DirLock, check_directory, complete, failed, list, names_in, problem, sync_directory,
    temporary_in,
};

/// A piece of a table: the rows of one part.
#[derive(Clone, Copy, Debug)]
pub struct PartTable<'a> {
    /// Name of the table, one of the layout's.
    pub name: &'a str,
    /// Heads of its columns.
    pub columns: &'a [Head],
    /// Rows of the table.
    pub rows: &'a Rows,
    /// Pairs for the metadata of the Parquet file.
    pub metadata: &'a [(&'a str, &'a str)],
}

/// The directory of a study that this process, and no other, writes.
#[derive(Debug)]
pub struct StudyDir {
    path: PathBuf,
    layout: Layout,
    /// Word of the run in the manifest, where there is one.
    run: Option<String>,
    whole: Mutex<BTreeSet<usize>>,
    lock: DirLock,
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
        let lock = DirLock::create(&path)?;
        complete(&lock)?;
        let earlier = check_contents(&path, force)?;
        no_link(&path)?;
        let mut dir = StudyDir::new(path, layout, lock);
        // Better to learn now than after the first part that nothing can be written here.
        let begun = dir.begin(manifest, plan, earlier);
        if begun.is_err() && !earlier {
            // The directory must be empty to go again.
            drop(fs::remove_dir(dir.parts()));
        }
        begun?;
        dir.lock.keep();
        Ok(dir)
    }

    /// Looks, without changing anything, whether [`StudyDir::create`] would find something in the way: for a list of all problems.
    ///
    /// # Errors
    /// A problem of `--out` that says what is in the way.
    pub fn check_free(path: &Path, force: bool) -> Result<(), Problem> {
        check_directory(path)?;
        match path.is_dir() {
            true => check_contents(path, force).map(drop),
            false => Ok(()),
        }
    }

    /// Takes up a study where it was left: with the same manifest, byte for byte. What an interrupted process left half written is
    /// removed; [`StudyDir::missing`] then tells the parts that are still to be computed.
    ///
    /// # Errors
    /// A problem that says that there is no study, that another process writes it, or what differs.
    pub fn resume(path: impl AsRef<Path>, manifest: &[u8], plan: &[u8]) -> Result<Self, Problem> {
        let path = path.as_ref().to_path_buf();
        let layout = layout_of(&path, manifest)?;
        let read = || bounded::read_file(path.join(MANIFEST), bounded::RECORD);
        let stored = || read().map_err(|error| no_study(&path, error));
        // Looked for before the lock: where there is no study there is nothing to wait for.
        stored()?;
        no_link(&path)?;
        let lock = DirLock::take(&path)?;
        let stored = stored()?;
        if stored != manifest {
            return Err(other_settings(&path, (&stored, manifest), plan));
        }
        let dir = StudyDir::new(path, layout, lock);
        dir.prepare(plan)
            .map_err(|error| dir.cannot_write("the study", &error))?;
        let marked = marked_parts(&dir.path, &dir.layout);
        for index in marked.map_err(|error| dir.cannot_write("the parts", &error))? {
            if is_whole(&dir.path, &dir.layout, index) {
                dir.whole().insert(index);
                continue;
            }
            // The part does not count as whole while its files are written again.
            let mark = names::part_mark(index);
            let gone = fs::remove_file(dir.parts().join(&mark));
            gone.map_err(|error| dir.cannot_write(&mark, &error))?;
        }
        Ok(dir)
    }

    fn new(path: PathBuf, (layout, run): (Layout, Option<String>), lock: DirLock) -> Self {
        StudyDir {
            path,
            layout,
            run,
            whole: Mutex::default(),
            lock,
        }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The parts that are not there yet, in their order.
    pub fn missing(&self) -> Vec<usize> {
        let whole = self.whole();
        let is_missing = |index: &usize| !whole.contains(index);
        (0..self.layout.parts).filter(is_missing).collect()
    }

    /// True if all parts are present.
    pub fn is_complete(&self) -> bool {
        self.whole().len() == self.layout.parts
    }

    /// Writes one part, down to the disk: whole, or as if it had not been tried.
    ///
    /// # Errors
    /// A problem of `--out` with the words of the operating system. Parts that are whole stay, and the study can be resumed.
    pub fn write_part(&self, index: usize, tables: &[PartTable]) -> Result<(), Problem> {
        let names = tables.iter().map(|table| table.name);
        if index >= self.layout.parts || !names.eq(&self.layout.tables) {
            let message = format!("part {index} is not one of the study's layout");
            return Err(problem(&self.path, &message, ""));
        }
        let parts = self.parts();
        let mut list = Checksums::default();
        for table in tables {
            let own = self.run.iter().map(|run| (RUN_KEY, run.as_str()));
            let pairs: Vec<_> = own.chain(table.metadata.iter().copied()).collect();
            for ending in self.layout.endings() {
                let name = names::part_file(table.name, index, ending);
                let written = put(&parts, &name, |out| match *ending {
                    "csv" => write_csv(out, table.columns, table.rows),
                    _ => write_parquet(out, table.columns, table.rows, &pairs),
                });
                let sum = written.map_err(|error| self.cannot_write(&name, &error))?;
                list.0.push((name, sum));
            }
        }
        let mark = names::part_mark(index);
        let marked = put(&parts, &mark, |out| out.write_all(list.text().as_bytes()));
        marked.map_err(|error| self.cannot_write(&mark, &error))?;
        sync_directory(&parts);
        self.whole().insert(index);
        Ok(())
    }

    /// Takes over a whole part of another study with the same manifest, byte for byte.
    ///
    /// # Errors
    /// A problem of `--out`, or a file that is no longer as it was written.
    pub(super) fn adopt(&self, index: usize, from: &Path) -> Result<(), Problem> {
        let (own, other) = (self.parts(), names::parts_folder(from));
        let mark = names::part_mark(index);
        let changed = |name: &str| {
            let message = format!("{name} in {} changed while it was read", from.display());
            problem(from, &message, "merge again").kind(ProblemKind::Damaged)
        };
        let list = Checksums::read(&other.join(&mark)).ok_or_else(|| changed(&mark))?;
        for name in self.layout.files(index) {
            let file = bounded::open_file(other.join(&name));
            let mut file = file.map_err(|_| changed(&name))?;
            let copy = put(&own, &name, |out| io::copy(&mut file, out).map(drop));
            let sum = copy.map_err(|error| self.cannot_write(&name, &error))?;
            if list.get(&name) != Some(&sum) {
                return Err(changed(&name));
            }
        }
        let marked = put(&own, &mark, |out| out.write_all(list.text().as_bytes()));
        marked.map_err(|error| self.cannot_write(&mark, &error))?;
        self.whole().insert(index);
        Ok(())
    }

    /// Writes the results over all parts, which are as they were written, into the directory itself, each whole or not at all, `summary.json`
    /// last, then the mark of a finished study.
    ///
    /// # Errors
    /// A problem of `--out`: parts are missing, a name is no plain one, or the words of the operating system.
    pub fn finish(&self, files: &[(String, Vec<u8>)]) -> Result<Vec<PathBuf>, Problem> {
        let (path, missing) = (self.path.display(), self.missing().len());
        if missing > 0 {
            let parts = self.layout.parts;
            let message = format!(
                "the study in {path} is not complete: {missing} of {parts} parts are missing"
            );
            let problem = problem(&self.path, &message, "continue it");
            return Err(problem.settings(&[Setting::Resume]));
        }
        for (k, (name, _)) in files.iter().enumerate() {
            let is_same = |(other, _): &(String, _)| other.eq_ignore_ascii_case(name);
            if !names::is_result(name) || files[..k].iter().any(is_same) {
                let message = format!("`{name}` cannot be the name of a result");
                return Err(problem(&self.path, &message, ""));
            }
        }
        let lost = |index: &usize| !is_whole(&self.path, &self.layout, *index);
        self.none_lost((0..self.layout.parts).filter(lost).count())?;
        let put = |name: &str, bytes: &[u8]| {
            let sum = self.put_bytes(name, bytes);
            sum.map_err(|error| self.cannot_write(name, &error))
        };
        let mut order: Vec<_> = files.iter().collect();
        order.sort_by_key(|(name, _)| name == SUMMARY);
        let mut list = Checksums::default();
        for (name, bytes) in order {
            list.0.push((name.clone(), put(name, bytes)?));
        }
        put(RESULTS, list.text().as_bytes())?;
        Ok(files.iter().map(|(name, _)| self.path.join(name)).collect())
    }

    /// Opens the parts written so far for reading.
    ///
    /// # Errors
    /// Those of [`Study::open`], and a part that was written is no longer there.
    pub fn study(&self) -> Result<Study, Problem> {
        let study = Study::open(&self.path)?;
        let is_lost = |index: &&usize| !study.present().contains(index);
        self.none_lost(self.whole().iter().filter(is_lost).count())?;
        Ok(study)
    }

    fn none_lost(&self, lost: usize) -> Result<(), Problem> {
        if lost == 0 {
            return Ok(());
        }
        let (path, parts) = (self.path.display(), self.layout.parts);
        let were = if lost == 1 { "was" } else { "were" };
        let message = format!(
            "{lost} of {parts} parts in {path} {were} changed or removed while the study ran"
        );
        let hint = "compute what is missing again and finish";
        Err(problem(&self.path, &message, hint).settings(&[Setting::Resume]))
    }

    fn parts(&self) -> PathBuf {
        names::parts_folder(&self.path)
    }

    fn whole(&self) -> MutexGuard<'_, BTreeSet<usize>> {
        // A set of numbers cannot be left half changed.
        self.whole.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn begin(&self, manifest: &[u8], plan: &[u8], earlier: bool) -> Result<(), Problem> {
        let write = || {
            temporary_in(&self.path)?;
            self.sweep();
            if earlier {
                // While the old manifest is there: an interruption leaves an old study with fewer parts.
                clear(&self.path)?;
            }
            fs::create_dir_all(self.parts())?;
            self.put_bytes(MANIFEST, manifest)?;
            // From here on it is a study, which --resume can take up.
            self.put_bytes(PLAN, plan)
        };
        let written = write();
        written
            .map(drop)
            .map_err(|error| self.cannot_write("the study", &error))
    }

    /// Removes what an interrupted process left, and completes what it did not write.
    fn prepare(&self, plan: &[u8]) -> io::Result<()> {
        let stored = bounded::read_file(self.path.join(PLAN), bounded::TOML);
        fs::create_dir_all(self.parts())?;
        self.sweep();
        match stored {
            Ok(text) if text == plan => Ok(()),
            _ => self.put_bytes(PLAN, plan).map(drop),
        }
    }

    /// Removes what ended processes left half written.
    fn sweep(&self) {
        self.lock.sweep(&self.path);
        self.lock.sweep(&self.parts());
        self.lock.remove_old_file();
    }

    /// A file in the directory itself.
    fn put_bytes(&self, name: &str, bytes: &[u8]) -> io::Result<Sum> {
        let sum = put(&self.path, name, |out| out.write_all(bytes))?;
        sync_directory(&self.path);
        Ok(sum)
    }

    fn cannot_write(&self, name: &str, error: &io::Error) -> Problem {
        let what = format!("cannot write {name} in {}", self.path.display());
        let problem = failed(&self.path, &what, error);
        let kept = "parts that are whole are kept";
        let hint = match error.kind() {
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
                format!("{kept}; make room and continue")
            }
            _ => format!("{kept} and can be continued; {}", problem.hint),
        };
        problem.hint(hint).settings(&[Setting::Resume])
    }
}

fn no_link(path: &Path) -> Result<(), Problem> {
    link_in(path).map_or(Ok(()), |message| Err(problem(path, &message, NO_LINK)))
}

fn layout_of(path: &Path, manifest: &[u8]) -> Result<(Layout, Option<String>), Problem> {
    let parsed = bounded::json(manifest).ok();
    let read =
        parsed.and_then(|manifest| Some((Layout::from_manifest(&manifest)?, run_of(&manifest))));
    read.ok_or_else(|| problem(path, "the study has no manifest with a layout", ""))
}

/// Checks for an earlier study in the directory. Refuses contents that must not be overwritten.
fn check_contents(path: &Path, force: bool) -> Result<bool, Problem> {
    let name = path.display();
    let cannot = |error| failed(path, &format!("cannot read directory {name}"), &error);
    let mut found = names_in(path).map_err(cannot)?;
    // An empty folder of parts is left by a study that never began.
    let is_empty =
        || fs::read_dir(names::parts_folder(path)).is_ok_and(|mut all| all.next().is_none());
    found.retain(|name| !(name == PARTS && is_empty()));
    let earlier = found.iter().any(|name| name == MANIFEST);
    if found.is_empty() || (earlier && force) {
        return Ok(earlier);
    }
    let (what, hint, settings): (_, _, &'static [Setting]) = match earlier {
        true => (
            "a study",
            "continue it, replace it, or choose another name",
            &[Setting::Resume, Setting::Replace],
        ),
        false => (
            "files of something else",
            "choose another name, or an empty directory",
            &[],
        ),
    };
    let message = format!("{name} holds {what}: {}", list(&found));
    Err(problem(path, &message, hint).settings(settings))
}

fn no_study(path: &Path, error: ReadError) -> Problem {
    let name = path.display();
    let message = format!("cannot read {MANIFEST} in {name}");
    match error {
        error if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
            let message = format!("there is no study in {name} to resume");
            let hint = "begin it without resuming, or check the path";
            problem(path, &message, hint).settings(&[Setting::Resume])
        }
        ReadError::Unreadable(error) => failed(path, &message, &error),
        refused => problem(path, &format!("{message}: {refused}"), refused.hint(""))
            .allowed(refused.allowed("")),
    }
}

pub(super) fn other_settings(path: &Path, (stored, now): (&[u8], &[u8]), plan: &[u8]) -> Problem {
    let name = path.display();
    let (Ok(stored), Ok(now)) = (bounded::json(stored), bounded::json(now)) else {
        let hint = "begin the study anew in its place or in another directory";
        let message = format!("{MANIFEST} in {name} is damaged");
        let settings = &[Setting::Replace];
        return problem(path, &message, hint)
            .kind(ProblemKind::Damaged)
            .settings(settings);
    };
    let mut found = differences(&stored, &now);
    let builds =
        [&stored, &now].map(|manifest| manifest["build"].as_str().unwrap_or("unknown").to_owned());
    // The line of the plan says more than what follows from it.
    let stored = bounded::read_file(path.join(PLAN), bounded::TOML).ok();
    if let Some(stored) = stored.filter(|stored| stored != plan) {
        let text = String::from_utf8_lossy;
        found.insert(0, lines(PLAN, &text(&stored), &text(plan)));
    }
    // The word of the run follows from all others.
    found.retain(|difference| difference.path != "run");
    let before = found.len();
    found.retain(|difference| difference.path != "build");
    if found.is_empty() && before > 0 {
        let [there, now] = builds;
        let message = format!(
            "the study in {name} was begun by another build of the program: {there} there, {now} now"
        );
        let hint =
            "resume it with that program, or begin anew in its place or in another directory";
        return problem(path, &message, hint).settings(&[Setting::Replace]);
    }
    let message = match found.as_slice() {
        [] => format!("{MANIFEST} in {name} was written in another form"),
        [first, rest @ ..] => {
            let more = match rest.len() {
                0 => String::new(),
                1 => " (and one more value)".to_owned(),
                n => format!(" (and {n} more values)"),
            };
            let Difference { path, stored, now } = first;
            format!(
                "the study in {name} is another one: `{path}` is {stored} there and {now} now{more}"
            )
        }
    };
    let hint = "resume it with the same plan, files and program, or begin anew in its place or in another directory";
    problem(path, &message, hint).settings(&[Setting::Replace])
}
