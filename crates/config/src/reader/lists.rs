//! Reading of lists and of tables of numbers.
use std::collections::HashMap;
use std::fmt;
use std::sync::LazyLock;

use crate::document::overrides::Override;
use crate::document::{Node, Value};
use crate::problem::Problem;
use crate::reader::maps;
use crate::reader::origin::Found;
use crate::reader::path::join;
use crate::reader::section::Section;
use crate::reader::value::Lookup;
use cvtcycle_model::keys::{Bound, Column, Key, Kind, Quantity, count};

impl<'r> Section<'r> {
    /// A list of numbers in SI units. After a problem the numbers concerned are NaN, and the length is
    /// within the allowed one all the same.
    pub(crate) fn read_numbers(&self, key: &Key<'_>) -> Vec<f64> {
        let (allowed, least, most) = match key.kind {
            Kind::Numbers(each, least, most) => (each, least, most),
            _ => (Bound::any(), 0, usize::MAX),
        };
        let mut values = Vec::new();
        match self.open(key) {
            Lookup::Found(found) => {
                if let Value::List(items) = &found.node.value {
                    values = self.each_number(key, items, allowed);
                    if (least..=most).contains(&values.len()) {
                        self.given(key.name, &found, format_args!("{values:?}"), None);
                    } else {
                        let path = join(&self.path, key.name);
                        let (count, found_count) = (count(least, most), values.len());
                        let message = format!("`{path}`: expected {count}, found {found_count}");
                        let problem = Problem::wrong_type(message)
                            .names_key()
                            .allowed(key.allowed());
                        self.report(&found.node.span, key.name, problem);
                    }
                } else {
                    self.wrong_type(key.name, found.node, "a list of numbers");
                }
            }
            Lookup::Absent if least > 0 => self.report_missing(key),
            Lookup::Absent => self.defaulted(key.name, "[]", None),
            Lookup::Bad => {}
        }
        values.truncate(most);
        values.resize(values.len().max(least), f64::NAN);
        let si = |value| key.quantity.to_si(value);
        values.into_iter().map(si).collect()
    }

    /// The items of a list as numbers in the key's unit, NaN where one is wrong.
    fn each_number(&self, key: &Key<'_>, items: &[Node], allowed: Bound) -> Vec<f64> {
        let number = |item| self.check_number(key.name, || key.quantity, item, allowed);
        let numbers = items.iter().map(|item| number(item).unwrap_or(f64::NAN));
        numbers.collect()
    }

    /// Numbers in SI units, written as one number, a list of numbers, or a range `"1000..4000:250"` with both ends; none if the key is
    /// absent, NaN after a problem.
    pub fn grid(&self, key: &Key<'_>) -> Option<Vec<f64>> {
        let allowed = key.range();
        let found = match self.open(key) {
            Lookup::Found(found) => found,
            Lookup::Absent => return None,
            Lookup::Bad => return Some(vec![f64::NAN]),
        };
        let values: Vec<f64> = match &found.node.value {
            Value::List(items) => self.each_number(key, items, allowed),
            Value::Text(text) => self.range_of(key, found.node, text, allowed),
            _ => self.each_number(key, std::slice::from_ref(found.node), allowed),
        };
        self.given(key.name, &found, format_args!("{values:?}"), None);
        let si = |value| key.quantity.to_si(value);
        Some(values.into_iter().map(si).collect())
    }

    /// The numbers of a range in the key's unit; NaN after a problem.
    fn range_of(&self, key: &Key<'_>, node: &Node, text: &str, allowed: Bound) -> Vec<f64> {
        match range_values(text) {
            Some(values) if values.iter().all(|x| allowed.contains(*x)) => return values,
            Some(_) => self.report_out_of_range(key.name, node, &key.allowed()),
            None => {
                let message = format!("`{}`: `{text}` is no range", join(&self.path, key.name));
                let hint = match text.split_once("..") {
                    Some((from, to)) if !to.contains(':') => {
                        format!("add the step, as in \"{from}..{to}:5\"")
                    }
                    _ => "the end lies above the beginning and the step above 0, as in \"1000..4000:250\"".to_string(),
                };
                let problem = Problem::syntax(message).names_key().allowed(key.allowed());
                self.report(&node.span, key.name, problem.hint(hint));
            }
        }
        vec![f64::NAN]
    }

