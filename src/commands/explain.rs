//! `explain`: what a key, a trace column, a flag or an equation's label means.

mod flags;
mod text;

use cvtcycle::config::setup::catalogue::{self, ENGINE_OIL, File, OIL};
use cvtcycle::config::setup::equations::{Equation, by_label, cited, equations};
use cvtcycle::config::{KeyInfo, Problem, near};
use cvtcycle::output::Flags;
use cvtcycle::output::trace::{COLUMNS, TraceColumn, column};
use serde_json::{Value, json};

use super::Context;
use super::show::KeyLine;
use crate::args::bad_value;
use crate::print::{Answer, Reply};

/// Arguments of `explain`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  cvtcycle explain transmission.cvt.belt.band_offset_mm
  cvtcycle explain displacement_cc_rev
  cvtcycle explain transmission.cvt.pump
  cvtcycle explain clamp_safety
  cvtcycle explain SL-8

The end of a key is enough (band_offset_mm); a table explains the keys in it.")]
pub struct Args {
    /// Key, table, trace column, flag, or label of an equation
    #[arg(value_name = "KEY")]
    key: String,
    /// Print one JSON object instead of text
    #[arg(long)]
    json: bool,
}

/// A key with its value in each embedded file that has it.
struct Found {
    known: KeyInfo,
    values: Vec<(&'static str, KeyInfo)>,
}

/// Everything that bears the name asked for.
struct Meanings {
    keys: Vec<Found>,
    column: Option<&'static TraceColumn>,
    flag: Option<(&'static str, &'static str)>,
    equation: Option<Equation>,
}

/// Runs the command.
pub fn answer(args: &Args, context: Context) -> Reply {
    let word = args.key.trim();
    let known = catalogue::known_keys();
    let files = catalogue::files();
    let meanings = Meanings {
        keys: matching(word, known)
            .into_iter()
            .map(|known| found(known, &files))
            .collect(),
        column: column(word),
        flag: flags::meaning(word),
        equation: by_label(word),
    };
    if meanings.keys.is_empty()
        && meanings.column.is_none()
        && meanings.flag.is_none()
        && meanings.equation.is_none()
    {
        return Err(unknown(word, known).into());
    }
    if args.json {
        Answer::json(&as_json(word, &meanings))
    } else {
        Ok(Answer::text(text::of(&meanings, context.paint)))
    }
}

/// The key itself, else keys that end in the word, else the keys of the table of that name.
fn matching(word: &str, known: &[KeyInfo]) -> Vec<KeyInfo> {
    let word = word
        .strip_prefix(ENGINE_OIL)
        .map_or_else(|| word.to_owned(), |rest| format!("{OIL}{rest}"));
    let (end, start) = (format!(".{word}"), format!("{word}."));
    let pick = |keep: &dyn Fn(&str) -> bool| {
        known
            .iter()
            .filter(|k| keep(&k.key))
            .cloned()
            .collect::<Vec<_>>()
    };
    let exact = pick(&|key| key == word);
    if !exact.is_empty() {
        return exact;
    }
    let ends = pick(&|key| key.ends_with(&end));
    if ends.is_empty() {
        pick(&|key| key.starts_with(&start))
    } else {
        ends
    }
}

fn found(known: KeyInfo, files: &[File]) -> Found {
    let of_file = |file: &File| {
        let info = file
            .keys
            .iter()
            .find(|info| file.full_key(&info.key) == known.key)?;
        (!info.status.is_empty()).then(|| (file.name, info.clone()))
    };
    let values = files.iter().filter_map(of_file).collect();
    Found { known, values }
}

fn unknown(word: &str, known: &[KeyInfo]) -> Problem {
    let last = |key: &str| key.rsplit('.').next().unwrap_or(key).to_owned();
    // A bare word is held against the last parts of the keys: their long beginnings say nothing about a slip.
    let bare = !word.contains('.');
    let mut names: Vec<(String, String)> = known
        .iter()
        .map(|info| {
            (
                if bare {
                    last(&info.key)
                } else {
                    info.key.clone()
                },
                info.key.clone(),
            )
        })
        .collect();
    let others = COLUMNS
        .iter()
        .map(|c| &*c.name)
        .chain(Flags::NAMES.iter().map(|(_, name)| *name));
    names.extend(others.map(|name| (name.to_owned(), name.to_owned())));
    names.extend(equations().map(|e| (e.label.to_owned(), e.label.to_owned())));
    let close = near(word, names.iter().map(|(name, _)| name.as_str()));
    let mut full: Vec<&str> = close
        .iter()
        .flat_map(|name| names.iter().filter(move |(n, _)| n == name))
        .map(|(_, key)| key.as_str())
        .collect();
    full.dedup();
    full.truncate(4);
    let hint = if full.is_empty() {
        "`cvtcycle show rover_216_cvt` prints all keys of a vehicle".to_owned()
    } else {
        format!("did you mean {}?", full.join(" or "))
    };
    bad_value(
        "explain",
        word,
        "a key, table, trace column, flag or label of an equation",
        format!("`{word}` is not known"),
        hint,
    )
}

fn as_json(word: &str, meanings: &Meanings) -> Value {
    let equation = |e: &Equation| json!({ "label": e.label, "statement": e.statement, "status": e.status, "file": e.file });
    let key = |found: &Found| {
        let values = found
            .values
            .iter()
            .map(|(file, info)| json!({ "file": file, "entry": KeyLine::from(info) }));
        json!({
            "key": found.known.key, "unit": found.known.unit, "allowed": found.known.allowed, "meaning": found.known.doc,
            "equations": cited(&found.known.doc).iter().map(equation).collect::<Vec<_>>(),
            "values": values.collect::<Vec<_>>(),
        })
    };
    json!({
        "name": word,
        "keys": meanings.keys.iter().map(key).collect::<Vec<_>>(),
        "column": meanings.column.map(|c| json!({ "name": c.name, "unit": c.unit, "meaning": c.doc })),
        "flag": meanings.flag.map(|(name, meaning)| json!({ "name": name, "meaning": meaning })),
        "equation": meanings.equation.as_ref().map(equation),
    })
}
