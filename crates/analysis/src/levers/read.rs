//! A TOML file to its levers.

use super::keys::{LEVER, LEVERS};
use super::{Lever, LeverFile};
use cvtcycle_config::ProblemKind::{Duplicate, Missing};
use cvtcycle_config::setup::{Kind, NamedBy, catalogue, is_path, text_of};
use cvtcycle_config::{Document, Problem, Problems, Reader, Section, did_you_mean};
use cvtcycle_model::keys::{Key, Values};
use std::path::Path;

pub(super) fn open(word: &str) -> Result<LeverFile, Problems> {
    let (name, text, _) = text_of(word, Kind::Levers, NamedBy::Caller)?;
    file(&name, &text)
}

pub(super) fn file(file: &str, text: &str) -> Result<LeverFile, Problems> {
    let mut document = Document::parse(file, text)?;
    let tables = document.take_tables("lever");
    let reader = Reader::new(&document);
    let head = reader.root().table("levers");
    let title = head.text_or(&LEVERS.title, file);
    let of_cvt = match head.word(&LEVERS.transmission) {
        "cvt" => Some(true),
        "manual" => Some(false),
        _ => None,
    };
    let mut problems = reader.finish().err().unwrap_or_default();
    let mut levers: Vec<Lever> = Vec::new();
    for table in &tables {
        let Some(lever) = problems.take(lever(table, file)) else {
            continue;
        };
        let lever = Lever { of_cvt, ..lever };
        if let Some(earlier) = levers.iter().find(|other| other.name == lever.name) {
            let line = earlier.place.line;
            let message = format!("the name `{}` was used before, in line {line}", lever.name);
            let problem = Problem::new(Duplicate, message).at(lever.place.clone());
            problems.push(problem.key("lever.name").hint("names are unique"));
        }
        levers.push(lever);
    }
    if tables.is_empty() && problems.is_empty() {
        let problem = Problem::new(Missing, "the file has no lever").in_file(file);
        problems.push(
            problem
                .key("lever")
                .hint("add [[lever]] with a name and what it sets"),
        );
    }
    problems.sort_by_key(|problem| (problem.place.line, problem.place.column));
    problems.finish().map(|()| LeverFile {
        file: file.to_owned(),
        title,
        levers,
    })
}

fn lever(document: &Document, file: &str) -> Result<Lever, Problems> {
    let reader = Reader::new(document);
    let s = reader.root();
    let name = Values::text(&s, &LEVER.name);
    let is_plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    let is_taken = ["reference", "combination"].contains(&name.as_str());
    if s.has("name") && (name.is_empty() || is_taken || !name.chars().all(is_plain)) {
        let message = format!("`{name}` is no name of a lever");
        let hint = "`reference` and `combination` are taken";
        s.unknown_name("name", "letters a-z, digits and _", &message, hint);
    }
    let oil = |row: &Key| {
        s.optional_text(row)
            .map(|word| match Path::new(file).parent() {
                Some(folder) if is_path(&word) => folder.join(&word).to_string_lossy().into_owned(),
                _ => word,
            })
    };
    let lever = Lever {
        title: s.text_or(&LEVER.title, &name),
        set: s.overrides(&LEVER.set),
        lubricant: oil(&LEVER.lubricant),
        engine_oil: oil(&LEVER.engine_oil),
        group: s.optional_text(&LEVER.group),
        combine: Values::flag(&s, &LEVER.combine),
        needs: s.text_or(&LEVER.needs, ""),
        status: s.word(&LEVER.status).to_owned(),
        source: s.text_or(&LEVER.source, ""),
        of_cvt: None,
        is_named: false,
        place: s.place("name"),
        set_place: s.place("set"),
        name,
    };
    changes(&s);
    known(&s, &lever);
    let of = match lever.name.as_str() {
        "" => String::new(),
        name => format!("lever {name}: "),
    };
    reader
        .finish()
        .map(|_| lever)
        .map_err(|problems| problems.map(|problem| problem.with_context(&of)))
}

/// Complains about keys that no car has.
fn known(s: &Section, lever: &Lever) {
    let unknown = lever.set.iter().filter(|by| by.row().is_none());
    for by in unknown {
        let names = catalogue::known_names().iter().map(String::as_str);
        let hint = did_you_mean(by.key(), names);
        let problem = Problem::unknown_key(format!("unknown key `{}`", by.key()))
            .at(lever.set_place.clone().of_item(&by.to_string()))
            .key("set")
            .value(by.to_string())
            .hint(hint.unwrap_or_else(|| "`cvtcycle show` lists the keys".to_owned()));
        s.report_problem(problem);
    }
}

/// Complains where nothing is changed.
fn changes(s: &Section) {
    let ways = ["set", "lubricant", "engine_oil"];
    let none = s.written(&LEVER.set).and_then(|set| set.items());
    let is_empty = none.is_some_and(|items| items.is_empty());
    if is_empty || !ways.iter().any(|way| s.has(way)) {
        let hint = "add set = [\"KEY=VALUE\"] or lubricant = \"NAME\"";
        s.missing(
            "set",
            "one of set, lubricant, engine_oil",
            "nothing is changed",
            hint,
        );
    }
}
