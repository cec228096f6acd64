//! Undoable steps that put files into place, all or none.

use std::fs;
use std::io::{self};
use std::path::{Path, PathBuf};

use super::is_temporary;
use super::lock::sync_directory;

/// File that could not be put into place, with the error.
pub(super) type Unplaced = (PathBuf, io::Error);

/// Undoable step of a commit.
#[derive(Debug)]
pub(super) enum Step {
    Folder(PathBuf),
    Rename(PathBuf, PathBuf),
    Sync(PathBuf),
    Remove(PathBuf),
}

impl Step {
    pub(super) fn run(&self) -> io::Result<()> {
        match self {
            Step::Folder(path) => fs::create_dir(path),
            Step::Rename(from, to) => fs::rename(from, to),
            Step::Remove(path) => fs::remove_file(path),
            Step::Sync(path) => {
                sync_directory(path);
                Ok(())
            }
        }
    }

    pub(super) fn undo(&self) -> io::Result<()> {
        match self {
            Step::Folder(path) => fs::remove_dir(path),
            Step::Rename(from, to) => fs::rename(to, from),
            Step::Remove(_) | Step::Sync(_) => Ok(()),
        }
    }

    /// File that the step concerns, by its final name.
    fn subject(&self) -> &Path {
        match self {
            Step::Rename(from, to) if has_temporary_name(to) => from,
            Step::Folder(path) | Step::Rename(_, path) | Step::Remove(path) | Step::Sync(path) => {
                path
            }
        }
    }
}

fn has_temporary_name(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default();
    is_temporary(&name.to_string_lossy())
}

/// Runs all steps; undoes them if one fails. The undo withdraws the journal last, so that it may be interrupted as well.
pub(super) fn carry_out(steps: &[Step]) -> Result<(), Unplaced> {
    for (done, step) in steps.iter().enumerate() {
        if let Err(error) = step.run() {
            // If a step cannot be undone the journal stays, and the next command completes the set.
            drop(steps[..done].iter().rev().try_for_each(Step::undo));
            return Err((step.subject().to_path_buf(), error));
        }
    }
    Ok(())
}
