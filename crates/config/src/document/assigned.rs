//! A document with the values of overrides put over those of the file.

use crate::document::overrides::Override;
use crate::document::{Document, Entry, Node, Table, Value};
use crate::problem::Problem;
use crate::problem::source::Source;
use std::sync::Arc;

impl Document {
    /// Puts in one override, whose key is one of this document.
    ///
    /// # Errors
    /// A path that leads through a value, or a relative override without a value to change.
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

/// True if the value is a word, in either of the two forms of a value.
fn is_word(node: &Node) -> bool {
    matches!(node.inner().value, Value::Text(_))
}
