//! Meaning of the names of a file's columns: the column of a schema that has a name, a word and a unit, or that the user names.

use std::borrow::Cow;

use cvtcycle_model::keys::{Quantity, stem};

use super::collector::{Collector, Line};
use super::heading::{readings, unit_in, unit_named};
use super::named::{Columns, Entry};
use super::schema::{Cells, Column, Schema};
use super::text::Field;
use crate::channel::bare;
use crate::{Argument, Problem, near, suggestion};

/// A longer name is none with words and a unit.
const MAX_LEN: usize = 80;

/// Meaning found for the name of a column.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Found {
    /// This column of the schema.
    Column(usize),
    /// The word of a quantity of the schema, in a unit that is not read.
    OtherUnit(String),
    /// One of another program that is passed over.
    PassedOver,
    /// No known column.
    Nothing,
}

impl Schema {
    /// The column that a text means: its name, a word with a unit, or a unit alone where that is enough.
    #[must_use]
    pub fn column_of(&self, text: &str) -> Option<usize> {
        match self.find(text.trim(), None) {
            Found::Column(column) => Some(column),
            _ => None,
        }
    }

    /// Meaning of the name of a column, with the unit below it where there is a row of units.
    pub(super) fn find(&self, text: &str, below: Option<&str>) -> Found {
        let named = |name: &str| self.columns.iter().position(|own| own.name == name);
        if let Some(exact) = named(text) {
            // `grade` is a share, over a unit of % it is in percent.
            let other = below
                .filter(|unit| unit_named(unit).is_some() && !is_in(unit, &self.columns[exact]));
            return match other.map(|unit| self.quantity(&bare(text), Some(unit))) {
                Some(found @ Found::Column(_)) => found,
                _ => Found::Column(exact),
            };
        }
        let is_it = |written: &str| match written.strip_suffix('*') {
            Some(start) => text.starts_with(start),
            None => written == text,
        };
        let mut headings = self.foreign.headings.iter();
        if let Some((_, name)) = headings.find(|(written, _)| is_it(written)) {
            return named(name).map_or(Found::PassedOver, Found::Column);
        }
        let mut found = Found::Nothing;
        if text.len() > MAX_LEN {
            return found;
        }
        for (word, unit) in readings(text) {
            let unit = unit.or(below.map(Cow::Borrowed));
            match self.quantity(&word, unit.as_deref()) {
                Found::Nothing => {}
                other @ Found::OtherUnit(_) => found = other,
                column => return column,
            }
        }
        found
    }

    /// The column of a quantity, by its word, in a unit. Without a unit a quantity that has one is not found.
    pub(super) fn quantity(&self, word: &str, unit: Option<&str>) -> Found {
        let of_word: Vec<(usize, &Column)> = self.with_word(word).collect();
        let Some(unit) = unit else {
            // A grade may be a share or in percent.
            return match of_word.as_slice() {
                [(k, own)] if unit_of(own) == "-" => Found::Column(*k),
                _ => Found::Nothing,
            };
        };
        match of_word.iter().find(|(_, own)| is_in(unit, own)) {
            _ if of_word.is_empty() => Found::Nothing,
            Some((k, _)) => Found::Column(*k),
            None => Found::OtherUnit(word.to_owned()),
        }
    }

    /// The columns of a word, which is a name without its unit or another word for it.
    pub(super) fn with_word(&self, word: &str) -> impl Iterator<Item = (usize, &Column)> {
        let own = self.foreign.own_word(word.to_owned());
        let columns = self.columns.iter().enumerate();
        columns
            .filter(move |(_, column)| column.cells != Cells::Ignored && stem(&column.name) == own)
    }

    /// The problem of a column that the user names next to another one of its group.
    fn said_again(&self, column: usize, before: &[usize]) -> Option<Problem> {
        let own = &self.columns[column];
        let mut others = before.iter().map(|k| &self.columns[*k]);
        let other = others.find(|other| other.is_same(own))?;
        let message = format!("{} and {} say the same thing", other.name, own.name);
        let problem = Problem::conflict(message).at(Argument::Columns);
        Some(problem.allowed("one of them").hint("name one of them"))
    }

    /// The units of a quantity's columns, for people; a whole name of a column has its own.
    pub(super) fn units_of(&self, quantity: &str) -> Vec<&'static str> {
        let word = bare(stem(quantity));
        let mut units: Vec<&str> = self
            .with_word(&word)
            .map(|(_, column)| unit_of(column))
            .collect();
        units.dedup();
        units
    }
}

/// True if a column is in the unit that a text means.
pub(super) fn is_in(unit: &str, column: &Column) -> bool {
    unit_named(unit) == Some(unit_of(column))
}

/// The unit of a column as people write it.
fn unit_of(column: &Column) -> &'static str {
    Quantity::from_key(&column.name).unit()
}

