//! The files of a report: the document, and its figures in a folder next to it. All of them appear, or none.

use std::fs;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::document::Document;
use super::render::{html, markdown};
use cvtcycle_config::{Problem, Setting};
use cvtcycle_output::files::{failed, list, names_in, problem, sync_directory, temporary_in};

/// Form of the document.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// One HTML page.
    Html,
    /// Markdown with a folder of figures.
    Markdown,
}

impl Form {
    /// Words of the command line.
    pub const NAMES: [(&'static str, Form); 2] = [("html", Form::Html), ("md", Form::Markdown)];

    /// Endings of its file, the usual one first.
    #[must_use]
    pub fn endings(self) -> &'static [&'static str] {
        match self {
            Form::Html => &["html", "htm"],
            Form::Markdown => &["md", "markdown"],
        }
    }

    /// The form of a file by its ending.
    pub fn of(file: &Path) -> Option<Form> {
        let mut forms = [Form::Html, Form::Markdown].into_iter();
        forms.find(|form| form.endings().contains(&ending(file).as_str()))
    }
}

fn ending(file: &Path) -> String {
    let ending = file.extension().unwrap_or_default();
    ending.to_string_lossy().to_lowercase()
}

/// Whether a file is a report that this program has written.
fn is_report(file: &Path) -> bool {
    let ends = || -> io::Result<(Vec<u8>, Vec<u8>)> {
        let mut file = fs::File::open(file)?;
        let (mut head, mut tail) = (Vec::new(), Vec::new());
        Read::by_ref(&mut file).take(HEAD).read_to_end(&mut head)?;
        file.seek(SeekFrom::Start(file.metadata()?.len().saturating_sub(TAIL)))?;
        file.take(TAIL).read_to_end(&mut tail)?;
        Ok((head, tail))
    };
    let (head, tail) = ends().unwrap_or_default();
    String::from_utf8_lossy(&head).contains(GENERATOR)
        || String::from_utf8_lossy(&tail).contains(MADE_BY)
}

/// By these words a page and a Markdown text are known as reports.
const GENERATOR: &str = "name=\"generator\" content=\"cvtcycle ";
const MADE_BY: &str = "Made by cvtcycle ";
/// Bytes at the beginning and at the end of a file in which these words are looked for.
const HEAD: u64 = 2000;
const TAIL: u64 = 200;

/// Where a report goes, checked before anything is computed.
#[derive(Debug)]
pub struct Target {
    file: PathBuf,
    figures: PathBuf,
    /// Name of the folder of figures.
    folder: String,
    form: Form,
}

impl Target {
    /// A target at a path. An earlier report of that name is replaced with `force` only; its folder of figures, which a report in the other
    /// form may have left, if it holds nothing but drawings.
    ///
    /// # Errors
    /// A problem of `--out` that says what is in the way.
    pub fn new(file: &Path, form: Form, force: bool) -> Result<Self, Problem> {
        let stem = file.file_stem().unwrap_or_default().to_string_lossy();
        if stem.is_empty() {
            let hint = "name a file, for example report.html";
            return Err(problem(file, "the name of the report is empty", hint));
        }
        let folder = format!("{stem}_figures");
        let parent = file
            .parent()
            .filter(|parent| !parent.as_os_str().is_empty());
        let parent = parent.unwrap_or(Path::new(".")).to_path_buf();
        let target = Target {
            file: file.to_path_buf(),
            figures: parent.join(&folder),
            folder,
            form,
        };
        target.check_place(&parent)?;
        target.check_earlier(force)?;
        target.check_figures()?;
        // Before the work, not after it.
        let shown = parent.display();
        temporary_in(&parent)
            .map_err(|error| failed(file, &format!("cannot write in {shown}"), &error))?;
        Ok(target)
    }

