//! Files of a report: the document, and its figures in a folder next to it, all or none.

use std::ffi::OsString;
use std::fs;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use super::document::Document;
use super::render::{html, markdown};
use cvtcycle_config::{Problem, Setting};
use cvtcycle_output::escape::url_path;
use cvtcycle_output::files::{DirLock, FileSet, failed, list, names_in, problem, temporary_in};

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

    /// File extensions, the usual one first.
    #[must_use]
    pub fn endings(self) -> &'static [&'static str] {
        match self {
            Form::Html => &["html", "htm"],
            Form::Markdown => &["md", "markdown"],
        }
    }

    /// Detects the form of a file by its extension.
    pub fn from_path(file: &Path) -> Option<Form> {
        let mut forms = [Form::Html, Form::Markdown].into_iter();
        forms.find(|form| form.endings().contains(&ending(file).as_str()))
    }
}

fn ending(file: &Path) -> String {
    let ending = file.extension().unwrap_or_default();
    ending.to_string_lossy().to_lowercase()
}

/// Tests that a file is a report of this program.
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

/// Markers of HTML and Markdown reports.
const GENERATOR: &str = "name=\"generator\" content=\"cvtcycle ";
const MADE_BY: &str = "Made by cvtcycle ";
/// Number of bytes at the beginning and at the end of a file that are searched for the markers.
const HEAD: u64 = 2000;
const TAIL: u64 = 200;

/// Destination of a report, checked before any computation.
#[derive(Debug)]
pub struct Target {
    file: PathBuf,
    figures: PathBuf,
    /// Name of the folder of figures.
    folder: OsString,
    form: Form,
    force: bool,
}

impl Target {
    /// Creates a target at a path. With `force`, an earlier report of that name is replaced; its folder of figures, possibly of a report in the
    /// other form, only if it holds nothing but drawings.
    ///
    /// # Errors
    /// A problem of `--out` that names the obstacle.
    pub fn new(file: &Path, form: Form, force: bool) -> Result<Self, Problem> {
        let stem = file.file_stem().unwrap_or_default();
        if stem.is_empty() {
            let hint = "name a file, for example report.html";
            return Err(problem(file, "the name of the report is empty", hint));
        }
        let mut folder = stem.to_os_string();
        folder.push("_figures");
        let parent = file
            .parent()
            .filter(|parent| !parent.as_os_str().is_empty());
        let parent = parent.unwrap_or(Path::new(".")).to_path_buf();
        let target = Target {
            file: file.to_path_buf(),
            figures: parent.join(&folder),
            folder,
            form,
            force,
        };
        target.check_place(&parent)?;
        target.check_earlier()?;
        target.check_figures()?;
        // Fails before the computation instead of after it.
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

    /// Checks that only an earlier report is replaced, and only with `force`.
    fn check_earlier(&self) -> Result<(), Problem> {
        let (file, shown) = (&self.file, self.file.display());
        match fs::symlink_metadata(file) {
            Err(_) => Ok(()),
            Ok(_) if !self.force => {
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

    /// Lists the figures of an earlier report.
    fn check_figures(&self) -> Result<Vec<String>, Problem> {
        let shown = self.figures.display();
        let other =
            |message: String| problem(&self.file, &message, "choose another name for the report");
        if self.figures.is_symlink() {
            return Err(other(format!("{shown} is a link; it is not followed")));
        }
        if !self.figures.exists() {
            return Ok(Vec::new());
        }
        let names = names_in(&self.figures)
            .map_err(|error| failed(&self.file, &format!("cannot read {shown}"), &error))?;
        let (figures, others): (Vec<_>, Vec<_>) =
            names.into_iter().partition(|name| name.ends_with(".svg"));
        match others.is_empty() {
            true => Ok(figures),
            false => {
                let others = list(&others);
                Err(other(format!(
                    "{shown} holds something else than figures: {others}"
                )))
            }
        }
    }

    /// Writes the report. Returns the document's path and those of the figures.
    ///
    /// # Errors
    /// A problem of `--out` with the words of the operating system; earlier files are then unchanged.
    pub fn write(&self, document: &Document) -> Result<Vec<PathBuf>, Problem> {
        let text = match self.form {
            Form::Html => html(document),
            Form::Markdown => markdown(document, &url_path(self.folder.as_encoded_bytes())),
        };
        let text = text.map_err(|why| {
            let message = format!("cannot fill in the template: {why}");
            problem(&self.file, &message, "")
        })?;
        self.put(document, &text)
    }

    fn put(&self, document: &Document, text: &str) -> Result<Vec<PathBuf>, Problem> {
        let parent = self.figures.parent().unwrap_or(Path::new("."));
        let mut set = FileSet::begin(DirLock::wait(parent)?)?;
        // Checked again: another process may have written a report meanwhile.
        self.check_earlier()?;
        let earlier = self.check_figures()?;
        set.sweep();
        let cannot = |error: &io::Error| {
            let message = format!("cannot write {}", self.file.display());
            failed(&self.file, &message, error)
        };
        let mut write = |name: &Path, text: &str| {
            let written = set.write(name, |out| out.write_all(text.as_bytes()));
            written.map_err(|error| cannot(&error))
        };
        let folder = Path::new(&self.folder);
        let mut paths = vec![self.file.clone()];
        for (name, figure) in document.figures() {
            write(&folder.join(&name), &figure.picture.svg)?;
            paths.push(self.figures.join(name));
        }
        write(Path::new(self.file.file_name().unwrap_or_default()), text)?;
        for name in earlier {
            if !paths.contains(&self.figures.join(&name)) {
                set.remove(folder.join(name));
            }
        }
        set.commit().map_err(|(_, error)| cannot(&error))?;
        Ok(paths)
    }
}
