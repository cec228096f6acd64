//! A parsed text in which every value knows its place (`shape`, `syntax`: what is no TOML; `units`: numbers with units), and the overrides put into it.

mod assigned;
mod entries;
pub(crate) mod overrides;
mod shape;
pub(crate) mod syntax;
pub(crate) mod target;
pub(crate) mod units;

use std::cell::Cell;
use std::ops::Range;
use std::sync::Arc;

use toml::de::{DeInteger, DeTable, DeValue};

use self::entries::Entries;
use self::shape::Excess;
use crate::problem::place::{Input, Place};
use crate::problem::source::{MAX_VALUE, Parent, Source, shortened};
use crate::problem::{Problem, Problems};

/// Origin of a value that an override has set.
pub(crate) const OVERRIDE: &str = "override";

/// A stretch of one source, in bytes.
#[derive(Clone, Debug)]
pub(crate) struct Span {
    pub source: usize,
    /// True if that source is an override rather than a file.
    pub is_override: bool,
    pub range: Range<usize>,
}

impl Span {
    /// True if it comes from an override rather than from a file.
    pub fn is_set(&self) -> bool {
        self.is_override
    }
}

/// A value with its place.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub value: Value,
    pub span: Span,
}

impl Node {
    /// Changes its place and those of all that is in it.
    pub fn each_span(&mut self, change: &impl Fn(&mut Span)) {
        change(&mut self.span);
        self.value.each_span(change);
    }

    /// The value itself where it is of the form `{ value = …, status = … }`.
    pub fn inner(&self) -> &Node {
        match &self.value {
            Value::Table(table) => table.wrapped().unwrap_or(self),
            _ => self,
        }
    }
}

/// A TOML value; integers too large for 64 bits are kept as floating-point numbers.
#[derive(Clone, Debug)]
pub(crate) enum Value {
    Text(String),
    Integer(i64),
    Float(f64),
    Boolean(bool),
    Date,
    List(Vec<Node>),
    Table(Table),
}

impl Value {
    /// Name of the type, for "expected …, found …".
    pub fn kind(&self) -> &'static str {
        match self {
            Value::Text(_) => "text",
            Value::Integer(_) => "an integer",
            Value::Float(_) => "a number",
            Value::Boolean(_) => "a boolean",
            Value::Date => "a date",
            Value::List(_) => "a list",
            Value::Table(_) => "a table",
        }
    }

    /// A number as a file would have it: a whole one as an integer.
    pub fn from_number(number: f64) -> Value {
        const MAX: f64 = 9e18; // below the largest integer
        let whole = number.trunc();
        if whole.to_bits() == number.to_bits() && (-MAX..=MAX).contains(&whole) {
            Value::Integer(whole as i64)
        } else {
            Value::Float(number)
        }
    }

    /// Changes the places of all that is in it.
    pub fn each_span(&mut self, change: &impl Fn(&mut Span)) {
        match self {
            Value::List(items) => items.iter_mut().for_each(|item| item.each_span(change)),
            Value::Table(table) => table.each_span(change),
            _ => {}
        }
    }
}

/// A table: its entries, and the option that an assignment names for it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Table {
    pub entries: Entries,
    pub choice: Option<Box<Node>>,
}

impl Table {
    /// The value of the form `{ value = …, status = … }`.
    pub fn wrapped(&self) -> Option<&Node> {
        self.entries.get("value").map(|entry| &entry.node)
    }

    /// Changes the places of all that is in it.
    pub fn each_span(&mut self, change: &impl Fn(&mut Span)) {
        for entry in self.entries.values_mut() {
            change(&mut entry.key);
            entry.node.each_span(change);
        }
        if let Some(choice) = &mut self.choice {
            choice.each_span(change);
        }
    }

    /// The node at a path of tables in it.
    pub fn node(&self, path: &[&str]) -> Option<&Node> {
        let (first, rest) = path.split_first()?;
        let node = &self.entries.get(first)?.node;
        match &node.value {
            _ if rest.is_empty() => Some(node),
            Value::Table(inner) => inner.node(rest),
            _ => None,
        }
    }

