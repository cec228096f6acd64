//! Meanings of words: keys with their values in the shipped files, columns, flags, equations, terms of the field.

use std::sync::OnceLock;

use cvtcycle_config::procedure::TEST_FILE;
use cvtcycle_config::setup::catalogue::{self, ENGINE_OIL, File, OIL};
use cvtcycle_config::{KeyInfo, Problem, near, suggestion};
use cvtcycle_model::transmission::loss_factor;
use cvtcycle_output::table::Head;
use cvtcycle_output::trace::COLUMNS;
use cvtcycle_output::{Component, Flags};
use serde_json::{Value, json};

use crate::equations::{Equation, by_label, equations, of_labels};
use cvtcycle_analysis::levers::keys::LEVER_FILE;
use cvtcycle_calibrate::plan::keys::CALIBRATION;
use cvtcycle_study::execute::outputs::outputs;
use cvtcycle_study::plan::PLAN;
use cvtcycle_validate::keys::VALIDATION;

/// Largest number of entries that are found by the words of their meanings.
const MAX_FOUND: usize = 12;

/// Everything that a word means.
#[derive(Default)]
pub struct Meanings {
    /// Keys with their values in each embedded file that has them.
    pub keys: Vec<(&'static KeyInfo, Vec<(&'static str, KeyInfo)>)>,
    /// Columns with the name of their table.
    pub columns: Vec<(&'static str, Head)>,
    /// Names and meanings of flags.
    pub flags: Vec<(&'static str, &'static str)>,
    /// The equation of that label.
    pub equation: Option<Equation>,
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

/// A key with its value as a JSON object.
#[must_use]
pub fn key_json(info: &KeyInfo) -> Value {
    json!({
        "key": info.key, "value": info.value, "unit": info.unit, "status": info.status, "source": info.source,
        "note": info.note, "from": info.from, "allowed": info.allowed, "meaning": info.meaning(),
    })
}

impl Meanings {
    /// Finds a key, table, column, flag, label or term by its name; else every entry that has all of the words in its meaning.
    ///
    /// ```
    /// use cvtcycle::explain::Meanings;
    /// let offset = Meanings::find("band_offset_mm")?;
    /// assert_eq!(offset.keys[0].0.key, "transmission.cvt.belt.band_offset_mm");
    /// assert!(Meanings::find("band_ofset_mm").is_err());
    /// # Ok::<(), cvtcycle_config::Problem>(())
    /// ```
    ///
    /// # Errors
    /// A word that is not known, with those like it.
    pub fn find(word: &str) -> Result<Meanings, Problem> {
        let mut meanings = Meanings::default();
        meanings.add(word);
        if meanings.is_empty() {
            names_of(word).iter().for_each(|name| meanings.add(name));
        }
        if meanings.is_empty() {
            meanings.add_keys(word, plan_keys());
        }
        if meanings.is_empty() {
            meanings.search(word);
        }
        if meanings.is_empty() {
            return Err(unknown(word));
        }
        meanings.add_values(&catalogue::files());
        Ok(meanings)
    }

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

    /// As a JSON object.
    #[must_use]
    pub fn json(&self, word: &str) -> Value {
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

/// Keys of the plans of studies and calibrations, of lever files, of validation files and of tests.
pub fn plan_keys() -> &'static [KeyInfo] {
    static KEYS: OnceLock<Vec<KeyInfo>> = OnceLock::new();
    KEYS.get_or_init(|| {
        let files = [PLAN, LEVER_FILE, CALIBRATION, VALIDATION, TEST_FILE];
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
    let problem = Problem::invalid(message).value(word).allowed(allowed);
    problem.hint(hint)
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
