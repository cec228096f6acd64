//! Records of a reading session.
use std::collections::BTreeSet;

use crate::problem::Problem;
use crate::reader::recorded::Recorded;
use cvtcycle_model::keys::with_labels;
use rustc_hash::FxHashMap;

/// Information about one key after reading it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KeyInfo {
    /// Dotted path.
    pub key: String,
    /// Unit as people write it, `-` for none.
    pub unit: String,
    /// Value in the key's unit; empty for an optional key that is not given.
    pub value: String,
    /// Value in SI units; none for what is no single number.
    pub si: Option<f64>,
    /// How it is known: source, derived, fitted, assumed, user, set or default; `choice` for a model chosen by its table; `class` or `like`
    /// for what is inherited from a class or from another car.
    pub status: String,
    /// Reference for the value; empty where none is given.
    pub source: String,
    /// Remark on the value; may be empty.
    pub note: String,
    /// Ends within which the value is known, in the key's unit; none where the file does not say.
    pub range: Option<[f64; 2]>,
    /// From where it comes: "line 12" of the file, the class or car that it is inherited from, "override" or "default".
    pub from: String,
    /// Allowed range or words.
    pub allowed: String,
    /// True if the value is a single number.
    pub is_number: bool,
    /// Meaning of the key.
    pub doc: String,
    /// Labels of the equations that use it.
    pub labels: &'static [&'static str],
}

impl KeyInfo {
    /// With the prefix of its file before its key.
    pub(crate) fn prefixed(mut self, prefix: &str) -> Self {
        self.key.insert_str(0, prefix);
        self
    }

    /// Meaning and labels as they are printed: "displacement (PU-1, PU-4)".
    pub fn meaning(&self) -> String {
        with_labels(&self.doc, self.labels)
    }
}

/// Problems of one document that are put into words; the rest is counted.
const MAX_SHOWN: usize = 500;

#[derive(Default)]
pub(crate) struct Log {
    pub problems: Vec<Problem>,
    /// Missing keys, apart because a mistyped key explains them.
    pub missing: Vec<Problem>,
    /// Problems beyond those that are shown.
    pub more: usize,
    pub keys: Vec<KeyInfo>,
    /// Values for the parts of the model.
    pub values: Recorded,
    /// Index of `keys` by their dotted path.
    pub index: FxHashMap<String, usize>,
    /// Paths whose whole content counts as read.
    pub read: BTreeSet<String>,
    /// Paths of tables that were read.
    pub tables: BTreeSet<String>,
    /// Paths at which one of several options is chosen.
    pub choices: BTreeSet<String>,
}

impl Log {
    /// True if another problem is to be put into words.
    pub fn has_room(&self) -> bool {
        self.problems.len() + self.missing.len() < MAX_SHOWN
    }

    /// Information about the key at a path.
    pub fn info(&mut self, path: &str) -> Option<&mut KeyInfo> {
        self.keys.get_mut(*self.index.get(path)?)
    }

    /// Adds a key; the first reading counts if it is read twice.
    pub fn register(&mut self, info: KeyInfo) {
        if !self.index.contains_key(&info.key) {
            self.index.insert(info.key.clone(), self.keys.len());
            self.keys.push(info);
        }
    }
}
