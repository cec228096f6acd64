//! Which files a study has.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::names::{is_table, part_file};

/// Most parts of a study.
const MAX_PARTS: usize = 1_000_000;

/// The parts and tables of a study: the object `layout` of its manifest.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Layout {
    /// Number of parts, 0 to 1 000 000.
    pub parts: usize,
    /// Names of the tables of which each part has a piece: small letters, digits and `_`.
    pub tables: Vec<String>,
    /// Whether each table of a part is written as CSV too.
    pub csv: bool,
}

impl Layout {
    /// The layout that a manifest states; none if it states none, or one that cannot be.
    pub fn of(manifest: &Value) -> Option<Self> {
        let layout: Layout = serde_json::from_value(manifest.get("layout")?.clone()).ok()?;
        let tables = &layout.tables;
        let unlike = tables
            .iter()
            .enumerate()
            .all(|(k, name)| is_table(name) && !tables[..k].contains(name));
        (layout.parts <= MAX_PARTS && !tables.is_empty() && unlike).then_some(layout)
    }

    /// Endings of the files of each table.
    pub(super) fn endings(&self) -> &'static [&'static str] {
        if self.csv {
            &["parquet", "csv"]
        } else {
            &["parquet"]
        }
    }

    /// Names of the files of a part, without its mark.
    pub(super) fn files(&self, index: usize) -> Vec<String> {
        let endings = self.endings();
        self.tables
            .iter()
            .flat_map(|table| {
                endings
                    .iter()
                    .map(move |ending| part_file(table, index, ending))
            })
            .collect()
    }
}
