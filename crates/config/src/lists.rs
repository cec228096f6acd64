//! Reading of lists and of tables of numbers.
use std::fmt::Display;
use std::ops::RangeInclusive;

use super::bound::Bound;
use super::document::{Node, Value};
use super::reader::join;
use super::section::Section;
use super::units::{to_si, unit_of};
use super::value::{Lazy, Lookup};

impl Section<'_> {
    /// A list of numbers in SI units. It is required unless `length` begins at 0. After a problem the
    /// numbers concerned are NaN, and the length is within `length` all the same.
    pub fn numbers(
        &self,
        key: &str,
        allowed: Bound,
        length: RangeInclusive<usize>,
        doc: &str,
    ) -> Vec<f64> {
        let (least, most) = (*length.start(), *length.end());
        let range = Lazy(|| {
            format!(
                "{}, each {}",
                count_in_words(least, most),
                allowed.in_unit(unit_of(key))
            )
        });
        let mut values = Vec::new();
        match self.open(key, &range, doc) {
            Lookup::Found(found) => {
                if let Value::List(items) = &found.node.value {
                    values = items
                        .iter()
                        .map(|item| {
                            self.check_number(key, key, item, allowed)
                                .unwrap_or(f64::NAN)
                        })
                        .collect();
                    if length.contains(&values.len()) {
                        self.given(key, &found, format_args!("{values:?}"), None);
                    } else {
                        let count = count_in_words(least, most);
                        let message = format!(
                            "`{}`: expected {count}, found {}",
                            join(&self.path, key),
                            values.len()
                        );
                        self.report(
                            &found.node.span,
                            key,
                            &range.to_string(),
                            message,
                            String::new(),
                        );
                    }
                } else {
                    self.wrong_type(key, found.node, "a list of numbers");
                }
            }
            Lookup::Absent if least > 0 => self.missing(key, &range),
            Lookup::Absent => self.defaulted(key, "[]", None),
            Lookup::Bad => {}
        }
        values.truncate(most);
        values.resize(values.len().max(least), f64::NAN);
        values.into_iter().map(|value| to_si(key, value)).collect()
    }

    /// Numbers in SI units, written as one number, a list of numbers, or a range `"1000..4000:250"` with both ends; none if the key is
    /// absent, NaN after a problem.
    pub fn grid(&self, key: &str, allowed: Bound, doc: &str) -> Option<Vec<f64>> {
        let range = Lazy(|| {
            format!(
                "a number, a list or a range \"from..to:step\", each {}",
                allowed.in_unit(unit_of(key))
            )
        });
        let found = match self.open(key, &range, doc) {
            Lookup::Found(found) => found,
            Lookup::Absent => return None,
            Lookup::Bad => return Some(vec![f64::NAN]),
        };
        let values: Vec<f64> = match &found.node.value {
            Value::List(items) => items
                .iter()
                .map(|item| {
                    self.check_number(key, key, item, allowed)
                        .unwrap_or(f64::NAN)
                })
                .collect(),
            Value::Text(text) => match range_values(text) {
                Some(values) if values.iter().all(|x| allowed.contains(*x)) => values,
                Some(_) => {
                    self.out_of_range(key, found.node, &range.to_string());
                    vec![f64::NAN]
                }
                None => {
                    let message = format!("`{}`: `{text}` is no range", join(&self.path, key));
                    let hint = match text.split_once("..") {
                        Some((from, to)) if !to.contains(':') => format!("add the step, as in \"{from}..{to}:5\""),
                        _ => "the end lies above the beginning and the step above 0, as in \"1000..4000:250\"".to_string(),
                    };
                    self.report(&found.node.span, key, &range.to_string(), message, hint);
                    vec![f64::NAN]
                }
            },
            _ => vec![
                self.check_number(key, key, found.node, allowed)
                    .unwrap_or(f64::NAN),
            ],
        };
        self.given(key, &found, format_args!("{values:?}"), None);
        Some(values.into_iter().map(|value| to_si(key, value)).collect())
    }

    /// Texts of a list; empty if the key is absent.
    pub fn texts(&self, key: &str, doc: &str) -> Vec<String> {
        let found = match self.open(key, "a list of texts", doc) {
            Lookup::Found(found) => found,
            Lookup::Absent => {
                self.defaulted(key, "[]", None);
                return Vec::new();
            }
            Lookup::Bad => return Vec::new(),
        };
        let Value::List(items) = &found.node.value else {
            self.wrong_type(key, found.node, "a list of texts");
            return Vec::new();
        };
        let text = |item: &Node| match &item.value {
            Value::Text(text) => Some(text.clone()),
            _ => {
                self.wrong_type(key, item, "text");
                None
            }
        };
        let texts: Vec<String> = items.iter().filter_map(text).collect();
        self.given(key, &found, format_args!("{texts:?}"), None);
        texts
    }

    /// A table of numbers written as a list of rows, in SI units by the suffixes of the column names.
    /// Empty if the key is absent; rows with a problem are left out.
    pub fn rows(&self, key: &str, columns: &[(&str, Bound)], doc: &str) -> Vec<Vec<f64>> {
        let allowed = Lazy(|| rows_of(columns));
        let units = Lazy(|| {
            columns
                .iter()
                .map(|(name, _)| unit_of(name))
                .collect::<Vec<_>>()
                .join(", ")
        });
        let lookup = self.open(key, &allowed, doc);
        self.unit(key, &units);
        let found = match lookup {
            Lookup::Found(found) => found,
            Lookup::Absent => {
                self.defaulted(key, "[]", None);
                return Vec::new();
            }
            Lookup::Bad => return Vec::new(),
        };
        let Value::List(items) = &found.node.value else {
            self.wrong_type(key, found.node, "a list of rows");
            return Vec::new();
        };
        let mut rows: Vec<Vec<f64>> = Vec::with_capacity(items.len());
        rows.extend(
            items
                .iter()
                .filter_map(|item| self.row(key, item, columns, &allowed)),
        );
        self.given(key, &found, format_args!("{rows:?}"), None);
        for row in &mut rows {
            row.iter_mut()
                .zip(columns)
                .for_each(|(value, (name, _))| *value = to_si(name, *value));
        }
        rows
    }

    /// A table of numbers as [`Section::rows`]; none after a problem with any of its rows.
    pub fn sound_rows(
        &self,
        key: &str,
        columns: &[(&str, Bound)],
        doc: &str,
    ) -> Option<Vec<Vec<f64>>> {
        let before = self.reader.faults();
        let rows = self.rows(key, columns, doc);
        (self.reader.faults() == before).then_some(rows)
    }

    /// A table of numbers that has to be there, as [`Section::rows`]; none after a problem with any of its rows.
    pub fn required_rows(
        &self,
        key: &str,
        columns: &[(&str, Bound)],
        doc: &str,
    ) -> Option<Vec<Vec<f64>>> {
        let rows = self.sound_rows(key, columns, doc)?;
        if !self.has(key) {
            self.missing(key, Lazy(|| rows_of(columns)));
            return None;
        }
        Some(rows)
    }

    /// One row in the columns' own units.
    fn row(
        &self,
        key: &str,
        node: &Node,
        columns: &[(&str, Bound)],
        allowed: &dyn Display,
    ) -> Option<Vec<f64>> {
        let Value::List(cells) = &node.value else {
            self.wrong_type(key, node, "a row of numbers in brackets");
            return None;
        };
        if cells.len() != columns.len() {
            let names: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
            let message = format!(
                "`{}`: expected {} numbers in a row, found {}",
                join(&self.path, key),
                columns.len(),
                cells.len()
            );
            self.report(
                &node.span,
                key,
                &allowed.to_string(),
                message,
                format!("write [{}]", names.join(", ")),
            );
            return None;
        }
        // All cells are looked at before the row is dropped, so that every problem is reported.
        let mut good = true;
        let mut row = Vec::with_capacity(cells.len());
        for (cell, (name, bound)) in cells.iter().zip(columns) {
            let number = self.check_number(key, name, cell, *bound);
            good &= number.is_some();
            row.extend(number);
        }
        good.then_some(row)
    }
}

