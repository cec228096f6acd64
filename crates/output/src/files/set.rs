//! Set of files renamed together, safe against a kill at any point.
//!
//! All files are written under temporary names first. A journal then maps them to their final names, and renaming the journal commits the set: a
//! process killed before leaves the earlier files unchanged, and a commit interrupted after is completed by the next process that reads or
//! writes there.
use std::collections::BTreeSet;
use std::fs;
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

use cvtcycle_config::Problem;
use rayon::prelude::*;

use super::journal::{Journal, SCHEMA, complete};
use super::lock::{DirLock, is_there};
use super::steps::{Step, Unplaced, carry_out};
use super::sum::{Sum, Summing};
use super::{JOURNAL, temporary_in};
use crate::BUILD;

/// Files that are renamed together, in a directory or a folder in it. Dropping the set before [`FileSet::commit`] removes them.
#[derive(Debug)]
pub struct FileSet {
    /// Current path of each file, and its final name.
    files: Vec<(PathBuf, PathBuf)>,
    /// Names of earlier files to remove.
    remove: Vec<PathBuf>,
    /// Further files under temporary names.
    others: Vec<PathBuf>,
    // Dropped last, so that the files are removed under the lock.
    lock: DirLock,
}

/// Writes the contents of a file.
pub type FileWriter<'a> = Box<dyn FnOnce(&mut (dyn Write + Send)) -> io::Result<()> + Send + 'a>;

impl FileSet {
    /// Begins a set in a locked directory, after completing an interrupted commit.
    ///
    /// # Errors
    /// A problem of `--out`: the directory cannot be written, or belongs to another user, or the journal is damaged.
    pub fn begin(lock: DirLock) -> Result<Self, Problem> {
        complete(&lock)?;
        Ok(FileSet {
            files: Vec::new(),
            remove: Vec::new(),
            others: Vec::new(),
            lock,
        })
    }

    /// Removes incomplete files of ended processes.
    pub fn sweep(&self) {
        self.lock.sweep(self.lock.path());
    }

    /// Writes a file under a temporary name, syncs it to disk, and returns its checksum.
    ///
    /// # Errors
    /// Errors of the operating system.
    pub fn write(
        &mut self,
        name: &Path,
        f: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
    ) -> io::Result<Sum> {
        let (temporary, sum) = self.temporary(f)?;
        self.files.push((temporary, name.to_path_buf()));
        Ok(sum)
    }

    /// Writes several files in parallel; returns checksums in their order.
    pub fn write_all(&mut self, files: Vec<(&Path, FileWriter)>) -> Vec<io::Result<Sum>> {
        let this = &*self;
        let written = files.into_par_iter();
        let written: Vec<_> = written.map(|(name, f)| (name, this.temporary(f))).collect();
        let mut keep = |(name, written): (&Path, io::Result<(PathBuf, Sum)>)| {
            let (temporary, sum) = written?;
            self.files.push((temporary, name.to_path_buf()));
            Ok(sum)
        };
        written.into_iter().map(&mut keep).collect()
    }

    /// Marks an earlier file for removal at the commit.
    pub fn remove(&mut self, name: PathBuf) {
        self.remove.push(name);
    }

    /// Names of the files so far.
    pub fn names(&self) -> impl Iterator<Item = &Path> {
        self.files.iter().map(|(_, name)| name.as_path())
    }

    /// Gives every file its name.
    ///
    /// # Errors
    /// The file that cannot be put into place; all earlier files then have their names again.
    pub fn commit(mut self) -> Result<(), Unplaced> {
        carry_out(&self.steps()?)?;
        self.lock.keep();
        Ok(())
    }

    fn temporary(
        &self,
        f: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
    ) -> io::Result<(PathBuf, Sum)> {
        let file = temporary_in(self.lock.path())?;
        // `NamedTempFile` would add its temporary name to every error.
        let mut out = Summing::new(BufWriter::new(file.as_file()));
        f(&mut out)?;
        out.flush()?;
        let sum = out.finish();
        file.as_file().sync_all()?;
        let path = file.into_temp_path().keep().map_err(|error| error.error)?;
        Ok((path, sum))
    }

