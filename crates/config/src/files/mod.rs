//! Files that an input names, the limits of their size (`bounded`), the files that the program carries (`embedded`), and the user's where there
//! is no disk (`carried`).

pub mod bounded;
pub mod carried;
pub mod embedded;

use std::any::Any;
use std::collections::BTreeMap;
use std::fmt::Debug;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use self::bounded::ReadError;

/// Object made of a file.
pub type Made = Arc<dyn Any + Send + Sync>;

/// Reads files that an input names; the only way in which loading touches the disk.
pub trait Files: Debug + Send + Sync {
    /// Bytes of a file.
    ///
    /// # Errors
    /// The operating system's words, or more bytes than a table may have.
    fn read(&self, path: &str) -> Result<Vec<u8>, ReadError>;

    /// Object that `make` makes of a file of a kind. A cache calls `make` once only.
    fn made(
        &self,
        _kind: &'static str,
        _file: &str,
        make: &mut dyn FnMut() -> Option<Made>,
    ) -> Option<Made> {
        make()
    }
}

/// The disk, with names relative to a folder.
#[derive(Clone, Debug, Default)]
pub struct Disk {
    /// Folder of the file that names others; empty for the current one.
    pub folder: PathBuf,
}

impl Files for Disk {
    fn read(&self, path: &str) -> Result<Vec<u8>, ReadError> {
        bounded::read_file(self.folder.join(path), bounded::TABLE)
    }
}

/// Keeps the tables that a car's files name, so that building the car again neither reads nor parses them.
#[derive(Debug)]
pub(crate) struct TableCache {
    files: Box<dyn Files>,
    /// By file and kind.
    made: Mutex<BTreeMap<(String, &'static str), Made>>,
}

impl TableCache {
    pub fn new(files: Box<dyn Files>) -> Self {
        TableCache {
            files,
            made: Mutex::default(),
        }
    }
}

impl Files for TableCache {
    fn read(&self, path: &str) -> Result<Vec<u8>, ReadError> {
        self.files.read(path)
    }

    fn made(
        &self,
        kind: &'static str,
        file: &str,
        make: &mut dyn FnMut() -> Option<Made>,
    ) -> Option<Made> {
        let mut all = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        let key = (file.to_owned(), kind);
        if let Some(known) = all.get(&key) {
            return Some(Arc::clone(known));
        }
        let new = make()?;
        all.insert(key, Arc::clone(&new));
        Some(new)
    }
}
