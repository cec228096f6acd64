//! The lines above the rows: a title, the names of the columns, their units; and by them which column of the file is which.

use super::collector::{Collector, Line, MAX_COLUMNS};
use super::dialect::decimal_comma;
use super::heading::unit_named;
use super::named::Columns;
use super::names::{Found, is_in};
use super::schema::{Cells, Column, Schema, name};
use super::text::{Delimiter, Field, split};
use crate::problem::source::shortened;
use crate::{Bound, Problem, Setting, near, one_line};

/// A longer name of a column is not repeated in full.
const MAX_NAME_LEN: usize = 60;

/// The lines above the rows, understood.
#[derive(Debug)]
pub(super) struct Header {
    /// Separator of the columns.
    pub delimiter: Delimiter,
    /// True if numbers have decimal commas.
    pub decimal_comma: bool,
    /// Index in the schema of each column of the file.
    pub columns: Vec<Option<usize>>,
    /// Columns of the file that say again what one of `columns` says.
    pub spares: Vec<Spare>,
    /// The fields of the names.
    pub fields: Vec<Field>,
    /// Number of lines above the first row, without blank ones and comments.
    pub lines: usize,
    /// How the table was read, where it is not written as the program's own are.
    pub read_as: Option<String>,
}

/// A column of the file that is spare next to another one of its group.
#[derive(Clone, Debug)]
pub(super) struct Spare {
    /// Place among the columns of the file.
    pub at: usize,
    /// Index in the schema.
    pub index: usize,
    /// The column of the schema, without its range and with empty cells: the numbers are only compared.
    pub column: Column,
}

/// Index in the schema of each column of the file, and the spare ones.
type Meant = (Vec<Option<usize>>, Vec<Spare>);

/// A line and its fields.
type Fields<'t> = (Line<'t>, Vec<Field>);