    /// Texts of a list; empty if the key is absent.
    pub fn texts(&self, key: &Key<'_>) -> Vec<String> {
        self.list(key, |_, text| Some(text.to_owned()))
    }

    /// Overrides of a list of texts `KEY=VALUE`; empty if the key is absent.
    pub fn overrides(&self, key: &Key<'_>) -> Vec<Override> {
        self.list(key, |item, text| {
            let read = text.parse::<Override>();
            let report = |problem| self.report(&item.span, key.name, problem);
            read.map_err(report).ok()
        })
    }

    /// The items of a list with their entry; `None` if the key is absent, or has no list, which is a problem.
    fn items(&self, key: &Key<'_>, expected: &str) -> Option<(Found<'r>, &'r [Node])> {
        let found = match self.open(key) {
            Lookup::Found(found) => found,
            Lookup::Absent => {
                self.defaulted(key.name, "[]", None);
                return None;
            }
            Lookup::Bad => return None,
        };
        let Value::List(items) = &found.node.value else {
            self.wrong_type(key.name, found.node, expected);
            return None;
        };
        Some((found, items))
    }

    /// Texts, written as one text with commas or as a list; empty if the key is absent.
    pub(crate) fn read_texts(&self, key: &Key<'_>) -> Vec<String> {
        let found = match self.open(key) {
            Lookup::Found(found) => found,
            Lookup::Absent => {
                self.defaulted(key.name, "", None);
                return Vec::new();
            }
            Lookup::Bad => return Vec::new(),
        };
        let mut texts = Vec::new();
        match &found.node.value {
            Value::Text(text) => texts.extend(words(text)),
            Value::List(items) => {
                for item in items {
                    match &item.value {
                        Value::Text(text) => texts.extend(words(text)),
                        _ => self.wrong_type(key.name, item, "text"),
                    }
                }
            }
            _ => self.wrong_type(key.name, found.node, &key.allowed()),
        }
        self.given(key.name, &found, texts.join(", "), None);
        texts
    }

    /// Results of `read` for the texts of a list; empty if the key is absent.
    fn list<T: fmt::Debug>(
        &self,
        key: &Key<'_>,
        read: impl Fn(&Node, &str) -> Option<T>,
    ) -> Vec<T> {
        let Some((found, items)) = self.items(key, "a list of texts") else {
            return Vec::new();
        };
        let text = |item: &Node| match &item.value {
            Value::Text(text) => read(item, text),
            _ => {
                self.wrong_type(key.name, item, "text");
                None
            }
        };
        let texts: Vec<T> = items.iter().filter_map(text).collect();
        self.given(key.name, &found, format_args!("{texts:?}"), None);
        texts
    }

    /// A table of numbers written as a list of rows, in SI units by the suffixes of the column names. Empty if the key is absent; rows with
    /// a problem are left out.
    pub(crate) fn read_rows(&self, key: &Key<'_>) -> Vec<Vec<f64>> {
        let Kind::Rows(columns) = key.kind else {
            return Vec::new();
        };
        if maps::is_full_load(columns) && self.names_file(key) {
            let file = self.read_csv_name(key).ok();
            let rows = file.and_then(|file| maps::full_load(self, key.name, file.into(), columns));
            return rows.unwrap_or_default();
        }
        let Some((found, items)) = self.items(key, "a list of rows") else {
            return Vec::new();
        };
        let row = |item| self.row(key, item, columns);
        let mut rows: Vec<Vec<f64>> = items.iter().filter_map(row).collect();
        self.given(key.name, &found, format_args!("{rows:?}"), None);
        for (column, (name, _)) in columns.iter().enumerate() {
            let quantity = quantity_of(name);
            rows.iter_mut()
                .for_each(|row| row[column] = quantity.to_si(row[column]));
        }
        rows
    }

    /// True if the value of a key is the name of a file: a text with an ending.
    fn names_file(&self, key: &Key<'_>) -> bool {
        let is_name = |node: &Node| matches!(&node.value, Value::Text(text) if text.contains('.'));
        matches!(self.open(key), Lookup::Found(found) if is_name(found.node))
    }

