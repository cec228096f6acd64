//! Reading of validation files: tolerances and sources at the head, then `[[row]]` by `[[row]]`.

use std::collections::HashMap;

use super::checks::{KINDS, complete, mechanism, printed, verdict};
use super::names::{FileNames, expression};
use super::rows::{Cause, RowFile, Tolerance, ValidationRow};
use super::rule::Printed;
use super::source::{self, Source};
use cvtcycle_config::setup::catalogue;
use cvtcycle_config::{Bound, Document, Problem, Problems, Reader, Section, did_you_mean};

/// Reads files: name and text each. `common` comes first and lends its tolerances and sources.
///
/// # Errors
/// All problems of all files.
pub fn read(common: (&str, &str), files: &[(String, String)]) -> Result<Vec<RowFile>, Problems> {
    let keys = catalogue::known_names();
    let mut problems = Problems::new();
    let lent = file(common.0, common.1, &Lent::default(), keys, &mut problems);
    let lent = Lent {
        tolerances: lent.tolerances,
        sources: lent.sources,
    };
    let read: Vec<RowFile> = files
        .iter()
        .map(|(name, text)| file(name, text, &lent, keys, &mut problems))
        .collect();
    let mut seen: HashMap<&str, &ValidationRow> = HashMap::new();
    for row in read
        .iter()
        .flat_map(|file| &file.rows)
        .filter(|row| !row.id.is_empty())
    {
        let first = *seen.entry(&row.id).or_insert(row);
        if !std::ptr::eq(first, row) {
            let message = format!(
                "the id `{}` was used before, in {} line {}",
                row.id, first.id_place.input, first.id_place.line
            );
            let (place, value) = (row.id_place.clone(), row.id.clone());
            let twice = Problem::invalid(message)
                .at(place)
                .key("id")
                .value(value)
                .hint("ids are unique");
            problems.append(twice.into());
        }
    }
    if problems.is_empty() {
        Ok(read)
    } else {
        Err(problems)
    }
}

/// What the common file lends.
#[derive(Default)]
struct Lent {
    tolerances: Vec<Tolerance>,
    sources: Vec<Source>,
}

fn file(name: &str, text: &str, lent: &Lent, keys: &[String], problems: &mut Problems) -> RowFile {
    let mut read = RowFile {
        name: name.to_owned(),
        tolerances: Vec::new(),
        sources: Vec::new(),
        rows: Vec::new(),
    };
    let mut document = match Document::parse(name, text) {
        Ok(document) => document,
        Err(found) => {
            problems.append(found);
            return read;
        }
    };
    let rows = document.take_tables("row");
    let reader = Reader::new(&document);
    let root = reader.root();
    read.tolerances = tolerances(&root.table("tolerances"));
    read.sources = source::read(&root.table("sources"), &lent.sources);
    if let Err(found) = reader.finish() {
        let hint = |p: &Problem| {
            if p.key == "row" {
                "rows are written as [[row]]".to_owned()
            } else {
                p.hint.clone()
            }
        };
        problems.append(found.map(|p| {
            let hint = hint(&p);
            p.hint(hint)
        }));
    }
    source::resolve_paths(&mut read.sources, name);
    read.tolerances.extend(lent.tolerances.iter().cloned());
    read.sources.extend(lent.sources.iter().cloned());
    let head = Head {
        tolerances: &read.tolerances,
        names: FileNames {
            sources: &read.sources,
            keys,
        },
    };
    for document in &rows {
        let reader = Reader::new(document);
        let row = head.row(&reader.root());
        if let Err(found) = reader.finish() {
            let of = if row.id.is_empty() {
                String::new()
            } else {
                format!("row {}: ", row.id)
            };
            let named = |p: Problem| {
                if p.not_shown().is_some() {
                    p
                } else {
                    p.with_context(&of)
                }
            };
            problems.append(found.map(named));
        }
        read.rows.push(row);
    }
    read
}

fn tolerances(all: &Section) -> Vec<Tolerance> {
    let width = Bound::closed(0.0, 1e9);
    let one = |name: &str| {
        let s = all.table(name);
        let absolute = s.optional_number(
            "width",
            width,
            "width on both sides, in the unit of the row",
        );
        let relative = s.optional_number(
            "share",
            Bound::closed(0.0, 10.0),
            "width as a share of the printed number",
        );
        if s.exists() && absolute.is_some() == relative.is_some() {
            s.complain(
                "width",
                "width or share",
                &format!("tolerance `{name}` needs either `width` or `share`"),
                "give one of them",
            );
        }
        Tolerance {
            name: name.to_owned(),
            absolute: absolute.unwrap_or(0.0),
            relative: relative.unwrap_or(0.0),
            unit: s.text_or("unit", "-", "unit of the width"),
            source: s.text("from", "where the width comes from"),
        }
    };
    all.names().into_iter().map(one).collect()
}