impl Schema {
    /// Reads the lines above the rows. Without a value where the rows cannot be understood.
    pub(super) fn header<'t>(
        &self,
        first: Line<'t>,
        below: impl Iterator<Item = Line<'t>> + Clone,
        problems: &mut Collector<'_>,
    ) -> Option<Header> {
        let has_title = self.is_title(first, below.clone());
        let mut below = below;
        let (mut line, mut lines) = (first, 0);
        if has_title {
            (line, lines) = (below.next()?, 1);
        }
        let mut given = self.named.clone().unwrap_or_default();
        if let Some(columns) = self.whole_line(line) {
            let Some(row) = below.next() else {
                problems.no_rows(self.rows);
                return None;
            };
            (line, lines, given) = (row, lines + 1, columns);
        }
        let in_order = given.are_in_order();
        let delimiter = Delimiter::find(line, below.clone(), problems)?;
        let names = (line, problems.names(line, delimiter)?);
        if is_numbers(&names) && !in_order {
            self.no_names(line, problems);
            return None;
        }
        let units = match in_order {
            true => None,
            false => units_row(below.clone(), delimiter, names.1.len()),
        };
        let rows = below.skip(usize::from(units.is_some()));
        let (columns, spares) = self.columns_of(&names, units.as_ref(), &given, problems)?;
        let is_number = |k: &Option<usize>| {
            k.is_some_and(|k| matches!(self.columns[k].cells, Cells::Number(_) | Cells::Whole(_)))
        };
        let mut is_number: Vec<bool> = columns.iter().map(is_number).collect();
        spares.iter().for_each(|own| is_number[own.at] = true);
        let above = in_order.then_some(line).into_iter();
        let decimal_comma = decimal_comma(above.chain(rows), delimiter, &is_number, problems)?;
        let mut header = Header {
            delimiter,
            decimal_comma,
            columns,
            spares,
            fields: names.1,
            lines: lines + usize::from(!in_order) + usize::from(units.is_some()),
            read_as: None,
        };
        header.read_as = header.words(line, (has_title, units.is_some(), in_order), self);
        Some(header)
    }

    /// The columns in their order where nothing separates the names of this line.
    fn whole_line(&self, line: Line<'_>) -> Option<Columns> {
        let words: Vec<&str> = line.text.split_whitespace().collect();
        let mut lines = self.foreign.lines.iter();
        let (_, columns) =
            lines.find(|(text, _)| !line.text.contains('\t') && *text == words.join(" "))?;
        Columns::parse(columns).ok()
    }

    /// True if a first line is a title: it has no name of a column, and the line below it has some.
    fn is_title<'t>(&self, line: Line<'t>, below: impl Iterator<Item = Line<'t>> + Clone) -> bool {
        let mut next = below.clone();
        let Some(second) = next.next() else {
            return false;
        };
        let knows = |line: Line<'t>, below: &mut dyn Iterator<Item = Line<'t>>| {
            let lines: Vec<Line<'t>> = below.take(2).collect();
            let sign = Delimiter::detect(line, lines.into_iter()).map_or(',', Delimiter::sign);
            let mut fields = Vec::new();
            let is_split = split(line.text, sign, &mut fields).is_ok();
            let is_known = |field: &Field| {
                let text = line.text_of(*field);
                let named = self.named.as_ref().is_some_and(|named| named.has(text));
                named || self.find(text, None) != Found::Nothing
            };
            self.whole_line(line).is_some()
                || is_split && fields.iter().take(MAX_COLUMNS).any(is_known)
        };
        !knows(line, &mut below.clone()) && knows(second, &mut next)
    }

    /// Reports that the first line has numbers.
    fn no_names(&self, line: Line<'_>, problems: &mut Collector<'_>) {
        problems.line(line, "", || {
            let example: Vec<&str> = self.firsts().filter(|c| c.required).map(name).collect();
            let hint = format!(
                "put the names above the numbers, for example {}",
                example.join(",")
            );
            let problem = Problem::missing("the first line has numbers and no column names");
            match self.named {
                Some(_) => problem
                    .hint(hint + "; or name the columns in their order, such as time:s,speed:mph")
                    .settings(&[Setting::Columns]),
                None => problem.hint(hint),
            }
        });
    }

    /// Finds the column of the schema for each column of the file; `None` if the table may have others and no name is known.
    fn columns_of(
        &self,
        names: &Fields<'_>,
        units: Option<&Fields<'_>>,
        named: &Columns,
        problems: &mut Collector<'_>,
    ) -> Option<Meant> {
        let (line, fields) = names;
        if !named.is_empty() {
            let units = units.map(|(line, fields)| (*line, &**fields));
            let before = problems.count();
            let found = named.match_columns(*line, fields, units, self, problems);
            // A problem of the named columns may explain a missing one.
            if problems.count() == before {
                self.require((*line, &[]), &found, &[], problems);
            }
            return Some((found, Vec::new()));
        }
        let mut found = Vec::with_capacity(fields.len());
        let mut spares = Vec::new();
        let mut meant = Vec::new();
        for (k, &field) in fields.iter().enumerate() {
            let unit = units.and_then(|(line, units)| Some((*line, *units.get(k)?)));
            let meaning = |k: usize| {
                let below = units.and_then(|(line, units)| Some(line.text_of(*units.get(k)?)));
                match self.find(line.text_of(fields[k]), below) {
                    Found::Column(index) => Some(index),
                    _ => None,
                }
            };
            // A mean effective pressure next to its torque says the same for the engine that was measured.
            let is_better = |own: &Column| {
                let others = (0..fields.len()).filter_map(meaning);
                let mut others = others.map(|index| &self.columns[index]);
                others.any(|other| !other.is_spare && other.is_same(own))
            };
            if let Some(index) = meaning(k)
                && let own = &self.columns[index]
                && own.is_spare
                && is_better(own)
            {
                found.push(None);
                let column = Column {
                    cells: Cells::Number(Bound::any()),
                    ..own.clone().or_empty()
                };
                spares.push(Spare {
                    at: k,
                    index,
                    column,
                });
                continue;
            }
            let index = self.column(*line, field, unit, &found, &mut meant, problems);
            found.push(index);
        }
        if let Some((title, hint)) = self.lenient
            && found.iter().all(Option::is_none)
        {
            problems.line(*line, "", || {
                Problem::missing(format!("this is no {title}: it has none of its columns"))
                    .allowed(self.all())
                    .hint(hint)
            });
            return None;
        }
        self.require((*line, fields), &found, &meant, problems);
        Some((found, spares))
    }

    /// The column that a name means, the first time that it is there.
    fn column<'s>(
        &'s self,
        line: Line<'_>,
        field: Field,
        unit: Option<(Line<'_>, Field)>,
        found: &[Option<usize>],
        meant: &mut Vec<&'s str>,
        problems: &mut Collector<'_>,
    ) -> Option<usize> {
        let text = line.text_of(field);
        let below = unit.map(|(line, field)| line.text_of(field));
        let index = match self.find(text, below) {
            Found::Column(index) => index,
            Found::PassedOver => return None,
            other => {
                if self.lenient.is_none() {
                    self.report_unknown(line, field, &other, meant, problems);
                }
                return None;
            }
        };
        let own = &self.columns[index];
        if let Some((line, field)) = unit
            && unit_named(line.text_of(field)).is_some()
            && !is_in(line.text_of(field), own)
        {
            problems.value(line, field, text, || {
                Problem::conflict(format!(
                    "the row of units contradicts the name {}",
                    own.name
                ))
                .allowed("the unit of the name")
                .hint("correct the name or the unit")
            });
        }
        let known = found.iter().flatten().map(|k| &self.columns[*k]);
        let Some(first) = known.into_iter().find(|other| other.is_same(own)) else {
            return Some(index);
        };
        problems.value(line, field, text, || {
            if first.name == own.name {
                Problem::duplicate("duplicate column").allowed("each column once")
            } else {
                Problem::conflict(format!("{text} and {} say the same thing", first.name))
                    .names_key()
                    .allowed("one of them")
            }
            .hint("remove one of them")
        });
        None
    }

    /// Reports a name that means no column.
    fn report_unknown<'s>(
        &'s self,
        line: Line<'_>,
        field: Field,
        found: &Found,
        meant: &mut Vec<&'s str>,
        problems: &mut Collector<'_>,
    ) {
        let text = line.text_of(field);
        if let Found::OtherUnit(word) = found {
            let units = self.units_of(word).join(", ");
            meant.extend(self.with_word(word).map(|(_, own)| name(own)));
            problems.value(line, field, text, || {
                Problem::unknown_key(format!("{word} is not read in the unit of this column"))
                    .names_key()
                    .allowed(units)
                    .hint("convert the numbers and write the new unit")
            });
            return;
        }
        let close = near(text, self.listed().map(name));
        problems.value(line, field, text, || self.unknown(text, &close));
        meant.extend(close);
    }

    /// Reports missing columns, but not those that an unknown name may have meant.
    fn require(
        &self,
        (line, fields): (Line<'_>, &[Field]),
        found: &[Option<usize>],
        meant: &[&str],
        problems: &mut Collector<'_>,
    ) {
        for own in self.firsts() {
            let same = || self.columns.iter().filter(|other| other.is_same(own));
            let is_there = found
                .iter()
                .flatten()
                .any(|k| self.columns[*k].is_same(own));
            let is_needed = || {
                let columns = found.iter().flatten().map(|k| name(&self.columns[*k]));
                let texts = fields.iter().map(|field| line.text_of(*field));
                !columns.chain(texts).any(|text| own.unless.contains(&text))
            };
            if own.required && is_needed() && !is_there && !same().any(|c| meant.contains(&name(c)))
            {
                problems.line(line, &own.name, || {
                    let names: Vec<&str> = same().filter(|c| !c.is_alias).map(name).collect();
                    Problem::missing(format!("the column {} is missing", names.join(" or ")))
                        .names_key()
                        .allowed(self.all())
                        .hint("add it; the unit is in the name")
                });
            }
        }
    }
}

