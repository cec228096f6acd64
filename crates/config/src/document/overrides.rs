//! Overrides: values put over those of the files. The text `KEY=VALUE` is parsed once.
use std::collections::HashMap;
use std::fmt;
use std::str::FromStr;
use std::sync::{Arc, OnceLock};

use serde::{Serialize, Serializer};
use toml::de::DeValue;

use crate::document::{Node, Span, Value, convert};
use crate::problem::place::Input;
use crate::problem::{Problem, Problems};
use cvtcycle_model::files;
use cvtcycle_model::keys::{Key, Table};

/// Dotted key, taken apart.
pub type KeyPath = Arc<[Box<str>]>;

/// Tables that a key may be nested in; more than any input has, few enough to recurse over.
const MAX_DEPTH: usize = 32;

/// The file that an override goes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Target {
    /// The vehicle.
    Vehicle,
    /// The transmission oil: keys that begin with `lubricant.`.
    Lubricant,
    /// The engine oil: keys that begin with `engine_oil.`.
    EngineOil,
    /// The transmission rig: keys that begin with `rig.`.
    Rig,
}

impl Target {
    /// The files of a car.
    pub const CAR: [Target; 3] = [Target::Vehicle, Target::Lubricant, Target::EngineOil];

    /// What its keys begin with, besides their path in the file.
    #[must_use]
    pub const fn prefix(self) -> &'static str {
        match self {
            Target::Lubricant => "lubricant.",
            Target::EngineOil => "engine_oil.",
            Target::Vehicle | Target::Rig => "",
        }
    }

    /// The file of a key, and the key in it.
    #[must_use]
    pub fn of(key: &str) -> (Target, &str) {
        let fluid = |target: Target| Some((target, key.strip_prefix(target.prefix())?));
        let fluids = fluid(Target::Lubricant).or_else(|| fluid(Target::EngineOil));
        fluids.unwrap_or(match key.starts_with("rig.") {
            true => (Target::Rig, key),
            false => (Target::Vehicle, key),
        })
    }
}

/// A value put over that of a file.
///
/// ```
/// use cvtcycle_config::Override;
/// let offset: Override = "transmission.cvt.belt.band_offset_mm=2".parse()?;
/// assert_eq!(offset.row().unwrap().quantity.unit(), "mm");
/// assert_eq!(offset, Override::number("transmission.cvt.belt.band_offset_mm", 2.0));
/// # Ok::<(), cvtcycle_config::Problem>(())
/// ```
#[derive(Clone)]
pub struct Override {
    /// `KEY=VALUE` as given.
    text: String,
    key: String,
    target: Target,
    path: KeyPath,
    row: Option<&'static Key<'static>>,
    /// With its places in the text of the value.
    value: Value,
    value_text: String,
}

impl Override {
    /// Sets a key to the text of a value, which is TOML, or else taken as text without quotes.
    ///
    /// # Errors
    /// The key has an empty or too many names, or the value is empty.
    pub fn new(key: &str, value: &str) -> Result<Override, Problem> {
        Override::read(&format!("{key}={value}"), key.trim(), value.trim())
    }

    /// Sets a key to a number in the key's unit.
    #[must_use]
    pub fn number(key: &str, number: f64) -> Override {
        // TOML has its own word for what is no number.
        let text = if number.is_nan() {
            "nan".to_owned()
        } else {
            number.to_string()
        };
        Override::of(
            format!("{key}={text}"),
            key.trim(),
            &text,
            Value::of(number),
        )
    }

    /// Parses texts `KEY=VALUE`.
    ///
    /// # Errors
    /// All texts that are none.
    pub fn parse_all<S: AsRef<str>>(texts: &[S]) -> Result<Vec<Override>, Problems> {
        let mut problems = Problems::new();
        let parse = |text: &S| problems.take(text.as_ref().parse::<Override>());
        let all = texts.iter().filter_map(parse).collect();
        problems.finish().map(|()| all)
    }

