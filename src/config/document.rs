//! A parsed text in which every value knows its place, and the assignments from the command line.
use std::collections::BTreeMap;
use std::ops::Range;

use toml::de::{DeInteger, DeTable, DeValue};

use super::problem::{Place, Problem};
use super::syntax;

/// One input: the file, or one assignment.
#[derive(Clone, Debug)]
pub(super) struct Source {
    pub name: String,
    pub text: String,
    /// Whether the text has lines that a user could look up.
    pub has_lines: bool,
}

/// A stretch of one source, in bytes.
#[derive(Clone, Debug)]
pub(super) struct Span {
    pub source: usize,
    pub range: Range<usize>,
}

impl Span {
    /// Whether it comes from an assignment rather than from the file.
    pub fn is_set(&self) -> bool {
        self.source > 0
    }
}

/// A value with its place.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub value: Value,
    pub span: Span,
}

/// A TOML value; integers too large for 64 bits are kept as floating-point numbers.
#[derive(Clone, Debug)]
pub(super) enum Value {
    Text(String),
    Integer(i64),
    Float(f64),
    Boolean(bool),
    Date,
    List(Vec<Node>),
    Table(Table),
}

impl Value {
    /// What it is, for "expected …, found …".
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
}

/// A table: its entries, and the option that an assignment names for it.
#[derive(Clone, Debug, Default)]
pub(super) struct Table {
    pub entries: BTreeMap<String, Entry>,
    pub choice: Option<Box<Node>>,
}

impl Table {
    /// The value of the form `{ value = …, status = … }`.
    pub fn wrapped(&self) -> Option<&Node> {
        self.entries.get("value").map(|entry| &entry.node)
    }

    /// Whether an assignment reaches into it.
    pub fn is_touched(&self) -> bool {
        self.entries.values().any(|entry| match &entry.node.value {
            Value::Table(table) => entry.node.span.is_set() || table.is_touched(),
            _ => entry.node.span.is_set(),
        })
    }
}

/// A key's place and its value.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub key: Span,
    pub node: Node,
}

/// A parsed input with the place of every value.
#[derive(Clone, Debug)]
pub struct Document {
    pub(super) sources: Vec<Source>,
    pub(super) root: Table,
    /// Header of the table that the document stands for, where it is one item of a list ([`Document::take_tables`]).
    pub(super) header: Option<Span>,
}

impl Document {
    /// Parses `text`; `file` is the name to show in messages.
    ///
    /// # Errors
    /// All places where the text is not valid TOML, at most one per line.
    pub fn parse(file: &str, text: &str) -> Result<Document, Vec<Problem>> {
        let (table, errors) = DeTable::parse_recoverable(text);
        let source = Source { name: file.to_string(), text: text.to_string(), has_lines: true };
        if !errors.is_empty() {
            return Err(syntax::problems(&source, &errors));
        }
        Ok(Document { sources: vec![source], root: convert_table(table.get_ref(), 0), header: None })
    }

    /// Takes the tables of the list `key` (`[[key]]`) out, each as a document of its own with its places in this text. What is not a
    /// list of tables stays, so that whoever reads the rest complains about it.
    pub fn take_tables(&mut self, key: &str) -> Vec<Document> {
        let is_table = |node: &Node| matches!(node.value, Value::Table(_));
        let all = |entry: &Entry| matches!(&entry.node.value, Value::List(items) if items.iter().all(is_table));
        if !self.root.entries.get(key).is_some_and(all) {
            return Vec::new();
        }
        let Some(Entry { node: Node { value: Value::List(items), .. }, .. }) = self.root.entries.remove(key) else {
            return Vec::new();
        };
        let document = |item: Node| match item.value {
            Value::Table(root) => Some(Document { sources: self.sources.clone(), root, header: Some(item.span) }),
            _ => None,
        };
        items.into_iter().filter_map(document).collect()
    }

    /// Where a span stands.
    pub(super) fn place(&self, span: &Span) -> Place {
        self.sources[span.source].place(span.range.clone())
    }

    /// The text of a span as written.
    pub(super) fn written(&self, span: &Span) -> &str {
        self.sources[span.source].text.get(span.range.clone()).unwrap_or_default()
    }
}

impl Source {
    /// The place of a stretch of the text.
    pub fn place(&self, range: Range<usize>) -> Place {
        let file = self.name.clone();
        if !self.has_lines {
            return Place { file, ..Place::default() };
        }
        let start = self.clamp(range.start);
        let line_start = self.line_start(start);
        let line_text = self.line_at(start);
        let end = self.clamp(range.end).clamp(start, line_start.max(start).max(line_start + line_text.len()));
        Place {
            file,
            line: self.text[..line_start].matches('\n').count() + 1,
            column: self.text[line_start..start].chars().count() + 1,
            line_text: line_text.to_string(),
            width: self.text[start..end].chars().count().max(1),
        }
    }

    /// Start of the line in which a byte stands.
    pub fn line_start(&self, at: usize) -> usize {
        self.text[..self.clamp(at)].rfind('\n').map_or(0, |newline| newline + 1)
    }

    /// The line in which a byte stands, without its end.
    pub fn line_at(&self, at: usize) -> &str {
        self.text[self.line_start(at)..].lines().next().unwrap_or_default()
    }

    /// The nearest earlier start of a character. The end of the text counts as the end of its last
    /// line with content, since nothing can be shown on the empty line after it.
    pub fn clamp(&self, at: usize) -> usize {
        let mut at = if at >= self.text.len() { self.text.trim_end().len() } else { at };
        while !self.text.is_char_boundary(at) {
            at -= 1;
        }
        at
    }
}

pub(super) fn convert(value: &DeValue<'_>, source: usize) -> Value {
    match value {
        DeValue::String(text) => Value::Text(text.to_string()),
        DeValue::Integer(integer) => convert_integer(integer),
        DeValue::Float(float) => Value::Float(float.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(boolean) => Value::Boolean(*boolean),
        DeValue::Datetime(_) => Value::Date,
        DeValue::Array(items) => Value::List(items.iter().map(|item| convert_node(item, source)).collect()),
        DeValue::Table(table) => Value::Table(convert_table(table, source)),
    }
}

fn convert_integer(integer: &DeInteger<'_>) -> Value {
    match i64::from_str_radix(integer.as_str(), integer.radix()) {
        Ok(value) => Value::Integer(value),
        Err(_) => Value::Float(integer.as_str().parse().unwrap_or(f64::INFINITY)),
    }
}

fn convert_node(value: &toml::Spanned<DeValue<'_>>, source: usize) -> Node {
    Node { value: convert(value.get_ref(), source), span: Span { source, range: value.span() } }
}

fn convert_table(table: &DeTable<'_>, source: usize) -> Table {
    let entries = table.iter().map(|(key, value)| {
        let entry = Entry { key: Span { source, range: key.span() }, node: convert_node(value, source) };
        (key.get_ref().to_string(), entry)
    });
    Table { entries: entries.collect(), choice: None }
}
