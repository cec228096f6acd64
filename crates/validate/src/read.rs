//! Reading of validation files: tolerances and sources at the head, then `[[row]]` by `[[row]]`.

use std::collections::HashMap;

use super::checks::{FileNames, complete, expression, printed};
use super::expr::Names;
use super::keys::{ABOUT, CAUSE, FILE, ROW, TOLERANCE};
use super::rows::{About, Cause, RowFile, Tolerance, ValidationRow};
use super::rule::{Group, Printed, Verdict};
use super::source::{self, Source};
use cvtcycle_config::ProblemKind;
use cvtcycle_config::ProblemKind::{Conflict, Missing};
use cvtcycle_config::{Document, Problem, Problems, Reader, Section, did_you_mean};
use cvtcycle_model::keys::Values;
use cvtcycle_model::lubricant::ZERO_DEGC_K;

/// Reads files: name and text each. `common` comes first and lends its tolerances and sources.
///
/// # Errors
/// All problems of all files.
///
/// ```
/// use cvtcycle_validate::{COMMON, read};
/// let row = "[[row]]\nid = \"own.1\"\nchapter = \"own\"\nwhat = \"pump displacement\"\n\
///     printed = \"8.57\"\nunit = \"cc/rev\"\nvalue = 8.57\ntolerance = \"rounding\"\n\
///     compute = \"key(transmission.cvt.pump.displacement_cc_rev)\"\n";
/// let files = read(COMMON, &[("own.toml".to_owned(), row.to_owned())])?;
/// assert_eq!(files[0].rows[0].id, "own.1");
/// # Ok::<(), cvtcycle_config::Problems>(())
/// ```
pub fn read(common: (&str, &str), files: &[(String, String)]) -> Result<Vec<RowFile>, Problems> {
    let mut problems = Problems::new();
    let lent = file(common.0, common.1, &[], &[], &mut problems);
    let read: Vec<RowFile> = files
        .iter()
        .map(|(name, text)| file(name, text, &lent.tolerances, &lent.sources, &mut problems))
        .collect();
    let mut seen: HashMap<&str, &ValidationRow> = HashMap::new();
    let rows = read.iter().flat_map(|file| &file.rows);
    for row in rows.filter(|row| !row.id.is_empty()) {
        let first = *seen.entry(&row.id).or_insert(row);
        if !std::ptr::eq(first, row) {
            let (id, place) = (&row.id, &first.id_place);
            let (file, line) = (&place.input, place.line);
            let message = format!("the id `{id}` was used before, in {file} line {line}");
            let twice = Problem::duplicate(message).at(row.id_place.clone());
            problems.push(twice.key("id").value(id.clone()).hint("ids are unique"));
        }
    }
    if problems.is_empty() {
        Ok(read)
    } else {
        Err(problems)
    }
}

/// Reads a file with the tolerances and sources that the common file lends.
fn file(
    name: &str,
    text: &str,
    lent_tolerances: &[Tolerance],
    lent_sources: &[Source],
    problems: &mut Problems,
) -> RowFile {
    let mut read = RowFile {
        name: name.to_owned(),
        group: Group::Own,
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
    read.group = Group::from_word(root.word(&FILE.group));
    let all = root.table("tolerances");
    let tolerances = all.names().into_iter();
    read.tolerances = tolerances
        .map(|name| tolerance(&all.table(name), name))
        .collect();
    read.sources = source::read(&root.table("sources"), lent_sources);
    problems.append(
        reader
            .finish()
            .err()
            .unwrap_or_default()
            .map(|p| match p.key.as_str() {
                "row" => p.hint("rows are written as [[row]]"),
                _ => p,
            }),
    );
    problems.extend(source::within_budget(&read.sources).err());
    source::resolve_paths(&mut read.sources, name);
    read.tolerances.extend(lent_tolerances.iter().cloned());
    read.sources.extend(lent_sources.iter().cloned());
    let head = Head {
        tolerances: &read.tolerances,
        names: FileNames {
            sources: &read.sources,
        },
    };
    for document in &rows {
        let reader = Reader::new(document);
        let row = head.row(&reader.root());
        let context = match row.id.as_str() {
            "" => String::new(),
            id => format!("row {id}: "),
        };
        let found = reader.finish().err().unwrap_or_default();
        problems.append(found.map(|p| match p.not_shown() {
            Some(_) => p,
            None => p.with_context(&context),
        }));
        read.rows.push(row);
    }
    read
}

fn tolerance(s: &Section, name: &str) -> Tolerance {
    let (absolute, relative) = (s.optional(&TOLERANCE.width), s.optional(&TOLERANCE.share));
    if s.exists() && absolute.is_some() == relative.is_some() {
        let kind = absolute.map_or(Missing, |_| Conflict);
        let message = format!("tolerance `{name}` needs either `width` or `share`");
        s.complain(
            kind,
            "width",
            "width or share",
            &message,
            "give one of them",
        );
    }
    Tolerance {
        name: name.to_owned(),
        absolute: absolute.unwrap_or(0.0),
        relative: relative.unwrap_or(0.0),
        unit: Values::text(s, &TOLERANCE.unit),
        source: Values::text(s, &TOLERANCE.from),
    }
}

/// What the rows of a file may refer to.
struct Head<'a> {
    tolerances: &'a [Tolerance],
    names: FileNames<'a>,
}