    fn read(text: &str, key: &str, value: &str) -> Result<Override, Problem> {
        let names = key.split('.');
        if names.clone().any(|name| name.trim().is_empty()) || names.count() > MAX_DEPTH {
            return Err(no_override(text, key, format!("`{key}` is no key")));
        }
        if value.is_empty() {
            return Err(no_override(text, key, format!("no value for `{key}`")));
        }
        let parsed = match DeValue::parse(value) {
            Ok(parsed) => convert(parsed.get_ref()),
            Err(_) => Value::Text(value.to_owned()),
        };
        Ok(Override::of(text.to_owned(), key, value, parsed))
    }

    fn of(text: String, key: &str, value_text: &str, value: Value) -> Override {
        let (target, own) = Target::of(key);
        Override {
            text,
            key: key.to_owned(),
            target,
            path: path_of(own),
            row: row(key),
            value,
            value_text: value_text.to_owned(),
        }
    }

    /// Dotted key with the prefix of its file.
    #[must_use]
    pub fn key(&self) -> &str {
        &self.key
    }

    /// The file that it goes to.
    #[must_use]
    pub fn target(&self) -> Target {
        self.target
    }

    /// Text of the value.
    #[must_use]
    pub fn value(&self) -> &str {
        &self.value_text
    }

    /// The row of the key in the model's tables; none of an unknown key.
    #[must_use]
    pub fn row(&self) -> Option<&'static Key<'static>> {
        self.row
    }

    /// Key in its file, taken apart.
    pub(crate) fn path(&self) -> &KeyPath {
        &self.path
    }

    /// As the input of a place.
    #[must_use]
    pub fn input(&self) -> Input {
        Input::Override(self.text.clone())
    }

    /// The value as a part of a document, whose source of that index has the text of the value.
    pub(crate) fn node(&self, source: usize) -> Node {
        let mut node = Node {
            value: self.value.clone(),
            span: Span {
                source,
                is_override: true,
                range: 0..self.value_text.len(),
            },
        };
        node.each_span(&|span| (span.source, span.is_override) = (source, true));
        node
    }
}

/// The names of a dotted key.
pub(crate) fn path_of(key: &str) -> KeyPath {
    key.split('.').map(|name| name.trim().into()).collect()
}

/// The row of a key, with the prefix of its file; none of an unknown key.
fn row(key: &str) -> Option<&'static Key<'static>> {
    static ROWS: OnceLock<HashMap<String, &'static Key<'static>>> = OnceLock::new();
    let known = ROWS.get_or_init(|| rows().collect());
    let own = key.strip_prefix(Target::EngineOil.prefix());
    let key = own.map_or_else(
        || key.to_owned(),
        |own| format!("{}{own}", Target::Lubricant.prefix()),
    );
    known.get(&key).copied()
}

/// The rows of all tables with their dotted keys.
pub(crate) fn rows() -> impl Iterator<Item = (String, &'static Key<'static>)> {
    let tables = [
        ("", files::VEHICLE),
        (Target::Lubricant.prefix(), files::LUBRICANT),
        ("", files::RIG),
    ];
    let tables = tables.into_iter();
    tables.flat_map(|(prefix, table)| rows_of(prefix, &table))
}

/// The rows of a table with their dotted keys.
pub(crate) fn rows_of(prefix: &str, table: &Table) -> Vec<(String, &'static Key<'static>)> {
    let mut rows = Vec::new();
    table.walk("", &mut |path, key| {
        rows.push((format!("{prefix}{path}"), key))
    });
    rows
}

fn no_override(text: &str, key: &str, message: String) -> Problem {
    Problem::syntax(message)
        .at(Input::Override(text.to_owned()))
        .key(key)
        .allowed("KEY=VALUE")
        .hint("write, for example, \"road_load.mass_kg=1250\"")
}

impl FromStr for Override {
    type Err = Problem;

    /// Parses `KEY=VALUE`.
    fn from_str(text: &str) -> Result<Override, Problem> {
        let (key, value) = text
            .split_once('=')
            .ok_or_else(|| no_override(text, "", "no `=` in the assignment".to_owned()))?;
        Override::read(text, key.trim(), value.trim())
    }
}

impl PartialEq for Override {
    fn eq(&self, other: &Override) -> bool {
        self.text == other.text
    }
}

impl fmt::Display for Override {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl fmt::Debug for Override {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.text)
    }
}

impl Serialize for Override {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.text)
    }
}
