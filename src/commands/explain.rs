//! `explain`: the meaning of a key, a column, a flag, an equation or a term of the field.

use std::sync::OnceLock;

use clap::Args;
use cvtcycle::config::setup::catalogue::{self, ENGINE_OIL, File, OIL};
use cvtcycle::config::{KeyInfo, Problem, Problems, near, suggestion};
use cvtcycle::model::transmission::loss_factor;
use cvtcycle::output::table::{Head, TextTable};
use cvtcycle::output::trace::COLUMNS;
use cvtcycle::output::{Component, Flags};
use cvtcycle::study::check::keys::VALIDATION;
use cvtcycle::study::equations::{Equation, by_label, equations, of_labels};
use cvtcycle::study::execute::outputs::outputs;
use cvtcycle::study::fit::plan::keys::CALIBRATION;
use cvtcycle::study::levers::keys::LEVER_FILE;
use cvtcycle::study::plan::PLAN;
use serde_json::{Value, json};

use super::Execute;
use super::show::{key_json, value_row};
use crate::args::JsonArgs;
use crate::args::problems::bad_value;
use crate::print::colour::Paint;
use crate::print::{CommandOutput, CommandResult, Terminal};

/// Longest value in the column of values.
const MAX_VALUE_LEN: usize = 24;
/// Largest number of entries that are found by the words of their meanings.
const MAX_FOUND: usize = 12;

/// Arguments of `explain`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  cvtcycle explain transmission.cvt.belt.band_offset_mm
  cvtcycle explain displacement_cc_rev
  cvtcycle explain transmission.cvt.pump
  cvtcycle explain clamp_safety
  cvtcycle explain torque capacity
  cvtcycle explain SL-8
  cvtcycle explain calibration.starts

The end of a key is enough (band_offset_mm); for a table all of its keys are explained. A term of the field finds the keys, columns \
and flags that belong to it; other words find those whose meanings contain all of them.")]
pub struct ExplainArgs {
    /// Key, table, column of a trace or summary, flag, label of an equation, or words such as road load
    #[arg(value_name = "KEY", required = true)]
    key: Vec<String>,
    #[command(flatten)]
    output: JsonArgs,
}

/// Everything that a word means.
#[derive(Default)]
pub struct Meanings {
    /// Keys with their values in each embedded file that has them.
    keys: Vec<(&'static KeyInfo, Vec<(&'static str, KeyInfo)>)>,
    /// Columns with the name of their table.
    columns: Vec<(&'static str, Head)>,
    /// Names and meanings of flags.
    flags: Vec<(&'static str, &'static str)>,
    equation: Option<Equation>,
}

impl Execute for ExplainArgs {
    type Plan = (String, Meanings);

    fn plan(&self, problems: &mut Problems) -> Option<Self::Plan> {
        let word = self.key.join(" ").trim().to_owned();
        let mut meanings = Meanings::default();
        meanings.add(&word);
        if meanings.is_empty() {
            names_of(&word).iter().for_each(|name| meanings.add(name));
        }
        if meanings.is_empty() {
            meanings.add_keys(&word, plan_keys());
        }
        if meanings.is_empty() {
            meanings.search(&word);
        }
        if meanings.is_empty() {
            problems.add(unknown(&word));
            return None;
        }
        meanings.add_values(&catalogue::files());
        Some((word, meanings))
    }

    fn run(&self, (word, meanings): Self::Plan, terminal: Terminal) -> CommandResult {
        if self.output.json {
            return CommandOutput::json(&meanings.json(&word));
        }
        Ok(CommandOutput::text(meanings.text(terminal.stdout)))
    }
}

/// Columns of the traces and of the summary, with the name of their table; those of single phases are left out.
fn all_columns() -> impl Iterator<Item = (&'static str, Head)> {
    let trace = COLUMNS.iter().map(|column| ("trace", column.head()));
    let summary = outputs(&[], &Component::ALL).into_iter();
    trace.chain(summary.map(|column| ("summary", column.head())))
}

/// Names and meanings of the flags.
fn all_flags() -> impl Iterator<Item = (&'static str, &'static str)> {
    let names = Flags::NAMES.into_iter().map(|(_, name)| name);
    names.zip(Flags::MEANINGS)
}

impl Meanings {
    /// Adds what has this very name.
    fn add(&mut self, name: &str) {
        self.add_keys(name, catalogue::known_keys());
        self.columns
            .extend(all_columns().filter(|(_, column)| column.name == name));
        self.flags
            .extend(all_flags().filter(|(own, _)| *own == name));
        self.equation = self.equation.take().or(by_label(name));
    }