impl Columns {
    /// The columns of the schema in the order in which they are given.
    ///
    /// # Errors
    /// A quantity that the schema does not have, or not in that unit, or two that say the same thing.
    pub fn in_order(&self, schema: &Schema) -> Result<Vec<usize>, Problem> {
        let column = |entry: &Entry| entry.column(None, schema);
        let all: Result<Vec<usize>, Problem> = self.list.iter().map(column).collect();
        let all = all.map_err(|problem| problem.at(Argument::Columns))?;
        for (k, column) in all.iter().enumerate() {
            if let Some(problem) = schema.said_again(*column, &all[..k]) {
                return Err(problem);
            }
        }
        Ok(all)
    }

    /// The names that are given, each with its column of the schema.
    ///
    /// # Errors
    /// As [`Columns::in_order`].
    pub fn by_name(&self, schema: &Schema) -> Result<Vec<(&str, usize)>, Problem> {
        let places = self.in_order(schema)?;
        let names = self
            .list
            .iter()
            .map(|entry| entry.name.as_deref().unwrap_or_default());
        Ok(names.zip(places).collect())
    }

    /// The column of the schema for each column of the file.
    pub(super) fn match_columns(
        &self,
        line: Line<'_>,
        fields: &[Field],
        units: Option<(Line<'_>, &[Field])>,
        schema: &Schema,
        problems: &mut Collector<'_>,
    ) -> Vec<Option<usize>> {
        let mut found = vec![None; fields.len()];
        let mut before = Vec::new();
        for (k, entry) in self.list.iter().enumerate() {
            let is_it = |field: &Field| Some(line.text_of(*field)) == entry.name.as_deref();
            let at = match entry.name {
                Some(_) => fields.iter().position(is_it),
                None => (k < fields.len()).then_some(k),
            };
            let Some(at) = at else {
                problems.add(entry.not_there(line, fields));
                continue;
            };
            let below = units.and_then(|(line, units)| Some(line.text_of(*units.get(at)?)));
            match entry.column(below, schema) {
                Ok(column) => {
                    if let Some(problem) = schema.said_again(column, &before) {
                        problems.add(problem);
                    }
                    before.push(column);
                    found[at] = Some(column);
                }
                Err(problem) => problems.add(problem.at(Argument::Columns)),
            }
        }
        found
    }
}

impl Entry {
    /// The column of the schema that is meant, with the unit below its name where there is a row of units.
    fn column(&self, below: Option<&str>, schema: &Schema) -> Result<usize, Problem> {
        let own = bare(&self.quantity);
        let in_name = self.name.as_deref().and_then(unit_in);
        let unit = self.unit.as_deref().or(in_name.as_deref()).or(below);
        // The quantity may be a whole name of the schema.
        let found = match schema.find(&self.quantity, None) {
            Found::Column(k) if unit.is_none_or(|unit| is_in(unit, &schema.columns[k])) => {
                Found::Column(k)
            }
            Found::Column(_) => Found::OtherUnit(own.clone()),
            _ => schema.quantity(&own, unit),
        };
        match found {
            Found::Column(k) => Ok(k),
            Found::Nothing if schema.with_word(&own).next().is_none() => {
                let words = schema.read().map(|column| stem(&column.name));
                let close = near(&self.quantity, words);
                Err(
                    Problem::unknown_name(format!("there is no quantity `{}`", self.quantity))
                        .value(self.quantity.as_str())
                        .allowed(schema.all())
                        .hint(suggestion(&close).unwrap_or_default()),
                )
            }
            other => Err(self.without_unit(&other, schema)),
        }
    }

    fn without_unit(&self, found: &Found, schema: &Schema) -> Problem {
        let own = &self.quantity;
        let units = schema.units_of(own);
        let message = match found {
            Found::OtherUnit(_) => format!("{own} is not read in that unit"),
            _ => format!("{own} needs its unit"),
        };
        let name = self.name.as_deref().unwrap_or("NAME");
        let example = units.first().copied().unwrap_or("-");
        Problem::unknown_name(message)
            .value(self.unit.as_deref().unwrap_or_default())
            .allowed(units.join(", "))
            .hint(format!("write it behind the name: {own}={name}:{example}"))
    }

    fn not_there(&self, line: Line<'_>, fields: &[Field]) -> Problem {
        let wanted = self.name.as_deref().unwrap_or(&self.quantity);
        let names = fields.iter().map(|field| line.text_of(*field));
        let close = near(wanted, names);
        Problem::unknown_name(format!("the file has no column `{wanted}`"))
            .at(Argument::Columns)
            .value(wanted)
            .allowed("a name of the file's line of column names, as it is written there")
            .hint(suggestion(&close).unwrap_or_default())
    }
}
