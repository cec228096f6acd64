//! Keeps the tables that a car's files name, so that building the car again neither reads nor parses them.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use super::Files;
use super::tables::Table;
use crate::bounded::ReadError;

/// The tables of one file, by kind.
type Kinds = BTreeMap<&'static str, Arc<Table>>;

/// Where files come from, and their tables read so far.
#[derive(Debug)]
pub(super) struct TableCache {
    files: Box<dyn Files>,
    tables: Mutex<BTreeMap<String, Kinds>>,
}

impl TableCache {
    pub fn new(files: Box<dyn Files>) -> Self {
        TableCache {
            files,
            tables: Mutex::default(),
        }
    }
}

impl Files for TableCache {
    fn read(&self, path: &str) -> Result<Vec<u8>, String> {
        self.files.read(path)
    }

    fn fetch(&self, path: &str) -> Result<Vec<u8>, ReadError> {
        self.files.fetch(path)
    }

    fn table(
        &self,
        kind: &'static str,
        file: &str,
        make: &mut dyn FnMut() -> Option<Arc<Table>>,
    ) -> Option<Arc<Table>> {
        let mut tables = self.tables.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(table) = tables.get(file).and_then(|kinds| kinds.get(kind)) {
            return Some(Arc::clone(table));
        }
        let table = make()?;
        tables
            .entry(file.to_owned())
            .or_default()
            .insert(kind, Arc::clone(&table));
        Some(table)
    }
}