    /// The table at a path of tables in it.
    pub fn inner_mut(&mut self, path: &[Box<str>]) -> Option<&mut Table> {
        path.iter().try_fold(self, |table, key| {
            match &mut table.entries.get_mut(key)?.node.value {
                Value::Table(inner) => Some(inner),
                _ => None,
            }
        })
    }

    /// True if an override reaches into it.
    pub fn is_touched(&self) -> bool {
        self.entries.values().any(|entry| match &entry.node.value {
            Value::Table(table) => entry.node.span.is_set() || table.is_touched(),
            _ => entry.node.span.is_set(),
        })
    }
}

/// A key's place and its value.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    pub key: Span,
    pub node: Node,
}

/// A parsed input with the place of every value.
#[derive(Clone, Debug)]
pub struct Document {
    pub(crate) sources: Vec<Arc<Source>>,
    pub(crate) root: Table,
    /// Header of the table, where the document is one item of a list ([`Document::take_tables`]).
    pub(crate) header: Option<Span>,
    /// `[[NAME]]` of a table of a list.
    pub(crate) title: Option<String>,
}

impl Document {
    /// Parses `text`; `file` is the name to show in messages.
    ///
    /// # Errors
    /// All places where the text is not valid TOML, at most one per line; beyond some number the rest is counted. One problem where the
    /// text has more tables or is nested deeper than any input could be.
    pub fn parse(file: &str, text: &str) -> Result<Document, Problems> {
        Document::from_source(Source::new(Input::File(file.to_owned()), text))
    }

    /// Parses the text of a source.
    ///
    /// # Errors
    /// As [`Document::parse`].
    pub(crate) fn from_source(source: Source) -> Result<Document, Problems> {
        if let Some(excess) = shape::excess(&source.text) {
            return Err(too_much(&source, excess).into());
        }
        let (table, errors) = DeTable::parse_recoverable(&source.text);
        if !errors.is_empty() {
            return Err(syntax::problems(&source, &errors));
        }
        let levels = Levels::default();
        let root = levels.table(table.get_ref(), 0);
        match levels.too_deep.take() {
            Some(at) => Err(nested(&source, at).into()),
            None => Ok(Document {
                sources: vec![Arc::new(source)],
                root,
                header: None,
                title: None,
            }),
        }
    }

    /// Takes the tables of the list `key` (`[[key]]`) out, each as a document of its own with its places in this text. What is not a
    /// list of tables stays, so that reading the rest reports it.
    pub fn take_tables(&mut self, key: &str) -> Vec<Document> {
        let is_table = |node: &Node| matches!(node.value, Value::Table(_));
        let all = |entry: &Entry| matches!(&entry.node.value, Value::List(items) if items.iter().all(is_table));
        if !self.root.entries.get(key).is_some_and(all) {
            return Vec::new();
        }
        let Some(Entry {
            node: Node {
                value: Value::List(items),
                ..
            },
            ..
        }) = self.root.entries.remove(key)
        else {
            return Vec::new();
        };
        let document = |item: Node| match item.value {
            Value::Table(root) => Some(Document {
                sources: self.sources.clone(),
                root,
                header: Some(item.span),
                title: Some(format!("[[{key}]]")),
            }),
            _ => None,
        };
        items.into_iter().filter_map(document).collect()
    }

    /// Place of a span.
    pub(crate) fn place(&self, span: &Span) -> Place {
        self.sources[span.source].place(span.range.clone())
    }

    /// Relation of the source of a span to the file, if the file inherits from it.
    pub(crate) fn parent(&self, span: &Span) -> Option<&Parent> {
        self.sources[span.source].parent.as_ref()
    }

    /// From where a value comes: its line in the file, the class or car that it is inherited from, or an override.
    pub(crate) fn from(&self, span: &Span) -> String {
        match self.parent(span) {
            _ if span.is_set() => OVERRIDE.to_owned(),
            Some(parent) => parent.from.clone(),
            None => {
                let line = self.sources[span.source].line_number(&span.range);
                format!("line {line}")
            }
        }
    }

