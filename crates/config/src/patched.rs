//! A document whose numbers are changed and put back many times.
use std::sync::Arc;

use super::assign::{insert, is_word};
use super::document::{Document, Entry, Node, Span, Table, Value};
use super::overrides::KeyPath;
use super::place::Input;
use super::source::Source;

/// A document with numbers put over those of the file, as overrides would. It has only what the program computes
/// with, neither the text nor the origin of values: check-only readings need no more, and any other would have problems without a place.
#[derive(Clone, Debug)]
pub struct PatchedDocument {
    document: Document,
    /// Index of the source that the numbers come from.
    source: usize,
    /// What stood there before, in the order of the changes.
    changes: Vec<Change>,
}

/// The outermost entry that a number has changed.
#[derive(Clone, Debug)]
struct Change {
    path: KeyPath,
    depth: usize,
    /// None where nothing stood.
    before: Option<Entry>,
}

impl PatchedDocument {
    /// A copy of a document, without any change.
    pub fn new(document: &Document) -> Self {
        let source = document.sources.len();
        let without_text = Arc::new(Source::new(Input::Override(String::new()), ""));
        let document = Document {
            sources: vec![without_text; source + 1],
            root: bare(&document.root),
            header: document.header.clone(),
            title: document.title.clone(),
        };
        PatchedDocument {
            document,
            source,
            changes: Vec::new(),
        }
    }

    /// The document as it is now.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// Puts a number, in the key's own unit, at a path, as an override would: whole numbers as integers. Whether that was possible: a value
    /// may be where the path needs a table.
    #[must_use]
    pub fn set(&mut self, path: &KeyPath, number: f64) -> bool {
        let (root, value) = (&mut self.document.root, Value::of(number));
        if let Some(entry) = entry_mut(root, path)
            && entry.node.span.source == self.source
            && !matches!(entry.node.value, Value::Table(_))
        {
            entry.node.value = value;
            return true;
        }
        let Some(depth) = outermost_change(root, path) else {
            return false;
        };
        let span = Span {
            source: self.source,
            range: 0..0,
        };
        let node = Node {
            value,
            span: span.clone(),
        };
        let before = if depth + 1 == path.len() {
            replace(root, path, Some(Entry { key: span, node }))
        } else {
            let before = entry_mut(root, &path[..=depth]).cloned();
            // Nothing is in the way: that has been looked for.
            let _ = insert(root, path, node);
            before
        };
        self.changes.push(Change {
            path: Arc::clone(path),
            depth,
            before,
        });
        true
    }

    /// Takes all numbers back.
    pub fn reset(&mut self) {
        while let Some(Change {
            path,
            depth,
            before,
        }) = self.changes.pop()
        {
            replace(&mut self.document.root, &path[..=depth], before);
        }
    }
}

/// The table with `{ value = X, status = … }` as X.
fn bare(table: &Table) -> Table {
    let node = |node: &Node| {
        let value = match &node.value {
            Value::Table(inner) => inner.wrapped().map_or_else(
                || Value::Table(bare(inner)),
                |wrapped| wrapped.value.clone(),
            ),
            value => value.clone(),
        };
        Node {
            value,
            span: node.span.clone(),
        }
    };
    let entry = |(name, entry): (&String, &Entry)| {
        (
            name.clone(),
            Entry {
                key: entry.key.clone(),
                node: node(&entry.node),
            },
        )
    };
    Table {
        entries: table.entries.iter().map(entry).collect(),
        choice: table.choice.clone(),
    }
}

/// Depth of the first entry of the path that a number there would change; none if a value is in the way.
fn outermost_change(root: &Table, path: &[Box<str>]) -> Option<usize> {
    let mut table = root;
    for (depth, key) in path.iter().enumerate() {
        match table.entries.get(&**key).map(|entry| &entry.node) {
            _ if depth + 1 == path.len() => return Some(depth),
            Some(Node {
                value: Value::Table(inner),
                ..
            }) if inner.wrapped().is_none() => table = inner,
            Some(node) => return is_word(node).then_some(depth),
            None => return Some(depth),
        }
    }
    None
}

/// The entry at a path.
fn entry_mut<'t>(root: &'t mut Table, path: &[Box<str>]) -> Option<&'t mut Entry> {
    let (last, parents) = path.split_last()?;
    root.inner_mut(parents)?.entries.get_mut(&**last)
}

/// Puts an entry, or none, at a path whose tables exist, and gives what stood there.
fn replace(root: &mut Table, path: &[Box<str>], entry: Option<Entry>) -> Option<Entry> {
    let (last, parents) = path.split_last()?;
    let table = root.inner_mut(parents)?;
    match (entry, table.entries.get_mut(&**last)) {
        (Some(entry), Some(place)) => Some(std::mem::replace(place, entry)),
        (Some(entry), None) => table.entries.insert(last.to_string(), entry),
        (None, _) => table.entries.remove(&**last),
    }
}
