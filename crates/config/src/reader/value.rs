//! Common parts of reading any kind of value: look-up, origin, registration, problems.
use std::fmt::Display;

use crate::document::syntax::number_with_unit;
use crate::document::units::{decimal_comma, number_hint};
use crate::document::{Node, Span, Value};
use crate::problem::Problem;
use crate::problem::near::suggest;
use crate::problem::place::Place;
use crate::reader::log::KeyInfo;
use crate::reader::origin::{COLUMNS, Found};
use crate::reader::path::join;
use crate::reader::section::Section;
use cvtcycle_model::keys::{Bound, Key, Kind, Presence, Quantity};

/// Value at a key.
pub(crate) enum Lookup<'r> {
    Absent,
    /// Something that is no value; reported already.
    Bad,
    Found(Found<'r>),
}

/// Hint for a number in quotes, for a key with a unit.
fn text_hint(text: &str, of: &str) -> String {
    if let Some((_, point)) = decimal_comma(text).filter(|(length, _)| *length == text.len()) {
        format!("write {point} with a decimal point and without quotes")
    } else if let Some((figure, unit)) = number_with_unit(text) {
        number_hint(figure, unit, of)
    } else if text.trim().parse::<f64>().is_ok() {
        format!("write {} without quotes", text.trim())
    } else {
        String::new()
    }
}

impl<'r> Section<'r> {
    /// The number in SI units; an error says whether the key is absent (else it is reported already).
    pub(crate) fn read_number(&self, key: &Key<'_>, allowed: Bound) -> Result<f64, bool> {
        match self.open(key) {
            Lookup::Found(found) => {
                let value = self
                    .check_number(key.name, || key.quantity, found.node, allowed)
                    .ok_or(false)?;
                let si = key.quantity.to_si(value);
                self.given(key.name, &found, value, Some(si));
                Ok(si)
            }
            Lookup::Absent => Err(true),
            Lookup::Bad => Err(false),
        }
    }

    pub(crate) fn read_text(&self, key: &Key<'_>) -> Result<String, bool> {
        match self.open(key) {
            Lookup::Found(found) => match &found.node.value {
                Value::Text(text) => {
                    self.given(key.name, &found, text, None);
                    Ok(text.clone())
                }
                _ => {
                    self.wrong_type(key.name, found.node, "text");
                    Err(false)
                }
            },
            Lookup::Absent => Err(true),
            Lookup::Bad => Err(false),
        }
    }

    /// The name of a CSV file and its columns as the user says; an error as of [`Section::read_text`].
    pub(crate) fn read_csv_name(&self, key: &Key<'_>) -> Result<(String, &'r str), bool> {
        let text = self.read_text(key)?;
        let entry = self.table.and_then(|table| table.entries.get(key.name));
        let Some(Value::Table(table)) = entry.map(|entry| &entry.node.value) else {
            return Ok((text, ""));
        };
        let columns = table.entries.get(COLUMNS).map(|own| &own.node.value);
        Ok(match columns {
            Some(Value::Text(columns)) => (text, columns),
            _ => (text, ""),
        })
    }

    /// A finite number within its range, in its own unit, which only a problem names.
    pub(crate) fn check_number(
        &self,
        key: &str,
        quantity: impl FnOnce() -> Quantity,
        node: &Node,
        allowed: Bound,
    ) -> Option<f64> {
        let value = match &node.value {
            Value::Integer(value) => *value as f64,
            Value::Float(value) => *value,
            _ => {
                self.wrong_type(key, node, "a number");
                return None;
            }
        };
        if allowed.contains(value) {
            return Some(value);
        }
        let range = allowed.in_unit(quantity().unit());
        if value.is_finite() {
            self.report_out_of_range(key, node, &range);
        } else {
            let message = format!("`{}` is not a finite number", join(&self.path, key));
            let problem = Problem::out_of_range(message).names_key().allowed(range);
            self.report(&node.span, key, problem);
        }
        None
    }

