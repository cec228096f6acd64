//! Detects the kind of a named input or of a file: vehicle, lubricant, cycle, rig, calibration or study.

use std::path::Path;

use cvtcycle::config::setup::is_path;
use cvtcycle::config::{Document, Problem, Problems, bounded, cycle, decode};

use super::problems::{bad_value, did_you_mean, problem};
use super::{bytes, calibrations, cycles, lubricants, plans, rigs, vehicles};

/// Kind of an input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputKind {
    /// A vehicle file.
    Vehicle,
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
}

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
/// Beginnings of table headers that only the plan of a calibration has; their ends may be misspelt.
const CALIBRATION: [&str; 3] = ["[calibra", "[[parameter", "[[data"];
/// Beginnings of table headers that only the plan of a study has.
const STUDY: [&str; 2] = ["[study", "[[factor"];

/// Embedded names of each kind.
fn embedded() -> [(InputKind, Vec<&'static str>); 6] {
    [
        (InputKind::Vehicle, vehicles()),
        (InputKind::Lubricant, lubricants()),
        (InputKind::Rig, rigs()),
        (InputKind::Calibration, calibrations()),
        (InputKind::Study, plans()),
        (InputKind::Cycle, cycles()),
    ]
}

impl InputKind {
    /// Name of the kind.
    pub fn word(self) -> &'static str {
        match self {
            InputKind::Vehicle => "vehicle",
            InputKind::Lubricant => "lubricant",
            InputKind::Cycle => "cycle",
            InputKind::Rig => "rig",
            InputKind::Calibration => "calibration",
            InputKind::Study => "study",
        }
    }

    /// Kind of an embedded name or of a file, and the word by which the library finds it.
    ///
    /// # Errors
    /// Unknown name, unreadable file, or a file of none of the kinds.
    pub fn detect(word: &str, prefer_file: bool) -> Result<(Self, String), Problems> {
        let exists = Path::new(word).exists();
        if !prefer_file || !exists {
            if let Some(kind) = InputKind::of_embedded(word) {
                return Ok((kind, word.to_owned()));
            }
            if !is_path(word) && !exists {
                return Err(unknown(word).into());
            }
        }
        // The library takes a word that is no path for an embedded name.
        let path = match is_path(word) {
            true => word.to_owned(),
            false => format!("./{word}"),
        };
        let kind = match extension(word).as_deref() {
            Some("csv" | "tsv" | "txt") => {
                bytes("FILE", word, bounded::TABLE).map(|_| InputKind::Cycle)
            }
            _ => InputKind::of_text(word, &decode(word, &bytes("FILE", word, bounded::TOML)?)?),
        };
        kind.map(|kind| (kind, path))
    }

    fn of_embedded(word: &str) -> Option<Self> {
        let named = embedded()
            .into_iter()
            .find(|(_, names)| names.contains(&word));
        let constant = word.starts_with("constant_") && !cycle::is_csv(word);
        named
            .map(|(kind, _)| kind)
            .or(constant.then_some(InputKind::Cycle))
    }

    /// Kind by the first words of the lines; the text may have any other error.
    fn of_text(word: &str, text: &str) -> Result<Self, Problems> {
        // A plan names a vehicle as well: its own headers are looked for first, in the whole text.
        let any = |headers: &[&str]| {
            let mut lines = text.lines().map(str::trim_start);
            lines.any(|line| headers.iter().any(|header| line.starts_with(header)))
        };
        if any(&CALIBRATION) {
            return Ok(InputKind::Calibration);
        }
        if any(&STUDY) {
            return Ok(InputKind::Study);
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
            "a vehicle has [{tables}], a lubricant {key}, a cycle time_s, a calibration [calibration], a study [study]"
        );
        let message =
            "neither a vehicle, nor a lubricant, nor a cycle, nor a calibration, nor a study";
        Err(problem(word, message, &hint).into())
    }
}

fn extension(word: &str) -> Option<String> {
    let extension = Path::new(word).extension()?;
    Some(extension.to_string_lossy().to_lowercase())
}

fn unknown(word: &str) -> Problem {
    let known: Vec<&str> = embedded()
        .into_iter()
        .flat_map(|(_, names)| names)
        .collect();
    let question = match did_you_mean(word, &known) {
        question if question.is_empty() => question,
        question => question + " ",
    };
    let hint = format!(
        "{question}`cvtcycle list vehicles`, `list lubricants` and `list cycles` show all; a path contains '/' or has a file extension"
    );
    let allowed = "a vehicle, lubricant or cycle of `cvtcycle list`, or the path of a file";
    bad_value(
        "NAME",
        word,
        allowed,
        &format!("there is nothing named `{word}`"),
        &hint,
    )
}