    fn add_keys(&mut self, name: &str, known: &'static [KeyInfo]) {
        let keys = matching_keys(name, known).into_iter();
        self.keys.extend(keys.map(|key| (key, Vec::new())));
    }

    /// Adds what has all words in its name or meaning, up to [`MAX_FOUND`] entries of each kind.
    fn search(&mut self, text: &str) {
        let split = |c: char| !c.is_alphanumeric();
        let text = text.to_lowercase();
        let words: Vec<&str> = text.split(split).filter(|word| word.len() > 2).collect();
        let has = |name: &str, doc: &str| {
            let text = format!("{name} {doc}").to_lowercase();
            let own: Vec<&str> = text.split(split).collect();
            // A plural finds the singular.
            let is_in =
                |word: &&str| own.contains(word) || own.contains(&word.trim_end_matches('s'));
            !words.is_empty() && words.iter().all(is_in)
        };
        let known = catalogue::known_keys().iter();
        let keys = known.filter(|info| has(&info.key, &info.meaning()));
        self.keys
            .extend(keys.map(|key| (key, Vec::new())).take(MAX_FOUND));
        let columns = all_columns().filter(|(_, column)| has(&column.name, &column.doc));
        self.columns.extend(columns.take(MAX_FOUND));
        let flags = all_flags().filter(|(name, meaning)| has(name, meaning));
        self.flags.extend(flags);
    }

    fn add_values(&mut self, files: &[File]) {
        for (known, values) in &mut self.keys {
            let of_file = |file: &File| {
                let mut keys = file.keys.iter();
                let info = keys.find(|info| file.full_key(&info.key) == known.key)?;
                (!info.status.is_empty()).then(|| (file.name, info.clone()))
            };
            values.extend(files.iter().filter_map(of_file));
        }
    }

    fn is_empty(&self) -> bool {
        let named = self.keys.len() + self.columns.len() + self.flags.len();
        named == 0 && self.equation.is_none()
    }

    fn json(&self, word: &str) -> Value {
        let equation = |e: &Equation| json!({ "label": e.label, "statement": e.statement, "status": e.status, "module": e.module });
        let key = |(known, values): &(&KeyInfo, Vec<(&str, KeyInfo)>)| {
            let entry =
                |(file, info): &(&str, KeyInfo)| json!({ "file": file, "entry": key_json(info) });
            json!({
                "key": known.key, "unit": known.unit, "allowed": known.allowed, "meaning": known.meaning(),
                "equations": of_labels(known.labels).map(|e| equation(&e)).collect::<Vec<_>>(),
                "values": values.iter().map(entry).collect::<Vec<_>>(),
            })
        };
        let column = |(table, c): &(&str, Head)| json!({ "name": c.name, "unit": c.unit, "meaning": c.doc, "table": table });
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
        let keys = self
            .keys
            .iter()
            .map(|(known, values)| key_text(known, values, paint));
        let columns = self.columns.iter().map(|(table, c)| {
            let what = format!("column of the {table}");
            let unit = or_none(&c.unit);
            let facts = [("what", &*what), ("meaning", &c.doc), ("unit", unit)];
            paragraph(&c.name, &facts, paint)
        });
        let flags = self.flags.iter().map(|(name, meaning)| {
            let what =
                "flag of a time step, in the column `flags`; seconds in `flags_s` of the summary";
            paragraph(name, &[("what", what), ("meaning", meaning)], paint)
        });
        let equation = self.equation.iter().map(|e| {
            let facts = [
                ("what", "equation of the model"),
                ("statement", &*e.statement.replace("\\|", "|")),
                ("status", e.status),
                ("module", e.module),
            ];
            paragraph(e.label, &facts, paint)
        });
        let all = keys.chain(columns).chain(flags).chain(equation);
        all.collect::<Vec<_>>().join("\n")
    }
}

fn key_text(known: &KeyInfo, values: &[(&str, KeyInfo)], paint: Paint) -> String {
    let (meaning, unit) = (known.meaning(), or_none(&known.unit));
    let mut facts = vec![
        ("meaning", &*meaning),
        ("unit", unit),
        ("allowed", &*known.allowed),
    ];
    let equation = |e: &Equation| {
        let statement = e.statement.replace("\\|", "|");
        format!("{}: {statement} ({})", e.label, e.status)
    };
    let equations: Vec<String> = of_labels(known.labels).map(|e| equation(&e)).collect();
    let names = ["equation"].into_iter().chain(std::iter::repeat(""));
    facts.extend(names.zip(equations.iter().map(String::as_str)));
    if plan_keys().iter().any(|key| std::ptr::eq(key, known)) {
        facts.insert(0, ("what", "key of the plan of a study"));
        return paragraph(&known.key, &facts, paint);
    }
    let text = paragraph(&known.key, &facts, paint);
    if values.is_empty() {
        return text + "  not set in any built-in file\n";
    }
    let mut table = TextTable::new("llll").indented();
    for (file, info) in values {
        table.row(value_row(file, info, MAX_VALUE_LEN, ""));
    }
    text + &table.text()
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
    for &(name, text) in facts {
        table.row([name, text]);
    }
    format!("{}\n{}", paint.heading(name), table.text())
}