    /// The text of a span as written.
    pub(crate) fn written(&self, span: &Span) -> &str {
        self.sources[span.source]
            .text
            .get(span.range.clone())
            .unwrap_or_default()
    }

    /// The text of a span as it is repeated in a problem: cut where it is long.
    pub(crate) fn shown(&self, span: &Span) -> String {
        shortened(self.written(span), MAX_VALUE)
    }
}

fn too_much(source: &Source, excess: Excess) -> Problem {
    let file =
        "is this the file that was meant? measured values belong into a CSV file that it names";
    let key = "a dotted key is `table.table.key`; text is written in quotes";
    let (at, limit, what, message, hint) = match excess {
        Excess::Tables(at) => (
            at,
            shape::MAX_TABLES,
            "tables",
            "the file has too many tables",
            file,
        ),
        Excess::Keys(at) => (
            at,
            shape::MAX_KEYS,
            "keys",
            "the file has too many keys",
            file,
        ),
        Excess::Names(at) => (
            at,
            shape::MAX_NAMES,
            "names",
            "this key has too many names",
            key,
        ),
    };
    Problem::too_large(message)
        .at(source.place(at..at + 1))
        .allowed(format!("up to {limit} {what}"))
        .hint(hint)
}

fn nested(source: &Source, at: usize) -> Problem {
    Problem::too_large("tables and lists are nested too deep here")
        .at(source.place(at..at + 1))
        .allowed(format!("up to {} levels", shape::MAX_LEVELS))
        .hint("is a bracket too many open?")
}

/// The value of an override, as of the first source; what is nested too deep is left out, which a command line hardly can be.
pub(crate) fn convert(value: &DeValue<'_>) -> Value {
    Levels::default().value(value, 0)
}

/// The parser's values to those that are kept, down to the deepest level.
#[derive(Default)]
struct Levels {
    /// The first byte below it.
    too_deep: Cell<Option<usize>>,
}

impl Levels {
    fn value(&self, value: &DeValue<'_>, level: usize) -> Value {
        match value {
            DeValue::String(text) => Value::Text(text.to_string()),
            DeValue::Integer(integer) => convert_integer(integer),
            DeValue::Float(float) => Value::Float(float.as_str().parse().unwrap_or(f64::NAN)),
            DeValue::Boolean(boolean) => Value::Boolean(*boolean),
            DeValue::Datetime(_) => Value::Date,
            DeValue::Array(items) => {
                Value::List(items.iter().map(|item| self.node(item, level)).collect())
            }
            DeValue::Table(table) => Value::Table(self.table(table, level)),
        }
    }

    fn node(&self, value: &toml::Spanned<DeValue<'_>>, level: usize) -> Node {
        let span = file_span(value.span());
        let value = if level < shape::MAX_LEVELS {
            self.value(value.get_ref(), level + 1)
        } else {
            let first = self.too_deep.get().or(Some(span.range.start));
            self.too_deep.set(first);
            Value::Date
        };
        Node { value, span }
    }

    fn table(&self, table: &DeTable<'_>, level: usize) -> Table {
        let entries = table.iter().map(|(key, value)| {
            let entry = Entry {
                key: file_span(key.span()),
                node: self.node(value, level),
            };
            (key.get_ref().to_string(), entry)
        });
        Table {
            entries: entries.collect(),
            choice: None,
        }
    }
}

fn file_span(range: Range<usize>) -> Span {
    Span {
        source: 0,
        is_override: false,
        range,
    }
}

fn convert_integer(integer: &DeInteger<'_>) -> Value {
    match i64::from_str_radix(integer.as_str(), integer.radix()) {
        Ok(value) => Value::Integer(value),
        Err(_) => Value::Float(integer.as_str().parse().unwrap_or(f64::INFINITY)),
    }
}
