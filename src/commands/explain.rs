//! `explain`: the meaning of a key, a column, a flag, an equation or a term of the field.

mod flags;
mod terms;

use clap::Args;
use cvtcycle::config::setup::assumptions::value;
use cvtcycle::config::setup::catalogue::{self, ENGINE_OIL, File, OIL};
use cvtcycle::config::{KeyInfo, Problem, Problems, near, suggestion};
use cvtcycle::output::table::Head;
use cvtcycle::output::trace::{COLUMNS, column};
use cvtcycle::output::{Component, Flags};
use cvtcycle::study::equations::{Equation, by_label, cited, equations};
use cvtcycle::study::outputs::outputs;
use serde_json::{Value, json};

use super::Execute;
use super::show::KeyLine;
use crate::args::JsonArgs;
use crate::args::problems::bad_value;
use crate::print::colour::Paint;
use crate::print::table::TextTable;
use crate::print::{CommandOutput, CommandResult, Terminal};

/// Arguments of `explain`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  cvtcycle explain transmission.cvt.belt.band_offset_mm
  cvtcycle explain displacement_cc_rev
  cvtcycle explain transmission.cvt.pump
  cvtcycle explain clamp_safety
  cvtcycle explain road-load
  cvtcycle explain SL-8

The end of a key is enough (band_offset_mm); for a table all of its keys are explained.")]
pub struct ExplainArgs {
    /// Key, table, column of a trace or summary, flag, label of an equation, or term such as road-load
    #[arg(value_name = "KEY")]
    key: String,
    #[command(flatten)]
    output: JsonArgs,
}

/// A key with its value in each embedded file that has it.
struct ExplainedKey {
    known: KeyInfo,
    values: Vec<(&'static str, KeyInfo)>,
}

/// A column of the trace or of the summary.
struct ExplainedColumn {
    table: &'static str,
    name: String,
    unit: String,
    doc: String,
}

/// Everything that a word means.
#[derive(Default)]
pub struct Meanings {
    keys: Vec<ExplainedKey>,
    columns: Vec<ExplainedColumn>,
    flags: Vec<(&'static str, &'static str)>,
    equation: Option<Equation>,
}

impl Execute for ExplainArgs {
    type Plan = Meanings;

    fn plan(&self, problems: &mut Problems) -> Option<Meanings> {
        let word = self.key.trim();
        let mut meanings = Meanings::default();
        let files = catalogue::files();
        meanings.add(word, &files);
        if meanings.is_empty() {
            for name in terms::names_of(word) {
                meanings.add(name, &files);
            }
        }
        if meanings.is_empty() {
            problems.add(unknown(word));
            return None;
        }
        Some(meanings)
    }

    fn run(&self, meanings: Meanings, terminal: Terminal) -> CommandResult {
        if self.output.json {
            return CommandOutput::json(&meanings.json(self.key.trim()));
        }
        Ok(CommandOutput::text(meanings.text(terminal.stdout)))
    }
}

impl Meanings {
    /// Adds what has this very name.
    fn add(&mut self, name: &str, files: &[File]) {
        let keys = matching_keys(name).into_iter();
        self.keys
            .extend(keys.map(|key| ExplainedKey::new(key, files)));
        self.columns.extend(column(name).map(|c| ExplainedColumn {
            table: "trace",
            name: c.name.to_string(),
            unit: c.unit.to_owned(),
            doc: c.doc.to_string(),
        }));
        let in_summary = summary_columns().into_iter();
        self.columns.extend(
            in_summary
                .filter(|c| c.name == name)
                .map(|c| ExplainedColumn {
                    table: "summary",
                    name: c.name,
                    unit: c.unit,
                    doc: c.doc,
                }),
        );
        self.flags.extend(flags::meaning(name));
        self.equation = self.equation.take().or(by_label(name));
    }

    fn is_empty(&self) -> bool {
        self.keys.is_empty()
            && self.columns.is_empty()
            && self.flags.is_empty()
            && self.equation.is_none()
    }

    fn json(&self, word: &str) -> Value {
        let equation = |e: &Equation| json!({ "label": e.label, "statement": e.statement, "status": e.status, "module": e.module });
        let key = |found: &ExplainedKey| {
            let entry = |(file, info): &(&str, KeyInfo)| json!({ "file": file, "entry": KeyLine::from(info) });
            json!({
                "key": found.known.key, "unit": found.known.unit, "allowed": found.known.allowed, "meaning": found.known.doc,
                "equations": cited(&found.known.doc).iter().map(equation).collect::<Vec<_>>(),
                "values": found.values.iter().map(entry).collect::<Vec<_>>(),
            })
        };
        let column = |c: &ExplainedColumn| json!({ "name": c.name, "unit": c.unit, "meaning": c.doc, "table": c.table });
        let flag = |(name, meaning): &(&str, &str)| json!({ "name": name, "meaning": meaning });
        json!({
            "name": word,
            "keys": self.keys.iter().map(key).collect::<Vec<_>>(),
            "column": self.columns.first().map(column),
            "columns": self.columns.iter().map(column).collect::<Vec<_>>(),
            "flag": self.flags.first().map(flag),
            "equation": self.equation.as_ref().map(equation),
        })
    }