impl Head<'_> {
    fn row(&self, s: &Section) -> ValidationRow {
        let text = |key| Values::text(s, key);
        let id = text(&ROW.id);
        let chapter = text(&ROW.chapter);
        let mechanism = s.word(&ROW.mechanism);
        let kind = s.word(&ROW.kind);
        let compute_text = text(&ROW.compute);
        let compute = expression(s, "compute", &compute_text, &self.names);
        let unit = text(&ROW.unit);
        let is_broken = compute.is_none() && !compute_text.trim().is_empty();
        let printed = printed(s, compute.as_ref(), is_broken);
        let recorded = Verdict::from_word(s.word(&ROW.verdict));
        let reason = text(&ROW.reason);
        let tolerance = self.tolerance(s, printed, &unit, is_broken);
        let expression_or_id = if compute_text.is_empty() {
            "id"
        } else {
            "compute"
        };
        let row = ValidationRow {
            id_place: s.place("id"),
            place: s.place(expression_or_id),
            what: text(&ROW.what),
            condition: text(&ROW.condition),
            printed_text: text(&ROW.printed),
            tolerance_widths: tolerance.map_or([0.0; 2], |found| widths(found, printed)),
            tolerance: tolerance
                .map(|found| found.name.clone())
                .unwrap_or_default(),
            data: text(&ROW.data),
            fitted_to: self.fitted(s),
            remark: text(&ROW.remark),
            cause: self.cause(s),
            about: about(s),
            id,
            chapter,
            mechanism,
            unit,
            kind,
            printed,
            recorded,
            reason,
            compute_text,
            compute,
        };
        complete(s, &row);
        row
    }

    /// The tolerance of printed numbers.
    fn tolerance(
        &self,
        s: &Section,
        printed: Option<Printed>,
        unit: &str,
        is_broken: bool,
    ) -> Option<&Tolerance> {
        let name = s.optional_text(&ROW.tolerance);
        if !matches!(printed, Some(Printed::Range(..))) {
            if name.is_some() && !is_broken {
                s.conflict(
                    "tolerance",
                    "",
                    "only printed numbers have a tolerance",
                    "remove it",
                );
            }
            return None;
        }
        let known = || self.tolerances.iter().map(|t| t.name.as_str());
        let allowed = known().collect::<Vec<_>>().join(", ");
        let Some(name) = name else {
            let hint = "name a tolerance of the head of the file";
            s.complain_by_name(
                ProblemKind::Missing,
                "tolerance",
                &allowed,
                "missing key `tolerance`",
                hint,
            );
            return None;
        };
        let Some(found) = self.tolerances.iter().find(|t| t.name == name) else {
            let message = format!("there is no tolerance `{name}`");
            let hint = did_you_mean(&name, known()).unwrap_or_default();
            s.unknown_name("tolerance", &allowed, &message, &hint);
            return None;
        };
        if found.unit != "-" && found.unit != unit {
            let message = format!("tolerance `{name}` is in {}, the row in {unit}", found.unit);
            s.conflict(
                "tolerance",
                "the same unit",
                &message,
                "use another tolerance",
            );
        }
        Some(found)
    }

    fn fitted(&self, s: &Section) -> Vec<String> {
        let keys = s.texts(&ROW.fitted_to);
        let known = || self.names.keys();
        for key in keys.iter().filter(|key| !known().contains(key)) {
            let known = known().iter().map(String::as_str);
            let hint = did_you_mean(key, known).unwrap_or_default();
            let message = format!("there is no parameter `{key}`");
            let allowed = "keys of a vehicle or lubricant";
            s.unknown_key("fitted_to", allowed, &message, &hint);
        }
        keys
    }

    fn cause(&self, s: &Section) -> Option<Cause> {
        let s = s.table("cause");
        if !s.exists() {
            return None;
        }
        let text = Values::text(&s, &CAUSE.compute);
        Some(Cause {
            what: Values::text(&s, &CAUSE.what),
            unit: Values::text(&s, &CAUSE.unit),
            compute: expression(&s, "compute", &text, &self.names)?,
        })
    }
}

/// The run that a row is about, if it says so.
fn about(row: &Section) -> Option<About> {
    let s = row.table("about");
    s.exists().then(|| About {
        subject: Values::text(&s, &ABOUT.subject),
        baseline: s.optional_text(&ABOUT.baseline),
        cycle: Values::text(&s, &ABOUT.cycle),
        ambient_degc: s.number(&ABOUT.ambient_degc) - ZERO_DEGC_K,
        start: s.word(&ABOUT.start).to_owned(),
        phase: s.optional_text(&ABOUT.phase),
    })
}

/// Widths of a tolerance below and above what is printed, in the unit of the row.
fn widths(tolerance: &Tolerance, printed: Option<Printed>) -> [f64; 2] {
    let Some(Printed::Range(low, high)) = printed else {
        return [0.0; 2];
    };
    // An open end has no share.
    let size = |end: f64| Some(end.abs()).filter(|size| size.is_finite());
    [low, high].map(|end| tolerance.absolute + tolerance.relative * size(end).unwrap_or(0.0))
}
