//! Columns of a table to the options of `cvtcycle new`.

use std::collections::BTreeMap;

use cvtcycle_config::bounded::{self, TOML};
use cvtcycle_config::setup::new_car::NUMBERS;
use cvtcycle_config::{Problem, Problems, decode};
use indexmap::IndexMap;
use serde::Deserialize;

/// Options of `new` that are words.
pub(crate) const WORDS: [&str; 7] = [
    "title",
    "like",
    "class",
    "box",
    "engine",
    "engine-year",
    "engine-like",
];

/// Columns of a table that give the numbers of a car.
///
/// A value is made of text and columns: `"{test_weight_lb}lb"`; `{years:4}` has the first four characters of the cell. A value with an empty
/// cell is left out.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ColumnMap {
    /// Column of the cars' names.
    pub id: String,
    /// Column with the name of the car that a car is a pair with: the same car with another box.
    pub pair: Option<String>,
    /// Columns by which errors are grouped.
    #[serde(default)]
    pub groups: Vec<String>,
    /// Columns that are not read.
    #[serde(default)]
    pub unused: Vec<String>,
    /// Options of `cvtcycle new`, without the dashes before them.
    #[serde(default)]
    pub new: IndexMap<String, String>,
    /// For words in a column what they mean.
    #[serde(default)]
    pub words: BTreeMap<String, BTreeMap<String, String>>,
    /// Options that a test has of its own.
    #[serde(default)]
    pub tests: BTreeMap<String, IndexMap<String, String>>,
    /// True for a table whose columns are named by the options themselves.
    #[serde(skip)]
    is_own: bool,
}

impl ColumnMap {
    /// A table whose columns are named by the options of `cvtcycle new` (`mass`, `f0`, `n_over_v`), each cell with its unit or in that of the option.
    #[must_use]
    pub fn own() -> Self {
        ColumnMap {
            id: "carid".to_owned(),
            pair: Some("manual_carid".to_owned()),
            is_own: true,
            ..ColumnMap::default()
        }
    }

    /// The map `epa`, or that of a TOML file.
    ///
    /// # Errors
    /// A file that cannot be read, or is no map.
    pub fn open(word: &str) -> Result<Self, Problems> {
        if word == "epa" {
            return Self::read("embedded:epa.toml", include_str!("../data/epa.toml"));
        }
        if !cvtcycle_config::embedded::is_path(word) {
            let problem =
                Problem::unknown_name(format!("there is no map named `{word}`")).value(word);
            return Err(problem
                .allowed("epa, or the path of a TOML file")
                .hint("a path needs a / or an ending")
                .into());
        }
        let bytes = bounded::read(std::path::Path::new(word), TOML).map_err(|error| {
            Problem::unreadable(format!("cannot read `{word}`: {error}"))
                .value(word)
                .allowed(error.allowed("a readable file"))
        })?;
        Self::read(word, &decode(word, &bytes)?)
    }

    fn read(file: &str, text: &str) -> Result<Self, Problems> {
        let map: ColumnMap = toml::from_str(text).map_err(|error| {
            Problem::invalid(format!("this is no map of columns: {}", error.message()))
                .in_file(file)
        })?;
        let mut problems = Problems::new();
        let tests = map.tests.values().flat_map(IndexMap::keys);
        for option in map
            .new
            .keys()
            .chain(tests)
            .filter(|option| !is_option(option))
        {
            let problem = Problem::unknown_name(format!("`cvtcycle new` has no option `{option}`"))
                .in_file(file);
            problems.push(
                problem
                    .key(option.as_str())
                    .allowed(options().collect::<Vec<_>>().join(", ")),
            );
        }
        problems.finish().map(|()| map)
    }

    /// Template of each option that the columns of a table give.
    pub(crate) fn options_of(&self, names: &[String]) -> IndexMap<String, String> {
        if !self.is_own {
            return self.new.clone();
        }
        let named = names.iter().filter_map(|name| {
            let (plain, unit) = heading(name);
            let option = plain.replace('_', "-");
            is_option(&option).then(|| (option, format!("{{{name}}}{unit}")))
        });
        named.collect()
    }

    /// True for a column that the map reads or names.
    pub(crate) fn knows(&self, name: &str) -> bool {
        let is_in = |template: &String| {
            template.contains(&format!("{{{name}}}")) || template.contains(&format!("{{{name}:"))
        };
        let words = self.words.values().flat_map(BTreeMap::values);
        let tests = self.tests.values().flat_map(IndexMap::values);
        name == self.id
            || self.pair.as_deref() == Some(name)
            || self
                .groups
                .iter()
                .chain(&self.unused)
                .any(|own| own == name)
            || self.new.values().chain(words).chain(tests).any(is_in)
            || self.is_own && is_option(&heading(name).0.replace('_', "-"))
    }

    /// The text of a template in a row; `None` where a cell is empty.
    ///
    /// # Errors
    /// A sentence on a column that the table does not have, or on a word that the map does not know.
    pub(crate) fn fill(
        &self,
        template: &str,
        cell: &dyn Fn(&str) -> Option<String>,
    ) -> Result<Option<String>, String> {
        let mut text = String::new();
        let mut rest = template;
        while let Some((before, behind)) = rest.split_once('{') {
            let Some((inner, after)) = behind.split_once('}') else {
                return Err(format!("`{template}` has a {{ without }}"));
            };
            text += before;
            let (name, length) = match inner.rsplit_once(':') {
                Some((name, length)) if length.parse::<usize>().is_ok() => {
                    (name, length.parse().ok())
                }
                _ => (inner, None),
            };
            let Some(value) = cell(name) else {
                return Err(format!("the table has no column `{name}`"));
            };
            if value.is_empty() {
                return Ok(None);
            }
            let value = match length {
                Some(length) => value.chars().take(length).collect(),
                None => value,
            };
            let value = match self.words.get(name) {
                Some(words) => {
                    let Some(meaning) = words.get(&value) else {
                        let known: Vec<&str> = words.keys().map(String::as_str).collect();
                        return Err(format!("{name}: `{value}` is none of {}", known.join(", ")));
                    };
                    match self.fill(meaning, cell)? {
                        Some(meaning) => meaning,
                        None => return Ok(None),
                    }
                }
                None => value,
            };
            // A cell with a unit of its own keeps it.
            let has_unit = value.ends_with(|c: char| c.is_ascii_alphabetic())
                && value.starts_with(|c: char| c.is_ascii_digit() || c == '-');
            text += &value;
            rest = if has_unit {
                after.trim_start_matches(|c: char| !c.is_whitespace() && c != '{')
            } else {
                after
            };
        }
        Ok(Some(text + rest))
    }
}

/// Name and unit of a heading such as `mass [lb]`.
fn heading(name: &str) -> (&str, &str) {
    match name.strip_suffix(']').and_then(|name| name.split_once('[')) {
        Some((name, unit)) => (name.trim(), unit),
        None => (name, ""),
    }
}

fn options() -> impl Iterator<Item = &'static str> {
    NUMBERS.iter().map(|(name, _)| *name).chain(WORDS)
}

pub(crate) fn is_option(name: &str) -> bool {
    options().any(|own| own == name)
}