    fn text(&self, paint: Paint) -> String {
        let mut parts: Vec<String> = self.keys.iter().map(|found| found.text(paint)).collect();
        for c in &self.columns {
            let what = format!("column of the {}", c.table);
            let facts = [
                ("what", &*what),
                ("meaning", &*c.doc),
                ("unit", or_none(&c.unit)),
            ];
            parts.push(paragraph(&c.name, &facts, paint));
        }
        for (name, meaning) in &self.flags {
            let what =
                "flag of a time step, in the column `flags`; seconds in `flags_s` of the summary";
            parts.push(paragraph(
                name,
                &[("what", what), ("meaning", meaning)],
                paint,
            ));
        }
        if let Some(e) = &self.equation {
            let facts = [
                ("what", "equation of the model"),
                ("statement", &*e.statement.replace("\\|", "|")),
                ("status", e.status),
                ("module", e.module),
            ];
            parts.push(paragraph(e.label, &facts, paint));
        }
        parts.join("\n")
    }
}

impl ExplainedKey {
    fn new(known: KeyInfo, files: &[File]) -> Self {
        let of_file = |file: &File| {
            let info = file
                .keys
                .iter()
                .find(|info| file.full_key(&info.key) == known.key)?;
            (!info.status.is_empty()).then(|| (file.name, info.clone()))
        };
        let values = files.iter().filter_map(of_file).collect();
        ExplainedKey { known, values }
    }

    fn text(&self, paint: Paint) -> String {
        let known = &self.known;
        let mut facts = vec![
            ("meaning", &*known.doc),
            ("unit", or_none(&known.unit)),
            ("allowed", &*known.allowed),
        ];
        let equation = |e: &Equation| {
            format!(
                "{}: {} ({})",
                e.label,
                e.statement.replace("\\|", "|"),
                e.status
            )
        };
        let equations: Vec<String> = cited(&known.doc).iter().map(equation).collect();
        for (k, text) in equations.iter().enumerate() {
            facts.push((if k == 0 { "equation" } else { "" }, text));
        }
        let text = paragraph(&known.key, &facts, paint);
        if self.values.is_empty() {
            return text + "  not set in any built-in file\n";
        }
        let mut table = TextTable::new("llll").indented();
        for (file, info) in &self.values {
            let own = value(info);
            let long = own.chars().count() > 24;
            let (shown, moved) = if long { ("", &*own) } else { (&*own, "") };
            let remarks = [moved, &info.source, &info.note]
                .into_iter()
                .filter(|text| !text.is_empty());
            let remarks = remarks.collect::<Vec<_>>().join("; ");
            table.row([file, shown, &info.status, &remarks]);
        }
        text + &table.text()
    }
}

fn or_none(unit: &str) -> &str {
    if matches!(unit, "" | "-") {
        "none"
    } else {
        unit
    }
}

fn paragraph(name: &str, facts: &[(&str, &str)], paint: Paint) -> String {
    let mut table = TextTable::new("ll").indented().min_widths(&[9]);
    facts
        .iter()
        .for_each(|(name, text)| table.row([name, text]));
    format!("{}\n{}", paint.heading(name), table.text())
}

/// Columns of the summary for all components; those of single phases are left out.
fn summary_columns() -> Vec<Head> {
    let columns = outputs(&[], &Component::ALL);
    columns.iter().map(|column| column.head()).collect()
}

/// The key itself, else keys that end in the word, else the keys of the table of that name.
fn matching_keys(word: &str) -> Vec<KeyInfo> {
    let word = match word.strip_prefix(ENGINE_OIL) {
        Some(rest) => format!("{OIL}{rest}"),
        None => word.to_owned(),
    };
    let (end, start) = (format!(".{word}"), format!("{word}."));
    let tests: [&dyn Fn(&str) -> bool; 3] =
        [&|key| key == word, &|key| key.ends_with(&end), &|key| {
            key.starts_with(&start)
        }];
    let pick = |test: &&dyn Fn(&str) -> bool| {
        let known = catalogue::known_keys().iter();
        known
            .filter(|info| test(&info.key))
            .cloned()
            .collect::<Vec<_>>()
    };
    tests
        .iter()
        .map(pick)
        .find(|keys| !keys.is_empty())
        .unwrap_or_default()
}

fn unknown(word: &str) -> Problem {
    // A word without a dot is compared with the last parts of the keys, because their beginnings are long.
    let last = |key: &str| key.rsplit('.').next().unwrap_or(key).to_owned();
    let key_name = |key: &str| {
        if word.contains('.') {
            key.to_owned()
        } else {
            last(key)
        }
    };
    let keys = catalogue::known_keys()
        .iter()
        .map(|info| (key_name(&info.key), info.key.clone()));
    let others = COLUMNS.iter().map(|column| column.name.to_string());
    let others = others.chain(summary_columns().into_iter().map(|head| head.name));
    let others = others.chain(Flags::NAMES.iter().map(|(_, name)| (*name).to_owned()));
    let others = others.chain(equations().map(|equation| equation.label.to_owned()));
    let others = others.chain(terms::terms().map(|term| term.replace(' ', "-")));
    let names: Vec<(String, String)> = keys
        .chain(others.map(|name| (name.clone(), name)))
        .collect();
    let close = near(word, names.iter().map(|(name, _)| name.as_str()));
    let full = |name: &&str| {
        names
            .iter()
            .filter(move |(own, _)| own == name)
            .map(|(_, key)| key.as_str())
            .collect::<Vec<_>>()
    };
    let mut full: Vec<&str> = close.iter().flat_map(full).collect();
    full.dedup();
    full.truncate(4);
    let hint = suggestion(&full)
        .unwrap_or_else(|| "`cvtcycle show rover_216_cvt` prints all keys of a vehicle".to_owned());
    let allowed = "a key, table, column, flag, label of an equation, or term";
    bad_value(
        "explain",
        word,
        allowed,
        &format!("`{word}` is not known"),
        &hint,
    )
}
