//! Overrides: values put over those of the files, or what is done with them: `KEY=VALUE`, `KEY*=FACTOR`, `KEY+=DIFFERENCE`. The text is
//! parsed once; a relative one has its value when it meets a document.
use std::fmt;
use std::str::FromStr;

use serde::{Serialize, Serializer};
use toml::de::DeValue;

use crate::document::target::{KeyPath, Target, path_of, row};
use crate::document::{Document, Node, Span, Value, convert};
use crate::problem::place::Input;
use crate::problem::{Problem, Problems};
use cvtcycle_model::keys::{Key, Presence};

/// Tables that a key may be nested in; more than any input has, few enough to recurse over.
const MAX_DEPTH: usize = 32;

/// Effect of a number on the value of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Acts {
    /// It is the value.
    Value,
    /// It multiplies the value.
    Scale,
    /// It is added to the value.
    Offset,
}

impl Acts {
    /// Result of the number acting on a value.
    #[must_use]
    pub fn resolved(self, base: f64, number: f64) -> f64 {
        match self {
            Acts::Value => number,
            Acts::Scale => base * number,
            Acts::Offset => base + number,
        }
    }

    /// The sign of an assignment that does it, and the way to give the key a value.
    const fn sign(self) -> &'static str {
        match self {
            Acts::Value => "=",
            Acts::Scale => "*=",
            Acts::Offset => "+=",
        }
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
    acts: Acts,
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
        let text = format!("{key}={value}");
        Override::read(&text, key.trim(), Acts::Value, value.trim())
    }

    /// Sets a key to a number in the key's unit.
    #[must_use]
    pub fn number(key: &str, number: f64) -> Override {
        let (value, text) = one(number);
        Override::from_parts(
            format!("{key}={text}"),
            (key.trim(), Acts::Value),
            &text,
            value,
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

    fn read(text: &str, key: &str, acts: Acts, value: &str) -> Result<Override, Problem> {
        let names = key.split('.');
        if names.clone().any(|name| name.trim().is_empty()) || names.count() > MAX_DEPTH {
            return Err(no_override(text, key, format!("`{key}` is no key")));
        }
        if value.is_empty() {
            return Err(no_override(text, key, format!("no value for `{key}`")));
        }
        let parsed = convert_text(value);
        let is_finite = number_of(&parsed).is_some_and(f64::is_finite);
        if acts != Acts::Value && !is_finite {
            let message = format!("`{value}` after `{}` is no number", acts.sign());
            return Err(no_override(text, key, message));
        }
        Ok(Override::from_parts(
            text.to_owned(),
            (key, acts),
            value,
            parsed,
        ))
    }

    fn from_parts(
        text: String,
        (key, acts): (&str, Acts),
        value_text: &str,
        value: Value,
    ) -> Override {
        let (target, own) = Target::from_key(key);
        Override {
            text,
            key: key.to_owned(),
            acts,
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

    /// Effect of the value on that of the file.
    #[must_use]
    pub fn acts(&self) -> Acts {
        self.acts
    }

    /// The file that it goes to.
    #[must_use]
    pub fn target(&self) -> Target {
        self.target
    }

    /// The number that it makes of the value of a file, in the key's own unit, or of the default where there is none; none where it has
    /// neither, or is no number.
    #[must_use]
    pub fn number_over(&self, base: Option<f64>) -> Option<f64> {
        let default = match self.row.map(|row| row.presence) {
            Some(Presence::Number(x)) => Some(x),
            Some(Presence::Integer(n)) => Some(n as f64),
            _ => None,
        };
        let number = number_of(&self.value)?;
        match self.acts {
            Acts::Value => Some(number),
            acts => Some(acts.resolved(base.or(default)?, number)),
        }
    }

    /// The override with the value that it makes of that of a document, each number of a list by itself.
    ///
    /// # Errors
    /// There is no value, or it is no number.
    pub(crate) fn over(&self, document: &Document) -> Result<Override, Problem> {
        if self.acts == Acts::Value {
            return Ok(self.clone());
        }
        let path: Vec<&str> = self.path.iter().map(|name| &**name).collect();
        let node = document.root.node(&path).map(Node::inner);
        let number = |node: &Node| self.number_over(Some(number_of(&node.value)?));
        let (value, value_text) = match node.map(|node| (node, &node.value)) {
            Some((_, Value::List(items))) => {
                let numbers: Option<Vec<f64>> = items.iter().map(number).collect();
                list_of(&numbers.ok_or_else(|| self.no_number())?)
            }
            Some((node, _)) => one(number(node).ok_or_else(|| self.no_number())?),
            // For the reading to say that there is no such key.
            None if self.row.is_none() => (self.value.clone(), self.value_text.clone()),
            None => one(self.number_over(None).ok_or_else(|| self.no_value())?),
        };
        Ok(Override {
            acts: Acts::Value,
            value,
            value_text,
            ..self.clone()
        })
    }

    fn no_number(&self) -> Problem {
        let (key, sign) = (&self.key, self.acts.sign());
        Problem::wrong_type(format!("`{key}` is no number that `{sign}` could change"))
            .at(self.input())
            .key(key.as_str())
            .names_key()
            .hint(format!("give it a value with {key}=VALUE"))
    }

    fn no_value(&self) -> Problem {
        let (key, sign) = (&self.key, self.acts.sign());
        Problem::missing(format!("`{key}` has no value that `{sign}` could change"))
            .at(self.input())
            .key(key.as_str())
            .names_key()
            .hint(format!("give it a value with {key}=VALUE"))
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

/// A number as a value, and its text.
fn one(number: f64) -> (Value, String) {
    // TOML has its own word for what is no number.
    let text = match number.is_nan() {
        true => "nan".to_owned(),
        false => number.to_string(),
    };
    (Value::from_number(number), text)
}

/// Numbers as a list, each with its place in the text of the list, and that text.
fn list_of(numbers: &[f64]) -> (Value, String) {
    let mut text = String::from("[");
    let mut items = Vec::with_capacity(numbers.len());
    for number in numbers {
        if !items.is_empty() {
            text += ", ";
        }
        let start = text.len();
        text += &format!("{number:?}");
        items.push(Node {
            value: Value::Float(*number),
            span: Span {
                source: 0,
                is_override: true,
                range: start..text.len(),
            },
        });
    }
    text.push(']');
    (Value::List(items), text)
}

fn number_of(value: &Value) -> Option<f64> {
    match value {
        Value::Integer(n) => Some(*n as f64),
        Value::Float(x) => Some(*x),
        _ => None,
    }
}

/// The value of a text, which is TOML, or else text without quotes.
fn convert_text(text: &str) -> Value {
    DeValue::parse(text).map_or_else(
        |_| Value::Text(text.to_owned()),
        |parsed| convert(parsed.get_ref()),
    )
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

    /// Parses `KEY=VALUE`, `KEY*=FACTOR` or `KEY+=DIFFERENCE`.
    fn from_str(text: &str) -> Result<Override, Problem> {
        let (key, value) = text
            .split_once('=')
            .ok_or_else(|| no_override(text, "", "no `=` in the assignment".to_owned()))?;
        let relative = [('*', Acts::Scale), ('+', Acts::Offset)];
        let relative = relative
            .into_iter()
            .find_map(|(sign, acts)| Some((key.strip_suffix(sign)?, acts)));
        let (key, acts) = relative.unwrap_or((key, Acts::Value));
        Override::read(text, key.trim(), acts, value.trim())
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