    /// Looks a key up, counts it as read and as known, and unwraps `{ value = …, status = … }`.
    pub(crate) fn open(&self, key: &Key<'_>) -> Lookup<'r> {
        self.register(key);
        let Some(entry) = self.table.and_then(|table| table.entries.get(key.name)) else {
            return Lookup::Absent;
        };
        self.unwrap(key.name, &entry.node, matches!(key.kind, Kind::Csv))
    }

    /// Counts a key as read and as known.
    pub(crate) fn register(&self, key: &Key<'_>) {
        self.reader.record(|log| {
            let path = join(&self.path, key.name);
            log.register(KeyInfo {
                key: path.clone(),
                unit: key.unit(),
                allowed: key.allowed(),
                is_number: key.is_number(),
                doc: key.doc.to_string(),
                labels: key.labels,
                ..KeyInfo::default()
            });
            log.read.insert(path);
        });
    }

    /// The value with its origin, from either of its two forms; `is_csv` where it names a CSV file.
    pub(crate) fn unwrap(&self, key: &str, node: &'r Node, is_csv: bool) -> Lookup<'r> {
        let mut found = Found::new(self.reader.document, node, "user");
        let Value::Table(table) = &node.value else {
            return Lookup::Found(found);
        };
        let Some(value) = table.wrapped() else {
            let message = format!("`{}` is a table without `value`", join(&self.path, key));
            let hint = "write `KEY = VALUE` or `KEY = { value = VALUE, status = \"…\" }`";
            let problem = Problem::wrong_type(message).names_key().hint(hint);
            self.report(&node.span, key, problem);
            return Lookup::Bad;
        };
        found.node = value;
        let own = self.origin(key, table, is_csv);
        let is_inherited = self.reader.document.parent(&node.span).is_some();
        found.add(own, is_inherited && found.status != "set");
        Lookup::Found(found)
    }

    /// Completes what is known about a key with the value that was given.
    pub(crate) fn given(&self, key: &str, found: &Found<'_>, value: impl Display, si: Option<f64>) {
        self.fill(key, |info| {
            (info.value, info.si) = (value.to_string(), si);
            info.status = found.status.to_string();
            info.source = found.source.to_string();
            info.note = found.note.to_string();
            info.range = found.range;
            info.from = self.reader.document.from(&found.node.span);
        });
    }

    /// Completes what is known about a key with its default.
    pub(crate) fn defaulted(&self, key: &str, value: impl Display, si: Option<f64>) {
        self.fill(key, |info| {
            (info.value, info.si) = (value.to_string(), si);
            info.status = "default".to_string();
            info.from = "default".to_string();
        });
    }

    fn fill(&self, key: &str, write: impl FnOnce(&mut KeyInfo)) {
        self.reader
            .record(|log| log.info(&join(&self.path, key)).map_or((), write));
    }

    pub(crate) fn report_out_of_range(&self, key: &str, node: &Node, allowed: &str) {
        let message = format!("`{}` is out of range", join(&self.path, key));
        let problem = Problem::out_of_range(message).names_key().allowed(allowed);
        self.report(&node.span, key, problem);
    }

    pub(crate) fn wrong_type(&self, key: &str, node: &Node, expected: &str) {
        let (path, found) = (self.dotted(key), node.value.kind());
        let message = format!("`{path}`: expected {expected}, found {found}");
        // Unit and range that the key was registered with, the range where the message does not say it already.
        let (mut allowed, mut unit) = (String::new(), String::new());
        self.reader.record(|log| {
            let Some(info) = log.info(&join(&self.path, key)) else {
                return;
            };
            unit.clone_from(&info.unit);
            if info.allowed != expected {
                allowed.clone_from(&info.allowed);
            }
        });
        let hint = self.type_hint((key, &unit), node, expected);
        let problem = Problem::wrong_type(message).names_key();
        let problem = problem.allowed(allowed).hint(hint);
        self.report(&node.span, key, problem);
    }

    /// Reports a word that is none of those that the key knows.
    pub(crate) fn unknown_word(&self, key: &Key<'_>, span: &Span, word: &str) {
        let message = format!("`{word}` is not known for `{}`", join(&self.path, key.name));
        let hint = suggest(word, &options(key).collect::<Vec<_>>());
        let problem = Problem::unknown_name(message).names_key();
        self.report(span, key.name, problem.allowed(key.allowed()).hint(hint));
    }

    /// Path of a key of this table, or of one in a table within it.
    fn dotted(&self, key: &str) -> String {
        key.split('.')
            .fold(self.path.clone(), |path, name| join(&path, name))
    }

    /// Hint for a value of another type.
    fn type_hint(&self, (key, unit): (&str, &str), node: &Node, expected: &str) -> String {
        let written = self.reader.document.written(&node.span);
        match &node.value {
            Value::Text(text) if expected.contains("number") || expected.contains("integer") => {
                text_hint(text, unit)
            }
            Value::Text(_) if expected == "true or false" => {
                format!("write `{key} = true` or `{key} = false`, without quotes")
            }
            Value::Table(_) | Value::List(_) if expected == "text" => {
                "write one text in quotes".to_string()
            }
            _ if expected == "text" => format!("write it in quotes: \"{written}\""),
            _ if expected == "a table" && node.span.is_set() => {
                format!("set one of its keys: {}.KEY=VALUE", self.dotted(key))
            }
            _ if expected == "a table" => format!(
                "write [{}] with its keys on the lines below",
                self.dotted(key)
            ),
            Value::Text(_) | Value::Integer(_) | Value::Float(_)
                if expected.starts_with("a list of") && !expected.contains("rows") =>
            {
                format!("write `{key} = [{written}]`")
            }
            _ => String::new(),
        }
    }

    /// Reports a required key that is absent.
    pub(crate) fn report_missing(&self, of: &Key<'_>) {
        let key = of.name;
        if self.muted {
            return;
        }
        self.reader.report_missing(|| {
            let table = match (self.path.as_str(), &self.reader.document.title) {
                ("", Some(title)) => format!("its {title}"),
                ("", None) => "the top of the file".to_string(),
                (path, _) => format!("[{path}]"),
            };
            let message = format!("missing key `{}`", join(&self.path, key));
            let problem = Problem::missing(message).names_key().allowed(of.allowed());
            self.absent(key, problem.hint(format!("add `{key} = …` to {table}")))
        });
    }

    /// A problem of a key that is absent: at the header of the table.
    pub(crate) fn absent(&self, key: &str, problem: Problem) -> Problem {
        let document = self.reader.document;
        let whole = || Place::from(document.sources[0].input.clone());
        let header = self.header.as_ref();
        problem
            .at(header.map_or_else(whole, |span| document.place(span)))
            .for_key(join(&self.path, key))
    }

    /// Reports a problem of a value of this table.
    pub(crate) fn report(&self, span: &Span, key: &str, problem: Problem) {
        let document = self.reader.document;
        self.reader.report(|| {
            problem
                .at(document.place(span))
                .for_key(self.dotted(key))
                .value(document.shown(span))
        });
    }
}

/// The option that a key takes when nothing is given.
pub(crate) fn default_option(key: &Key<'_>) -> Option<&'static str> {
    match key.presence {
        Presence::Word(default) => options(key).find(|option| *option == default),
        _ => None,
    }
}

/// Names of the options of a key.
pub(crate) fn options(key: &Key<'_>) -> impl Iterator<Item = &'static str> {
    let choices = match key.kind {
        Kind::Words(choices) | Kind::Options(choices) => choices,
        _ => &[],
    };
    choices.iter().map(|choice| choice.name)
}
