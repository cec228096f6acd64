//! A document with values put over those of the file: overrides before it is read, and numbers that are changed and put back many times.

use crate::document::overrides::Override;
use crate::document::target::KeyPath;
use crate::document::{Document, Entry, Node, Span, Table, Value};
use crate::problem::Problem;
use crate::problem::place::Input;
use crate::problem::source::Source;
use std::sync::Arc;

/// A document with numbers put over those of the file, as overrides would. It has only what the program computes
/// with, neither the text nor the origin of values: check-only readings need no more, and any other would have problems without a place.
#[derive(Clone, Debug)]
pub struct PatchedDocument {
    document: Document,
    /// Index of the source that the numbers come from.
    source: usize,
    /// The former entries, in the order of the changes.
    changes: Vec<Change>,
}

/// The outermost entry that a number has changed.
#[derive(Clone, Debug)]
struct Change {
    path: KeyPath,
    depth: usize,
    /// None where there was no entry.
    before: Option<Entry>,
}

impl PatchedDocument {
    /// A copy of a document, without any change.
    pub fn new(document: &Document) -> Self {
        let source = document.sources.len();
        let without_text = |parent| {
            let input = Input::Override(String::new());
            Arc::new(Source::new(input, "").inherited(parent))
        };
        let of_files = document.sources.iter();
        let of_files = of_files.map(|source| without_text(source.parent.clone()));
        let document = Document {
            sources: of_files.chain([without_text(None)]).collect(),
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
            is_override: true,
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
        match table.entries.get(key).map(|entry| &entry.node) {
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
    root.inner_mut(parents)?.entries.get_mut(last)
}

/// Puts an entry, or none, at a path whose tables exist, and returns the former entry.
fn replace(root: &mut Table, path: &[Box<str>], entry: Option<Entry>) -> Option<Entry> {
    let (last, parents) = path.split_last()?;
    let table = root.inner_mut(parents)?;
    match (entry, table.entries.get_mut(last)) {
        (Some(entry), Some(place)) => Some(std::mem::replace(place, entry)),
        (Some(entry), None) => table.entries.insert(last.to_string(), entry),
        (None, _) => table.entries.remove(last),
    }
}

impl Document {
    /// Puts in one override, whose key is one of this document.
    ///
    /// # Errors
    /// Its path leads through a value, or it changes a value that there is not.
    pub fn set(&mut self, by: &Override) -> Result<(), Problem> {
        let by = &by.over(self)?;
        let path = by.path();
        insert(&mut self.root, path, by.node(self.sources.len())).map_err(|depth| {
            let (value, path) = (path[..=depth].join("."), path.join("."));
            Problem::conflict(format!("`{value}` is a value, so `{path}` cannot exist"))
                .at(by.input())
                .key(path)
                .names_key()
                .hint(format!("set `{value}` itself"))
        })?;
        let source = Source::new(by.input(), by.value());
        self.sources.push(Arc::new(source));
        Ok(())
    }

    /// Makes the tables around a key, as an override of it would, and leaves the key out: a reading then gives its default, and an
    /// option to which it belongs is chosen.
    ///
    /// # Errors
    /// A path that leads through a value.
    pub(crate) fn reach(&mut self, by: &Override) -> Result<(), Problem> {
        self.set(by)?;
        if let Some((last, parents)) = by.path().split_last()
            && let Some(table) = self.root.inner_mut(parents)
        {
            table.entries.remove(last);
        }
        Ok(())
    }
}

/// Puts `node` at the path `keys`; fails with the depth at which a value is in the way.
fn insert(table: &mut Table, keys: &[Box<str>], node: Node) -> Result<(), usize> {
    let Some((last, parents)) = keys.split_last() else {
        return Ok(());
    };
    let mut table = table;
    for (depth, key) in parents.iter().enumerate() {
        let empty = || Entry {
            key: node.span.clone(),
            node: Node {
                value: Value::Table(Table::default()),
                span: node.span.clone(),
            },
        };
        let entry = table.entries.get_or_insert_with(key, empty);
        make_room(&mut entry.node);
        match &mut entry.node.value {
            Value::Table(inner) if inner.wrapped().is_none() => table = inner,
            _ => return Err(depth),
        }
    }
    if let Some(entry) = table.entries.get_mut(last)
        && let Value::Table(options) = &mut entry.node.value
        && matches!(node.value, Value::Text(_))
        && options.wrapped().is_none()
    {
        // A word for a table names one of its options; what the file says about it stays.
        options.choice = Some(Box::new(node));
        return Ok(());
    }
    let key = node.span.clone();
    table.entries.insert(last.to_string(), Entry { key, node });
    Ok(())
}

/// Turns a word, which may name an option, into a table that can hold that option's keys. The file's
/// word gives way to the assigned key, an assigned word is kept.
fn make_room(node: &mut Node) {
    if is_word(node) {
        let choice = node.span.is_set().then(|| Box::new(node.clone()));
        node.value = Value::Table(Table {
            choice,
            ..Table::default()
        });
    }
}

/// Whether the value is a word, in either of the two forms of a value.
fn is_word(node: &Node) -> bool {
    matches!(node.inner().value, Value::Text(_))
}