/// Most numbers of one range.
const MOST_IN_RANGE: f64 = 10_000.0;

/// `from..to:step` with both ends; a last step that falls short of `to` is kept short.
fn range_values(text: &str) -> Option<Vec<f64>> {
    let (from, rest) = text.split_once("..")?;
    let (to, step) = rest.split_once(':')?;
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    let (from, to, step) = (number(from)?, number(to)?, number(step)?);
    let count = ((to - from) / step).floor();
    if !(step > 0.0 && from <= to && count < MOST_IN_RANGE) {
        return None;
    }
    let values: Vec<f64> = (0..=count as u32)
        .map(|i| from + step * f64::from(i))
        .collect();
    let whole = values
        .last()
        .is_some_and(|last| (to - last).abs() <= 1e-9 * step);
    Some(if whole {
        values
    } else {
        values.into_iter().chain([to]).collect()
    })
}

/// What the rows of a table hold, in words.
fn rows_of(columns: &[(&str, Bound)]) -> String {
    let describe =
        |(name, bound): &(&str, Bound)| format!("{name} {}", bound.in_unit(unit_of(name)));
    format!(
        "rows of {}",
        columns.iter().map(describe).collect::<Vec<_>>().join(", ")
    )
}

fn count_in_words(least: usize, most: usize) -> String {
    match (least, most) {
        (1, 1) => "1 number".to_string(),
        (least, most) if least == most => format!("{least} numbers"),
        (least, usize::MAX) => format!("at least {least} numbers"),
        (least, most) => format!("{least} to {most} numbers"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Bound, Document, Reader};
    use super::range_values;

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

    #[test]
    fn tables_of_a_list_are_documents_with_their_places() {
        let mut document = Document::parse(
            "x.toml",
            "a = 1\n[[row]]\nspeed_rpm = \"0..60:30\"\n[[row]]\nspeed_rpm = [30, 9e9]\n",
        )
        .expect("TOML");
        let rows = document.take_tables("row");
        assert_eq!(
            (
                rows.len(),
                document.take_tables("row").len(),
                document.take_tables("a").len()
            ),
            (2, 0, 0)
        );
        let read = |k: usize| {
            let reader = Reader::new(&rows[k]);
            let values = reader
                .root()
                .grid("speed_rpm", Bound::closed(0.0, 100.0), "speed");
            reader.root().text("name", "name");
            (values, reader.finish().expect_err("no name"))
        };
        let (values, problems) = read(0);
        assert!(
            values
                .is_some_and(|v| v.len() == 3 && (v[2] - 2.0 * std::f64::consts::PI).abs() < 1e-12)
        );
        assert_eq!(
            (
                problems.len(),
                problems[0].place.line,
                problems[0].place.line_text.as_str()
            ),
            (1, 2, "[[row]]")
        );
        let (_, problems) = read(1);
        assert_eq!(
            problems.iter().map(|p| p.place.line).collect::<Vec<_>>(),
            [4, 5]
        );
    }
}