    /// Creates a temporary name for a file that is moved aside.
    fn spare(&self) -> io::Result<PathBuf> {
        let spare = temporary_in(self.lock.path())?.into_temp_path();
        spare.keep().map_err(|error| error.error)
    }

    /// Steps of the commit in order. The first rename is that of the journal.
    fn steps(&mut self) -> Result<Vec<Step>, Unplaced> {
        let root = self.lock.path().to_path_buf();
        let place = root.join(JOURNAL);
        let journal = self.journal().map_err(|error| (place.clone(), error))?;
        let mut steps = Vec::new();
        if let Some(journal) = &journal {
            steps.push(Step::Rename(journal.clone(), place.clone()));
            steps.push(Step::Sync(root.clone()));
        }
        let new = |(path, name): &(PathBuf, PathBuf)| (Some(path.clone()), root.join(name));
        let gone = |name: &PathBuf| (None, root.join(name));
        let targets = self.files.iter().map(new);
        let targets: Vec<_> = targets.chain(self.remove.iter().map(gone)).collect();
        let mut folders = BTreeSet::from([root.clone()]);
        for (new, target) in targets {
            let folder = target.parent().unwrap_or(&root).to_path_buf();
            if !is_there(&folder) && !folders.contains(&folder) {
                steps.push(Step::Folder(folder.clone()));
            }
            folders.insert(folder);
            if let Ok(found) = fs::symlink_metadata(&target) {
                if found.is_dir() {
                    let error = io::Error::new(ErrorKind::IsADirectory, "is a directory");
                    return Err((target, error));
                }
                let spare = self.spare().map_err(|error| (target.clone(), error))?;
                steps.push(Step::Rename(target.clone(), spare.clone()));
                self.others.push(spare);
            }
            if let Some(new) = new {
                steps.push(Step::Rename(new, target));
            }
        }
        steps.extend(folders.into_iter().map(Step::Sync));
        steps.extend(journal.map(|_| Step::Remove(place)));
        Ok(steps)
    }

    /// Writes the journal under a temporary name. `None` if a name is not valid text; the files are then put into place without a journal.
    fn journal(&mut self) -> io::Result<Option<PathBuf>> {
        let text = |path: &Path| path.to_str().map(str::to_owned);
        let last = |path: &Path| text(Path::new(path.file_name()?));
        let files = self.files.iter();
        let files: Option<Vec<_>> = files
            .map(|(path, name)| Some((last(path)?, text(name)?)))
            .collect();
        let remove: Option<Vec<_>> = self.remove.iter().map(|name| text(name)).collect();
        let Some((files, remove)) = files.zip(remove) else {
            return Ok(None);
        };
        let journal = Journal {
            schema: SCHEMA,
            build: BUILD.to_owned(),
            files,
            remove,
        };
        let bytes = serde_json::to_vec_pretty(&journal)?;
        let (path, _) = self.temporary(|out| out.write_all(&bytes))?;
        self.others.push(path.clone());
        Ok(Some(path))
    }
}