/// What the rows of a file may refer to.
struct Head<'a> {
    tolerances: &'a [Tolerance],
    names: FileNames<'a>,
}

impl Head<'_> {
    fn row(&self, s: &Section) -> ValidationRow {
        let id = s.text("id", "identifier, unique over all files");
        let chapter = s.text(
            "chapter",
            "chapter of the thesis, or a word for the user's own rows",
        );
        let mechanism = mechanism(s);
        let kind = s
            .word_or(
                "kind",
                &KINDS,
                "N",
                "N number, O order or sign, C constant, L quoted from others, X record only",
            )
            .to_owned();
        let compute_text = s
            .optional_text("compute", "how it is computed")
            .unwrap_or_default();
        let compute = expression(s, "compute", &compute_text, &self.names);
        let unit = s.text_or("unit", "-", "unit of printed and computed numbers");
        let broken = compute.is_none() && !compute_text.trim().is_empty();
        let printed = printed(s, compute.as_ref(), broken);
        let recorded = verdict(s);
        let reason = s.text_or("reason", "", "why it differs or cannot be compared");
        let (tolerance, tolerance_widths) = self.tolerance(s, printed, &unit, broken);
        let row = ValidationRow {
            id,
            id_place: s.place("id"),
            place: s.place(if compute_text.is_empty() {
                "id"
            } else {
                "compute"
            }),
            chapter,
            mechanism,
            what: s.text("what", "what is compared"),
            condition: s.text_or("condition", "", "at which condition"),
            printed_text: s.text("printed", "the printed text"),
            unit,
            kind,
            printed,
            tolerance,
            tolerance_widths,
            fitted_to: self.fitted(s),
            recorded,
            reason,
            remark: s.text_or("remark", "", "what else a reader should know"),
            cause: self.cause(s),
            compute_text,
            compute,
        };
        complete(s, &row);
        row
    }

    fn tolerance(
        &self,
        s: &Section,
        printed: Option<Printed>,
        unit: &str,
        broken: bool,
    ) -> (String, [f64; 2]) {
        let name = s.optional_text("tolerance", "name of a tolerance at the head of the file");
        let Some(Printed::Range(low, high)) = printed else {
            if name.is_some() && !broken {
                s.complain(
                    "tolerance",
                    "",
                    "an order or sign has no tolerance",
                    "remove it",
                );
            }
            return (String::new(), [0.0; 2]);
        };
        let known: Vec<&str> = self.tolerances.iter().map(|t| t.name.as_str()).collect();
        let Some(name) = name else {
            s.complain(
                "tolerance",
                &known.join(", "),
                "missing key `tolerance`",
                "name a tolerance of the head of the file",
            );
            return (String::new(), [0.0; 2]);
        };
        let Some(found) = self.tolerances.iter().find(|t| t.name == name) else {
            let hint = did_you_mean(&name, known.iter().copied()).unwrap_or_default();
            s.complain(
                "tolerance",
                &known.join(", "),
                &format!("there is no tolerance `{name}`"),
                &hint,
            );
            return (name, [0.0; 2]);
        };
        if found.unit != "-" && found.unit != unit {
            let message = format!("tolerance `{name}` is in {}, the row in {unit}", found.unit);
            s.complain(
                "tolerance",
                "the same unit",
                &message,
                "use another tolerance",
            );
        }
        let width = |end: f64| {
            if end.is_finite() {
                found.absolute + found.relative * end.abs()
            } else {
                found.absolute
            }
        };
        (name, [width(low), width(high)])
    }

    fn fitted(&self, s: &Section) -> Vec<String> {
        let keys = s.texts("fitted_to", "parameters that were fitted to this number");
        for key in keys.iter().filter(|key| !self.names.keys.contains(key)) {
            let hint =
                did_you_mean(key, self.names.keys.iter().map(String::as_str)).unwrap_or_default();
            s.complain(
                "fitted_to",
                "keys of a vehicle or lubricant",
                &format!("there is no parameter `{key}`"),
                &hint,
            );
        }
        keys
    }

    fn cause(&self, s: &Section) -> Option<Cause> {
        let table = s.table("cause");
        if !table.exists() {
            return None;
        }
        let text = table.text("compute", "how it is computed");
        let cause = Cause {
            what: table.text("what", "what the number is"),
            unit: table.text_or("unit", "-", "its unit"),
            compute: expression(&table, "compute", &text, &self.names)?,
        };
        Some(cause)
    }
}
