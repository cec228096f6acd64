//! Detects the kind of a named input or of a file: vehicle, lubricant, cycle, rig, calibration, study or levers.

use std::path::Path;

use cvtcycle::config::setup::{Kind, is_path, is_twin};
use cvtcycle::config::{Document, Problem, Problems, bounded, cycle, decode};

use super::problems::{bad_value, did_you_mean, problem};
use super::{bytes, cycles};

/// Kind of an input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputKind {
    /// A vehicle file.
    Vehicle,
    /// Values of a class of cars.
    Class,
    /// A lubricant file.
    Lubricant,
    /// A drive cycle.
    Cycle,
    /// Conditions of a test rig.
    Rig,
    /// Plan of a calibration.
    Calibration,
    /// Plan of a study.
    Study,
    /// Changes of a car's design.
    Levers,
    /// Test of a regulation.
    Test,
}

/// A kind, its name, and the names of its embedded inputs.
type KindRow = (InputKind, &'static str, fn() -> Vec<&'static str>);

/// All kinds.
const KINDS: [KindRow; 9] = [
    (InputKind::Vehicle, "vehicle", || Kind::Vehicle.names()),
    (InputKind::Class, "class", || Kind::Class.names()),
    (InputKind::Lubricant, "lubricant", || {
        Kind::Lubricant.names()
    }),
    (InputKind::Rig, "rig", || Kind::Rig.names()),
    (InputKind::Calibration, "calibration", || {
        Kind::Calibration.names()
    }),
    (InputKind::Study, "study", || Kind::Plan.names()),
    (InputKind::Levers, "levers", || Kind::Levers.names()),
    (InputKind::Cycle, "cycle", cycles),
    // Some tests have the name of their cycle.
    (InputKind::Test, "test", || Kind::Test.names()),
];

/// Tables and keys that only a vehicle file has at its top.
const VEHICLE: [&str; 5] = ["vehicle", "road_load", "engine", "transmission", "thermal"];
/// Tables and keys that only a lubricant file has at its top.
const LUBRICANT: [&str; 5] = [
    "kv40_mm2_s",
    "kv100_mm2_s",
    "viscosity_table",
    "density15_kg_m3",
    "friction",
];
/// Beginnings of table headers that only a plan or a lever file has; the rest of a header may be misspelt.
const PLANS: [(InputKind, &[&str]); 4] = [
    (
        InputKind::Calibration,
        &["[calibra", "[[parameter", "[[data"],
    ),
    (InputKind::Study, &["[study", "[[factor"]),
    (InputKind::Levers, &["[lever", "[[lever"]),
    (InputKind::Test, &["[test", "[[result"]),
];

impl InputKind {
    /// Name of the kind.
    pub fn word(self) -> &'static str {
        let own = KINDS.iter().find(|(kind, ..)| *kind == self);
        own.map_or("", |(_, word, _)| word)
    }

    /// Finds the kind of an embedded name or of a file, and the word by which the library finds it.
    /// # Errors
    /// Unknown name, unreadable file, or a file of unknown kind.
    pub fn detect(word: &str, prefer_file: bool) -> Result<(Self, String), Problems> {
        let exists = Path::new(word).exists();
        if is_twin(word) {
            return Ok((InputKind::Vehicle, word.to_owned()));
        }
        // `like` accepts the same prefix.
        let word = word.strip_prefix("class:").unwrap_or(word);
        if !prefer_file || !exists {
            if let Some(kind) = InputKind::from_name(word) {
                return Ok((kind, word.to_owned()));
            }
            if !is_path(word) && !exists {
                return Err(unknown(word).into());
            }
        }
        // The library reads a word that is not a path as an embedded name.
        let path = match is_path(word) {
            true => word.to_owned(),
            false => format!("./{word}"),
        };
        let kind = match extension(word).as_deref() {
            Some("csv" | "tsv" | "txt" | "vdri") => {
                bytes("FILE", word, bounded::LOG).map(|_| InputKind::Cycle)
            }
            _ => InputKind::from_text(word, &decode(word, &bytes("FILE", word, bounded::TOML)?)?),
        };
        kind.map(|kind| (kind, path))
    }

    fn from_name(word: &str) -> Option<Self> {
        let named = KINDS.iter().find(|(_, _, names)| names().contains(&word));
        let is_cycle = cycle::name_of(word).is_some()
            || (word.starts_with("constant_") && !cycle::is_csv(word));
        let cycle = is_cycle.then_some(InputKind::Cycle);
        named.map(|(kind, ..)| *kind).or(cycle)
    }

    /// Finds the kind by the first words of the lines, so that it works with any other error in the text.
    fn from_text(word: &str, text: &str) -> Result<Self, Problems> {
        // A plan names a vehicle too, so its headers are searched in the whole text before those of a vehicle.
        let is_one = |headers: &[&str]| {
            let mut lines = text.lines().map(str::trim_start);
            lines.any(|line| headers.iter().any(|header| line.starts_with(header)))
        };
        if let Some((kind, _)) = PLANS.iter().find(|(_, headers)| is_one(headers)) {
            return Ok(*kind);
        }
        let mut words = text.lines().filter_map(|line| {
            let line = line.trim_start().trim_start_matches('[').trim_start();
            line.split(|c: char| !(c.is_alphanumeric() || c == '_'))
                .next()
        });
        let kind = words.find_map(|first| match first {
            _ if VEHICLE.contains(&first) => Some(InputKind::Vehicle),
            _ if LUBRICANT.contains(&first) => Some(InputKind::Lubricant),
            _ => first.starts_with("time_").then_some(InputKind::Cycle),
        });
        if let Some(kind) = kind {
            return Ok(kind);
        }
        // Syntax errors are reported before an unknown kind.
        if extension(word).as_deref() == Some("toml") {
            Document::parse(word, text)?;
        }
        let (tables, key) = (VEHICLE.join("], ["), LUBRICANT[0]);
        let hint = format!(
            "a vehicle has [{tables}], a lubricant {key}, a cycle time_s, a calibration [calibration], a study [study], levers [[lever]]"
        );
        let message = "neither a vehicle, nor a lubricant, nor a cycle, nor a calibration, nor a study, nor levers";
        Err(problem(word, message, &hint).into())
    }
}

fn extension(word: &str) -> Option<String> {
    let extension = Path::new(word).extension()?;
    Some(extension.to_string_lossy().to_lowercase())
}

fn unknown(word: &str) -> Problem {
    let known: Vec<&str> = KINDS.iter().flat_map(|(_, _, names)| names()).collect();
    let question = match did_you_mean(word, &known) {
        question if question.is_empty() => question,
        question => question + " ",
    };
    let hint = format!(
        "{question}`cvtcycle list vehicles`, `list lubricants` and `list cycles` show all; a path contains '/' or has a file extension"
    );
    let allowed = "a vehicle, lubricant or cycle of `cvtcycle list`, or the path of a file";
    let message = format!("there is nothing named `{word}`");
    bad_value("NAME", word, allowed, &message, &hint)
}