/// The key itself, else keys that end in the word, else the keys of the table of that name.
fn matching_keys(word: &str, known: &'static [KeyInfo]) -> Vec<&'static KeyInfo> {
    let word = match word.strip_prefix(ENGINE_OIL) {
        Some(rest) => format!("{OIL}{rest}"),
        None => word.to_owned(),
    };
    let (end, start) = (format!(".{word}"), format!("{word}."));
    let pick = |test: &dyn Fn(&str) -> bool| {
        let known = known.iter();
        let keys: Vec<_> = known.filter(|info| test(&info.key)).collect();
        (!keys.is_empty()).then_some(keys)
    };
    pick(&|key| key == word)
        // The name of a component is no question for its factor.
        .or_else(|| pick(&|key| key.ends_with(&end) && !loss_factor::is_key(key)))
        .or_else(|| pick(&|key| key.starts_with(&start)))
        .unwrap_or_default()
}

/// Keys of the plans of studies and calibrations, of lever files and of validation files.
fn plan_keys() -> &'static [KeyInfo] {
    static KEYS: OnceLock<Vec<KeyInfo>> = OnceLock::new();
    KEYS.get_or_init(|| {
        let files = [PLAN, LEVER_FILE, CALIBRATION, VALIDATION];
        files.iter().flat_map(catalogue::keys_of).collect()
    })
}

fn unknown(word: &str) -> Problem {
    // A word without a dot is compared with the last parts of the keys, because their beginnings are long.
    let name = |key: &str| match word.contains('.') {
        true => key.to_owned(),
        false => key.rsplit('.').next().unwrap_or(key).to_owned(),
    };
    let keys = catalogue::known_keys().iter().chain(plan_keys());
    let keys = keys.map(|info| (name(&info.key), info.key.clone()));
    let others = all_columns().map(|(_, column)| column.name);
    let others = others.chain(all_flags().map(|(name, _)| name.to_owned()));
    let others = others.chain(equations().map(|equation| equation.label.to_owned()));
    let others = others.chain(terms().map(|term| term.replace(' ', "-")));
    let names: Vec<(String, String)> = keys
        .chain(others.map(|name| (name.clone(), name)))
        .collect();
    let close = near(word, names.iter().map(|(name, _)| name.as_str()));
    let full = |name: &&str| {
        let same = names.iter().filter(|(own, _)| own == name);
        same.map(|(_, key)| key.as_str()).collect::<Vec<_>>()
    };
    let mut full: Vec<&str> = close.iter().flat_map(full).collect();
    full.dedup();
    full.truncate(4);
    let hint = suggestion(&full)
        .unwrap_or_else(|| "`cvtcycle show rover_216_cvt` prints all keys of a vehicle".to_owned());
    let allowed = "a key, table, column, flag, label of an equation, or term";
    let message = format!("`{word}` is not known");
    bad_value("explain", word, allowed, &message, &hint)
}

/// Terms of the field, a line for each concept: its terms, a colon, the names.
const TERMS: &str = include_str!("explain/terms.txt");

/// Items of a list separated by commas.
fn items(list: &'static str) -> impl Iterator<Item = &'static str> {
    list.split(',').map(str::trim)
}

fn concepts() -> impl Iterator<Item = (&'static str, &'static str)> {
    TERMS.lines().filter_map(|line| line.split_once(':'))
}

/// All terms.
fn terms() -> impl Iterator<Item = &'static str> {
    concepts().flat_map(|(terms, _)| items(terms))
}

/// Names of keys, tables, columns and flags that belong to a term; `-` and `_` count as blanks.
fn names_of(word: &str) -> Vec<&'static str> {
    let plain = |text: &str| text.to_lowercase().replace(['-', '_'], " ");
    let has = |terms| items(terms).any(|term| plain(term) == plain(word));
    let found = concepts().find(|(terms, _)| has(terms));
    found.map_or_else(Vec::new, |(_, names)| items(names).collect())
}
