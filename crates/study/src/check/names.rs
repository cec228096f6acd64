//! The names that a file's expressions may use.

use super::expr::Names;
use super::source::{Kind, Source};
use super::tables;

/// Sources of a file, and the known keys.
pub struct FileNames<'a> {
    /// Sources of computed values.
    pub sources: &'a [Source],
    /// Keys of the vehicle files.
    pub keys: &'a [String],
}

impl Names for FileNames<'_> {
    fn sources(&self) -> Vec<&str> {
        self.sources
            .iter()
            .map(|source| source.name.as_str())
            .collect()
    }

    fn columns(&self, source: usize, totals: bool) -> Vec<&'static str> {
        let kind = self
            .sources
            .get(source)
            .map_or(Kind::Vehicle, |source| source.kind);
        if totals && kind != Kind::Run {
            Vec::new()
        } else {
            tables::columns(kind, totals)
        }
    }

    fn keys(&self) -> &[String] {
        self.keys
    }
}
