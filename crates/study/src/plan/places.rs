//! Places of the parts of a plan, for problems that are found later.

use cvtcycle_config::{Place, RawValue, Section};

/// Places of the keys of one table of a plan.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Places {
    whole: Place,
    known: Vec<(String, Place)>,
}

impl Places {
    /// Those of a table at `whole`.
    pub fn new(whole: Place) -> Self {
        Places {
            whole,
            known: Vec::new(),
        }
    }

    /// Place of a key's value, such as `design`, `values` or `distribution.low`; the table itself where the key is not given.
    pub fn place(&self, key: &str) -> &Place {
        self.find(key).unwrap_or(&self.whole)
    }

    /// Place of an item of a list, counted from 0; the whole value where it is no list, such as a range.
    pub fn nth(&self, key: &str, item: usize) -> &Place {
        self.find(&item_name(key, item))
            .unwrap_or_else(|| self.place(key))
    }

    /// Notes a place.
    pub fn add(&mut self, key: &str, place: Place) {
        self.known.push((key.to_owned(), place));
    }

    /// Notes the places of the items of a list.
    pub(super) fn add_items(&mut self, key: &str, items: &[RawValue]) {
        for (k, item) in items.iter().enumerate() {
            self.add(&item_name(key, k), item.place());
        }
    }

    /// Notes the place of a key of `section` under the name `name`, where it is given.
    pub(super) fn add_given(&mut self, section: &Section, key: &str, name: &str) {
        if section.has(key) {
            self.add(name, section.place(key));
        }
    }

    fn find(&self, key: &str) -> Option<&Place> {
        let known = self.known.iter().find(|(known, _)| known == key);
        known.map(|(_, place)| place)
    }
}

fn item_name(key: &str, item: usize) -> String {
    format!("{key}[{item}]")
}