    /// One row in the columns' own units.
    fn row(&self, key: &Key<'_>, node: &Node, columns: &[Column<'_>]) -> Option<Vec<f64>> {
        let Value::List(cells) = &node.value else {
            self.wrong_type(key.name, node, "a row of numbers in brackets");
            return None;
        };
        if cells.len() != columns.len() {
            let names: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
            let path = join(&self.path, key.name);
            let (expected, found) = (columns.len(), cells.len());
            let message = format!("`{path}`: expected {expected} numbers in a row, found {found}");
            let hint = format!("write [{}]", names.join(", "));
            let problem = Problem::wrong_type(message)
                .names_key()
                .allowed(key.allowed());
            self.report(&node.span, key.name, problem.hint(hint));
            return None;
        }
        // All cells are looked at before the row is dropped, so that every problem is reported.
        let mut good = true;
        let mut row = Vec::with_capacity(cells.len());
        for (cell, (name, bound)) in cells.iter().zip(columns) {
            let number = self.check_number(key.name, || Quantity::from_key(name), cell, *bound);
            good &= number.is_some();
            row.extend(number);
        }
        good.then_some(row)
    }
}

/// [`Quantity::from_key`] by a table: a study reads the columns of each car anew.
fn quantity_of(name: &str) -> Quantity {
    static BY_SUFFIX: LazyLock<HashMap<&str, Quantity>> =
        LazyLock::new(|| Quantity::ALL.iter().map(|of| (of.suffix(), *of)).collect());
    // The longest suffix begins first.
    let mut ends = name.match_indices('_').map(|(at, _)| &name[at..]);
    let found = ends.find_map(|end| BY_SUFFIX.get(end));
    found.copied().unwrap_or(Quantity::NONE)
}

/// The words of a text, between commas.
pub(crate) fn words(text: &str) -> impl Iterator<Item = String> {
    let words = text.split(',').map(str::trim);
    words.filter(|word| !word.is_empty()).map(str::to_owned)
}

/// Most numbers of one range.
const MAX_IN_RANGE: f64 = 10_000.0;

/// The numbers of `from..to:step`.
fn range_values(text: &str) -> Option<Vec<f64>> {
    let (from, rest) = text.split_once("..")?;
    let (to, step) = rest.split_once(':')?;
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    let (from, to, step) = (number(from)?, number(to)?, number(step)?);
    let good = step > 0.0 && from <= to;
    good.then(|| evenly(from, to, step, MAX_IN_RANGE).ok())?
}

/// Numbers from `from` to `to` in steps of `step` above 0, without the digits in which sums of decimal fractions carry their rounding. Both ends
/// are among them: a last step that falls short of `to` is kept short.
///
/// # Errors
/// How many numbers there would be, where these are more than `most`.
pub fn evenly(from: f64, to: f64, step: f64, most: f64) -> Result<Vec<f64>, f64> {
    // The end is a number of its own where the steps do not meet it.
    let count = ((to - from) / step * (1.0 + 1e-12)).floor();
    if count >= most {
        return Err(count + 1.0);
    }
    let steps = (0..=count as u32).map(|i| decimal(from + f64::from(i) * step));
    let before_end = steps.filter(|x| (to - x).abs() > 1e-9 * step);
    Ok(before_end.chain([to]).collect())
}

/// A number without the last digits of its rounding.
pub fn decimal(x: f64) -> f64 {
    format!("{x:.12e}").parse().unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use super::{quantity_of, range_values};
    use cvtcycle_model::keys::Quantity;

    /// Truth: the search over all units, on names with one suffix, two, and none.
    #[test]
    fn a_column_has_the_unit_of_its_longest_suffix() {
        for first in Quantity::ALL.iter().chain([&Quantity::NONE]) {
            for last in Quantity::ALL.iter().chain([&Quantity::NONE]) {
                let name = format!("loss{}{}", first.suffix(), last.suffix());
                assert_eq!(quantity_of(&name), Quantity::from_key(&name), "{name}");
            }
        }
        assert_eq!(quantity_of("shaft"), Quantity::NONE);
    }

    #[test]
    fn ranges_have_both_ends() {
        assert_eq!(range_values("1..2:0.5"), Some(vec![1.0, 1.5, 2.0]));
        assert_eq!(
            range_values(" 1 .. 2 : 0.4 "),
            Some(vec![1.0, 1.4, 1.8, 2.0])
        );
        assert_eq!(range_values("3..3:1"), Some(vec![3.0]));
        for bad in [
            "1..2",
            "2..1:1",
            "1..2:0",
            "1..2:-1",
            "0..1:1e-9",
            "a..2:1",
            "1..inf:1",
        ] {
            assert_eq!(range_values(bad), None, "{bad}");
        }
    }
}
