//! The entries of a table by their names, in the order of the alphabet.
//!
//! A car is read some two hundred keys at a time, thousands of times in a study, and a name is found faster by its hash than by comparing names.

use indexmap::IndexMap;
use rustc_hash::FxBuildHasher;

use super::Entry;

/// Entries by name.
#[derive(Clone, Debug, Default)]
pub(crate) struct Entries(IndexMap<String, Entry, FxBuildHasher>);

impl Entries {
    /// The entry of a name.
    #[inline]
    pub fn get(&self, name: &str) -> Option<&Entry> {
        self.0.get(name)
    }

    /// The same, to be changed.
    pub fn get_mut(&mut self, name: &str) -> Option<&mut Entry> {
        self.0.get_mut(name)
    }

    /// True if there is an entry of a name.
    pub fn contains_key(&self, name: &str) -> bool {
        self.0.contains_key(name)
    }

    /// True if there is none at all.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Puts an entry in; the former one of its name.
    pub fn insert(&mut self, name: String, entry: Entry) -> Option<Entry> {
        self.0.insert_sorted(name, entry).1
    }

    /// The entry of a name, put in where there is none.
    pub fn get_or_insert_with(&mut self, name: &str, make: impl FnOnce() -> Entry) -> &mut Entry {
        let place = match self.0.get_index_of(name) {
            Some(place) => place,
            None => self.0.insert_sorted(name.to_owned(), make()).0,
        };
        &mut self.0[place]
    }

    /// Takes the entry of a name out.
    pub fn remove(&mut self, name: &str) -> Option<Entry> {
        self.0.shift_remove(name)
    }

    /// Keeps the entries whose name is wanted.
    pub fn retain(&mut self, wanted: impl Fn(&str) -> bool) {
        self.0.retain(|name, _| wanted(name));
    }

    /// The names.
    pub fn keys(&self) -> impl Iterator<Item = &String> {
        self.0.keys()
    }

    /// The entries without their names.
    pub fn values(&self) -> impl Iterator<Item = &Entry> {
        self.0.values()
    }

    /// The same, to be changed.
    pub fn values_mut(&mut self) -> impl Iterator<Item = &mut Entry> {
        self.0.values_mut()
    }

    /// Names and entries.
    pub fn iter(&self) -> impl Iterator<Item = (&String, &Entry)> {
        self.0.iter()
    }
}

impl FromIterator<(String, Entry)> for Entries {
    fn from_iter<I: IntoIterator<Item = (String, Entry)>>(entries: I) -> Self {
        let mut entries: IndexMap<String, Entry, FxBuildHasher> = entries.into_iter().collect();
        entries.sort_unstable_keys();
        Entries(entries)
    }
}

impl IntoIterator for Entries {
    type Item = (String, Entry);
    type IntoIter = indexmap::map::IntoIter<String, Entry>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.into_iter()
    }
}
