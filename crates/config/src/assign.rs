//! Assignments from the command line, put into the document before it is read.
use std::collections::BTreeMap;
use std::sync::Arc;

use toml::de::DeValue;

use super::document::{Document, Entry, Node, Span, Table, Value, convert};
use super::problem::Problem;
use super::source::Source;

/// Tables that an assignment may nest; more than any input has, few enough to recurse over.
const MAX_DEPTH: usize = 32;

impl Document {
    /// Puts in one assignment `a.b.c=VALUE`. The value is TOML, or else taken as text without quotes.
    ///
    /// # Errors
    /// A text that is no assignment, or a path that leads through a value.
    pub fn set(&mut self, assignment: &str) -> Result<(), Problem> {
        let refuse = |key: &str, message: String, hint: &str| {
            Problem::invalid(message)
                .in_file(format!("--set {assignment}"))
                .key(key.to_string())
                .hint(hint.to_string())
        };
        let form = "write table.key=VALUE";
        let Some((path, text)) = assignment.split_once('=') else {
            return Err(refuse("", "no `=` in the assignment".to_string(), form));
        };
        let (path, text) = (path.trim(), text.trim());
        let keys: Vec<&str> = path.split('.').map(str::trim).collect();
        if keys.iter().any(|key| key.is_empty()) || keys.len() > MAX_DEPTH {
            return Err(refuse(path, format!("`{path}` is no key"), form));
        }
        if text.is_empty() {
            return Err(refuse(path, format!("no value for `{path}`"), form));
        }
        let source = self.sources.len();
        let value = match DeValue::parse(text) {
            Ok(value) => convert(value.get_ref(), source),
            Err(_) => Value::Text(text.to_string()),
        };
        let node = Node {
            value,
            span: Span {
                source,
                range: 0..text.len(),
            },
        };
        insert(&mut self.root, &keys, node).map_err(|depth| {
            let value = keys[..=depth].join(".");
            let message = format!("`{value}` is a value, so `{path}` cannot exist");
            refuse(path, message, &format!("set `{value}` itself"))
        })?;
        let name = format!("--set {assignment}");
        self.sources.push(Arc::new(Source::new(&name, text, false)));
        Ok(())
    }

    /// Makes the tables around a key, as an assignment to it would, and leaves the key out: a reading then gives its default, and an
    /// option to which it belongs is chosen.
    ///
    /// # Errors
    /// A path that leads through a value.
    pub fn reach(&mut self, key: &str) -> Result<(), Problem> {
        self.set(&format!("{key}=0"))?;
        let keys: Vec<&str> = key.split('.').map(str::trim).collect();
        remove(&mut self.root, &keys);
        Ok(())
    }
}

/// Removes the entry at a path; the tables around it stay.
fn remove(table: &mut Table, keys: &[&str]) {
    match keys {
        [] => {}
        [last] => drop(table.entries.remove(*last)),
        [first, rest @ ..] => {
            if let Some(Value::Table(inner)) = table
                .entries
                .get_mut(*first)
                .map(|entry| &mut entry.node.value)
            {
                remove(inner, rest);
            }
        }
    }
}

/// Puts `node` at the path `keys`; fails with the depth at which a value is in the way.
pub(super) fn insert<S: AsRef<str>>(
    table: &mut Table,
    keys: &[S],
    node: Node,
) -> Result<(), usize> {
    let Some((last, parents)) = keys.split_last() else {
        return Ok(());
    };
    let mut table = table;
    for (depth, key) in parents.iter().enumerate() {
        let empty = Node {
            value: Value::Table(Table::default()),
            span: node.span.clone(),
        };
        let entry = Entry {
            key: node.span.clone(),
            node: empty,
        };
        let entry = table
            .entries
            .entry(key.as_ref().to_string())
            .or_insert(entry);
        make_room(&mut entry.node);
        match &mut entry.node.value {
            Value::Table(inner) if inner.wrapped().is_none() => table = inner,
            _ => return Err(depth),
        }
    }
    if let Some(Entry {
        node: Node {
            value: Value::Table(options),
            ..
        },
        ..
    }) = table.entries.get_mut(last.as_ref())
    {
        // A word for a table names one of its options; what the file says about it stays.
        if matches!(node.value, Value::Text(_)) && options.wrapped().is_none() {
            options.choice = Some(Box::new(node));
            return Ok(());
        }
    }
    table.entries.insert(
        last.as_ref().to_string(),
        Entry {
            key: node.span.clone(),
            node,
        },
    );
    Ok(())
}

/// Turns a word, which may name an option, into a table that can hold that option's keys. The file's
/// word gives way to the assigned key, an assigned word is kept.
pub(super) fn make_room(node: &mut Node) {
    if is_word(node) {
        let choice = node.span.is_set().then(|| Box::new(node.clone()));
        node.value = Value::Table(Table {
            entries: BTreeMap::new(),
            choice,
        });
    }
}

/// Whether the value is a word, in either of the two forms of a value.
pub(super) fn is_word(node: &Node) -> bool {
    match &node.value {
        Value::Text(_) => true,
        Value::Table(table) => table
            .wrapped()
            .is_some_and(|node| matches!(node.value, Value::Text(_))),
        _ => false,
    }
}