    fn check_place(&self, parent: &Path) -> Result<(), Problem> {
        let (file, shown) = (&self.file, self.file.display());
        if file.is_dir() {
            let hint = "name a file, for example report.html in it";
            return Err(problem(file, &format!("{shown} is a directory"), hint));
        }
        if !parent.is_dir() {
            let message = format!("there is no directory {}", parent.display());
            let hint = "make it first, or choose another place";
            return Err(problem(file, &message, hint));
        }
        let endings = self.form.endings();
        if endings.contains(&ending(file).as_str()) {
            return Ok(());
        }
        let endings = endings.join(" or .");
        let hint = format!("end its name in .{endings}, or choose the other format");
        let message = format!("{shown} has not the ending of its form");
        Err(problem(file, &message, &hint))
    }

    /// Only an earlier report is replaced, and only with `force`.
    fn check_earlier(&self, force: bool) -> Result<(), Problem> {
        let (file, shown) = (&self.file, self.file.display());
        match fs::symlink_metadata(file) {
            Err(_) => Ok(()),
            Ok(_) if !force => {
                let message = format!("{shown} is there already");
                let problem = problem(file, &message, "choose another name, or replace it");
                Err(problem.settings(&[Setting::Replace]))
            }
            Ok(there) if there.is_file() && is_report(file) => Ok(()),
            Ok(_) => {
                let message = format!("{shown} is no report of this program");
                Err(problem(file, &message, "choose another name"))
            }
        }
    }

    fn check_figures(&self) -> Result<(), Problem> {
        if !self.figures.exists() {
            return Ok(());
        }
        let shown = self.figures.display();
        let names = names_in(&self.figures)
            .map_err(|error| failed(&self.file, &format!("cannot read {shown}"), &error))?;
        let others = names.into_iter().filter(|name| !name.ends_with(".svg"));
        let others: Vec<String> = others.collect();
        if others.is_empty() {
            return Ok(());
        }
        let others = list(&others);
        let message = format!("{shown} holds something else than figures: {others}");
        Err(problem(
            &self.file,
            &message,
            "choose another name for the report",
        ))
    }

    /// Writes the report. Returns the document's path and those of the figures.
    ///
    /// # Errors
    /// A problem of `--out` with the words of the operating system; what was there before is then still there.
    pub fn write(&self, document: &Document) -> Result<Vec<PathBuf>, Problem> {
        let text = match self.form {
            Form::Html => html(document),
            Form::Markdown => markdown(document, &self.folder.replace(' ', "%20")),
        };
        let text = text.map_err(|why| {
            let message = format!("cannot fill in the template: {why}");
            problem(&self.file, &message, "")
        })?;
        self.put(document, &text).map_err(|error| {
            let message = format!("cannot write {}", self.file.display());
            failed(&self.file, &message, &error)
        })
    }

    fn put(&self, document: &Document, text: &str) -> io::Result<Vec<PathBuf>> {
        let parent = self.figures.parent().unwrap_or(Path::new("."));
        // In the directory of the target, so that only a rename is left to do.
        let fresh = tempfile::Builder::new()
            .prefix(".cvtcycle-")
            .suffix(".tmp")
            .tempdir_in(parent)?;
        let new = fresh.path().join("new");
        fs::create_dir(&new)?;
        let mut paths = vec![self.file.clone()];
        for figure in document.figures() {
            let name = format!("{}.svg", file_name(&figure.name));
            let mut file = fs::File::create(new.join(&name))?;
            file.write_all(figure.picture.svg.as_bytes())?;
            file.sync_all()?;
            paths.push(self.figures.join(name));
        }
        let mut page = temporary_in(parent)?;
        page.write_all(text.as_bytes())?;
        page.as_file().sync_all()?;
        let old = fresh.path().join("old");
        let replaced = self.figures.exists();
        if replaced {
            fs::rename(&self.figures, &old)?;
        }
        let back = |error: io::Error| {
            if replaced {
                // Nothing more can be done if the way back fails as well.
                let gone = fs::remove_dir_all(&self.figures);
                drop(gone.and_then(|()| fs::rename(&old, &self.figures)));
            }
            error
        };
        fs::rename(&new, &self.figures).map_err(back)?;
        page.persist(&self.file)
            .map_err(|error| back(error.error))?;
        sync_directory(parent);
        Ok(paths)
    }
}

/// A name without anything that leads elsewhere.
pub fn file_name(name: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_.".contains(c);
    name.chars()
        .map(|c| if plain(c) { c } else { '_' })
        .collect()
}
