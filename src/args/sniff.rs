//! What a name or a file is: vehicle, lubricant, cycle, rig, calibration or study.

use cvtcycle::config::cycle;
use cvtcycle::config::setup::{Kind, is_path};
use cvtcycle::config::{Document, Problem, Problems, bounded, decode};

use crate::args::{bad_value, bytes, did_you_mean, is_csv, lubricants, rigs, vehicles};

/// Sort of an input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sort {
    /// A vehicle file.
    Vehicle,
    /// A lubricant file.
    Lubricant,
    /// A drive cycle.
    Cycle,
    /// What a test rig is set to.
    Rig,
    /// Plan of a calibration.
    Calibration,
    /// Plan of a study.
    Study,
}

/// Tables and keys that only a vehicle has at the top of its file.
const VEHICLE: [&str; 5] = ["vehicle", "road_load", "engine", "transmission", "thermal"];
/// Tables and keys that only a lubricant has at the top of its file.
const LUBRICANT: [&str; 5] = [
    "kv40_mm2_s",
    "kv100_mm2_s",
    "viscosity_table",
    "density15_kg_m3",
    "friction",
];

/// Beginnings of headers that only the plan of a calibration has; their ends may be misspelt.
const CALIBRATION: [&str; 3] = ["[calibra", "[[parameter", "[[data"];
/// Likewise of the plan of a study.
const STUDY: [&str; 2] = ["[study", "[[factor"];

impl Sort {
    /// The word for it.
    pub fn word(self) -> &'static str {
        match self {
            Sort::Vehicle => "vehicle",
            Sort::Lubricant => "lubricant",
            Sort::Cycle => "cycle",
            Sort::Rig => "rig",
            Sort::Calibration => "calibration",
            Sort::Study => "study",
        }
    }
}

/// The sort of an embedded name or of a file, and the word under which the library finds it.
///
/// # Errors
/// Unknown name, unreadable file, or a file that is none of them.
pub fn sort_of(word: &str, must_be_file: bool) -> Result<(Sort, String), Problems> {
    let exists = std::path::Path::new(word).exists();
    if !must_be_file || !exists {
        if let Some(sort) = embedded(word) {
            return Ok((sort, word.to_owned()));
        }
        if !is_path(word) && !exists {
            return Err(unknown(word).into());
        }
    }
    // The library takes a bare word for an embedded name.
    let path = if is_path(word) {
        word.to_owned()
    } else {
        format!("./{word}")
    };
    let extension = std::path::Path::new(word)
        .extension()
        .map(|e| e.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some("csv" | "tsv" | "txt") => {
            bytes("FILE", word, bounded::TABLE).map(|_| (Sort::Cycle, path))
        }
        _ => Ok((
            by_text(word, &decode(word, &bytes("FILE", word, bounded::TOML)?)?)?,
            path,
        )),
    }
}

fn embedded(word: &str) -> Option<Sort> {
    if vehicles().contains(&word) {
        Some(Sort::Vehicle)
    } else if lubricants().contains(&word) {
        Some(Sort::Lubricant)
    } else if rigs().contains(&word) {
        Some(Sort::Rig)
    } else if Kind::Calibration.names().contains(&word) {
        Some(Sort::Calibration)
    } else if Kind::Plan.names().contains(&word) {
        Some(Sort::Study)
    } else if cycle::names().contains(&word) || word.starts_with("constant_") && !is_csv(word) {
        Some(Sort::Cycle)
    } else {
        None
    }
}

/// By the names at the beginnings of lines; the text may be full of mistakes otherwise.
fn by_text(word: &str, text: &str) -> Result<Sort, Problems> {
    // A plan names a vehicle, too; what only it has is looked for everywhere.
    let any = |headers: &[&str]| {
        text.lines().any(|line| {
            headers
                .iter()
                .any(|header| line.trim_start().starts_with(header))
        })
    };
    if any(&CALIBRATION) {
        return Ok(Sort::Calibration);
    }
    if any(&STUDY) {
        return Ok(Sort::Study);
    }
    let mut firsts = text.lines().map(|line| {
        let line = line.trim_start().trim_start_matches('[').trim_start();
        line.split(|c: char| !(c.is_alphanumeric() || c == '_'))
            .next()
            .unwrap_or_default()
    });
    let found = firsts.find_map(|first| {
        if VEHICLE.contains(&first) {
            Some(Sort::Vehicle)
        } else if LUBRICANT.contains(&first) {
            Some(Sort::Lubricant)
        } else {
            first.starts_with("time_").then_some(Sort::Cycle)
        }
    });
    if let Some(sort) = found {
        return Ok(sort);
    }
    // What nobody could read is told before what nobody knows.
    if std::path::Path::new(word)
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("toml"))
    {
        Document::parse(word, text)?;
    }
    let tables = VEHICLE.join("], [");
    let hint = format!(
        "a vehicle has [{tables}], a lubricant {}, a cycle time_s, a calibration [calibration], a study [study]",
        LUBRICANT[0]
    );
    Err(bad_value(
        word,
        "",
        "",
        "neither a vehicle, nor a lubricant, nor a cycle, nor a calibration, nor a study"
            .to_owned(),
        hint,
    )
    .into())
}

fn unknown(word: &str) -> Problem {
    let plans = Kind::Calibration
        .names()
        .into_iter()
        .chain(Kind::Plan.names());
    let inputs = vehicles()
        .into_iter()
        .chain(lubricants())
        .chain(rigs())
        .chain(plans);
    let known: Vec<&str> = inputs.chain(cycle::names().iter().copied()).collect();
    let question = did_you_mean(word, &known)
        .map(|q| q + " ")
        .unwrap_or_default();
    bad_value(
        "NAME",
        word,
        "a vehicle, lubricant or cycle of `cvtcycle list`, or the path of a file",
        format!("there is nothing named `{word}`"),
        format!(
            "{question}`cvtcycle list vehicles`, `list lubricants` and `list cycles` show all; a path needs a / or an ending"
        ),
    )
}