impl Header {
    /// How the table was read, where it is not written as the program's own are.
    fn words(
        &self,
        line: Line<'_>,
        (title, units, in_order): (bool, bool, bool),
        schema: &Schema,
    ) -> Option<String> {
        let mut words = Vec::new();
        if self.delimiter != Delimiter::Comma {
            words.push(format!("{}s", self.delimiter.word()));
        }
        let marks = [
            (self.decimal_comma, "decimal commas"),
            (title, "a title in the first line"),
            (units, "a row of units"),
        ];
        words.extend(
            marks
                .iter()
                .filter(|(is, _)| *is)
                .map(|(_, word)| (*word).to_owned()),
        );
        let read = self.fields.iter().zip(&self.columns);
        for (k, (field, column)) in read.enumerate() {
            let Some(own) = column.map(|column| name(&schema.columns[column])) else {
                continue;
            };
            let text = line.text_of(*field);
            if in_order {
                words.push(format!("column {} as {own}", k + 1));
            } else if text != own {
                let text = one_line(text);
                words.push(format!("\"{}\" as {own}", shortened(&text, MAX_NAME_LEN)));
            }
        }
        let (read, all) = (self.columns.iter().flatten().count(), self.columns.len());
        if read < all && schema.lenient.is_none() {
            words.push(format!("{read} of {all} columns"));
        }
        (!words.is_empty()).then(|| words.join(", "))
    }
}

fn is_numbers((line, fields): &Fields<'_>) -> bool {
    let is_number = |field: &Field| {
        line.text_of(*field)
            .replacen(',', ".", 1)
            .parse::<f64>()
            .is_ok()
    };
    fields.iter().all(is_number)
}

/// The line below the names where it holds units: no cell is a number, and half of those that are not empty or more are known units.
fn units_row<'t>(
    mut below: impl Iterator<Item = Line<'t>>,
    delimiter: Delimiter,
    count: usize,
) -> Option<Fields<'t>> {
    let line = below.next()?;
    let mut fields = Vec::new();
    split(line.text, delimiter.sign(), &mut fields).ok()?;
    let texts = || fields.iter().map(|field| line.text_of(*field));
    let is_number = |text: &str| text.replacen(',', ".", 1).parse::<f64>().is_ok();
    let (mut units, mut filled) = (0, 0);
    for text in texts() {
        filled += usize::from(!text.is_empty());
        units += usize::from(unit_named(text).is_some());
    }
    let are_units =
        fields.len() == count && !texts().any(is_number) && filled > 0 && 2 * units >= filled;
    are_units.then_some((line, fields))
}