impl Drop for FileSet {
    fn drop(&mut self) {
        // A journal that could not be withdrawn needs the files that it names.
        if is_there(&self.lock.path().join(JOURNAL)) {
            return;
        }
        let files = self.files.iter().map(|(path, _)| path);
        for path in files.chain(&self.others) {
            drop(fs::remove_file(path));
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::super::settle;
    use super::*;
    use cvtcycle_config::ProblemKind;

    type Tree = BTreeMap<String, String>;

    fn tree(dir: &Path) -> Tree {
        let mut tree = Tree::new();
        for entry in fs::read_dir(dir).expect("read").map(|e| e.expect("read")) {
            let name = entry.file_name().into_string().expect("text");
            if entry.path().is_dir() {
                let inner = self::tree(&entry.path()).into_iter();
                tree.extend(inner.map(|(file, text)| (format!("{name}/{file}"), text)));
            } else {
                tree.insert(name, fs::read_to_string(entry.path()).expect("read"));
            }
        }
        tree
    }

    fn tree_of(files: &[(&str, &str)]) -> Tree {
        let owned = |(name, text): &(&str, &str)| ((*name).to_owned(), (*text).to_owned());
        files.iter().map(owned).collect()
    }

    fn folder(files: &Tree) -> tempfile::TempDir {
        let dir = tempfile::tempdir().expect("a folder");
        for (name, text) in files {
            let path = dir.path().join(name);
            fs::create_dir_all(path.parent().expect("a folder")).expect("made");
            fs::write(path, text).expect("written");
        }
        dir
    }

    fn begun(dir: &Path, new: &[(&str, &str)], gone: &[&str]) -> FileSet {
        let mut set = FileSet::begin(DirLock::take(dir).expect("locked")).expect("begun");
        for (name, text) in new {
            let written = set.write(Path::new(name), |out| out.write_all(text.as_bytes()));
            written.expect("written");
        }
        gone.iter().for_each(|name| set.remove(PathBuf::from(name)));
        set
    }

    /// Simulates a killed process: removes nothing, and frees the lock.
    fn kill(mut set: FileSet) {
        set.files.clear();
        set.others.clear();
    }

    const RUN: [(&str, &str); 3] = [("a.csv", "1"), ("b.csv", "1"), ("summary.json", "1")];

    /// Earlier files, new files, and names to remove.
    type Case = (
        &'static [(&'static str, &'static str)],
        &'static [(&'static str, &'static str)],
        &'static [&'static str],
    );
    const CASES: [Case; 5] = [
        (&[], &RUN, &[]),
        (&RUN, &[("a.csv", "2"), ("summary.json", "2")], &["b.csv"]),
        (&[("a.csv", "0"), ("mine.txt", "0")], &RUN, &[]),
        (&[], &[("r.md", "2"), ("r_figures/x.svg", "2")], &[]),
        (
            &[
                ("r.md", "1"),
                ("r_figures/x.svg", "1"),
                ("r_figures/y.svg", "1"),
            ],
            &[
                ("r.md", "2"),
                ("r_figures/x.svg", "2"),
                ("r_figures/z.svg", "2"),
            ],
            &["r_figures/y.svg"],
        ),
    ];

    fn after(before: &Tree, new: &[(&str, &str)], gone: &[&str]) -> Tree {
        let mut after = before.clone();
        after.extend(tree_of(new));
        after.retain(|name, _| !gone.contains(&name.as_str()));
        after
    }

    /// A commit killed at any step leaves the earlier files until the journal has its name, and after settling the new ones from then on.
    #[test]
    fn kill_at_any_step_leaves_all_old_or_all_new_files() {
        for (before, new, gone) in CASES {
            let before = tree_of(before);
            let after = after(&before, new, gone);
            let mut steps = usize::MAX;
            for done in 0.. {
                let dir = folder(&before);
                let mut set = begun(dir.path(), new, gone);
                let list = set.steps().expect("planned");
                steps = steps.min(list.len());
                if done > steps {
                    break;
                }
                for step in &list[..done] {
                    step.run().expect("done");
                }
                kill(set);
                settle(dir.path()).expect("settled");
                let lock = DirLock::take(dir.path()).expect("locked");
                lock.sweep(dir.path());
                let expected = if done == 0 { &before } else { &after };
                assert_eq!(&tree(dir.path()), expected, "after {done} of {steps} steps");
            }
            assert!(steps > 2 + new.len());
        }
    }

    /// A failed step undoes all steps before it; if the undo is interrupted as well, the set is completed.
    #[test]
    fn failed_step_restores_the_earlier_files() {
        for (before, new, gone) in CASES {
            let before = tree_of(before);
            let after = after(&before, new, gone);
            let steps = begun(folder(&before).path(), new, gone).steps();
            for failing in 0..steps.expect("planned").len() {
                let dir = folder(&before);
                let mut set = begun(dir.path(), new, gone);
                let mut list = set.steps().expect("planned");
                let nothing = dir.path().join("nothing");
                list.insert(failing, Step::Rename(nothing.clone(), nothing));
                let (path, _) = carry_out(&list).expect_err("it fails");
                assert!(path.ends_with("nothing"));
                drop(set);
                assert_eq!(tree(dir.path()), before, "step {failing} failed");

                let mut set = begun(dir.path(), new, gone);
                let list = set.steps().expect("planned");
                for step in &list[..failing] {
                    step.run().expect("done");
                }
                for step in list[1.min(failing)..failing].iter().rev() {
                    step.undo().expect("undone");
                }
                kill(set);
                settle(dir.path()).expect("settled");
                DirLock::take(dir.path()).expect("locked").sweep(dir.path());
                let expected = if failing == 0 { &before } else { &after };
                assert_eq!(&tree(dir.path()), expected, "back from step {failing}");
            }
        }
    }

    /// A second process that writes into a directory is refused, and changes nothing.
    #[test]
    fn second_writer_is_refused() {
        let dir = folder(&Tree::new());
        let first = begun(dir.path(), &RUN, &[]);
        let problem = DirLock::take(dir.path()).expect_err("it is locked");
        assert_eq!(problem.kind, ProblemKind::Locked);
        first.commit().expect("put into place");
        assert_eq!(tree(dir.path()), tree_of(&RUN));
        drop(begun(dir.path(), &[("c.csv", "2")], &[]));
        assert_eq!(tree(dir.path()), tree_of(&RUN));
    }

    /// A foreign journal cannot reach outside: names stay in the directory, and only temporary files are moved.
    #[test]
    fn journal_with_outside_paths_is_damaged() {
        let temporary = ".cvtcycle-0.tmp";
        let journal = |from: &str, to: &str, gone: &str, schema: u32| {
            let (files, remove) = ([[from, to]], [gone]);
            serde_json::json!({ "schema": schema, "build": "", "files": files, "remove": remove })
                .to_string()
        };
        let bad = [
            journal(temporary, "../mine.txt", "gone", 1),
            journal(temporary, "/mine.txt", "gone", 1),
            journal(temporary, "a/b/mine.txt", "gone", 1),
            journal(temporary, JOURNAL, "gone", 1),
            journal(temporary, "", "gone", 1),
            journal(temporary, "link/mine.txt", "gone", 1),
            journal("mine.txt", "other", "gone", 1),
            journal("../.cvtcycle-0.tmp", "other", "gone", 1),
            journal(".cvtcycle-folder.tmp", "other", "gone", 1),
            journal(temporary, "other", "../mine.txt", 1),
            journal(temporary, "other", "link/mine.txt", 1),
            journal(temporary, "other", "gone", 2),
            "{".to_owned(),
            "[".repeat(100_000),
        ];
        for text in bad
            .iter()
            .filter(|text| cfg!(unix) || !text.contains("link/"))
        {
            let outer = folder(&tree_of(&[("mine.txt", "mine"), ("else/mine.txt", "mine")]));
            let dir = outer.path().join("dir");
            fs::create_dir_all(dir.join(".cvtcycle-folder.tmp")).expect("made");
            for (name, text) in [("mine.txt", "mine"), (temporary, "new"), (JOURNAL, text)] {
                fs::write(dir.join(name), text).expect("written");
            }
            #[cfg(unix)]
            std::os::unix::fs::symlink("../else", dir.join("link")).expect("linked");
            let before = tree(outer.path());
            let problem = settle(&dir).expect_err("it is damaged");
            assert_eq!(problem.kind, ProblemKind::Damaged, "{text}");
            assert_eq!(tree(outer.path()), before, "{text}");
        }
    }
}
