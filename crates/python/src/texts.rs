//! Validation, calibration, explanations and schemas, as the JSON of the program.

use cvtcycle::analysis::levers::keys::LEVER_FILE;
use cvtcycle::calibrate::MAX_STARTS;
use cvtcycle::calibrate::plan::keys::CALIBRATION;
use cvtcycle::config::procedure::TEST_FILE;
use cvtcycle::config::setup::Kind;
use cvtcycle::config::{
    Argument, Override, Problem, Problems, bounded, cycle, decode, schema as json_schema,
};
use cvtcycle::explain::Meanings;
use cvtcycle::model::files;
use cvtcycle::output::BUILD;
use cvtcycle::output::escape::json_text as text;
use cvtcycle::study::plan::PLAN;
use cvtcycle::validate::keys::VALIDATION;
use cvtcycle::validate::{CandidateVehicle, ValidationRow, json};
use pyo3::prelude::*;

use crate::errors::{bad, refused};
use crate::job::{Interrupted, Stop, job};

/// Version and build.
#[pyfunction]
pub fn version() -> (&'static str, &'static str) {
    (env!("CARGO_PKG_VERSION"), BUILD)
}

/// Names of embedded inputs of a kind: `vehicle`, `cycle`, `lubricant`, `plan`, `calibration`, `class`, `rig`, `levers`, `test`.
#[pyfunction]
pub fn names(kind: &str) -> PyResult<Vec<&'static str>> {
    let kinds = [
        ("vehicle", Kind::Vehicle),
        ("class", Kind::Class),
        ("lubricant", Kind::Lubricant),
        ("rig", Kind::Rig),
        ("plan", Kind::Plan),
        ("levers", Kind::Levers),
        ("test", Kind::Test),
        ("calibration", Kind::Calibration),
    ];
    match kinds.iter().find(|(name, _)| *name == kind) {
        Some((_, kind)) => Ok(kind.names()),
        None if kind == "cycle" => Ok(cycle::names().to_vec()),
        None => {
            let allowed = kinds.map(|(name, _)| name).join(", ") + ", cycle";
            Err(bad("kind", kind, &allowed, "there is no such kind"))
        }
    }
}

/// Explains a word.
#[pyfunction]
pub fn explain(py: Python<'_>, word: &str) -> PyResult<String> {
    let found = py.detach(|| Meanings::find(word));
    let found = found.map_err(|problem| refused(problem.key("word")))?;
    text(&found.json(word)).map_err(refused)
}

/// The JSON Schema of a kind of file.
#[pyfunction]
pub fn schema(kind: &str) -> PyResult<String> {
    let kinds = [
        ("vehicle", files::VEHICLE),
        ("lubricant", files::LUBRICANT),
        ("rig", files::RIG),
        ("calibration", CALIBRATION),
        ("validation", VALIDATION),
        ("plan", PLAN),
        ("levers", LEVER_FILE),
        ("test", TEST_FILE),
    ];
    match kinds.iter().find(|(name, _)| *name == kind) {
        Some((name, keys)) => text(&json_schema::json_schema(name, keys)).map_err(refused),
        None => {
            let allowed = kinds.map(|(name, _)| name).join(", ");
            Err(bad("kind", kind, &allowed, "there is no such kind"))
        }
    }
}

/// Compares with published values, and with the user's own files of rows.
#[pyfunction]
pub fn validate(
    py: Python<'_>,
    vehicle: String,
    lubricant: Option<String>,
    set: Vec<String>,
    rows: Vec<String>,
    embedded: bool,
    chapter: Option<String>,
) -> PyResult<String> {
    let set = Override::parse_all(&set).map_err(refused)?;
    let compare = move |_: &Stop| -> Result<String, Problems> {
        let own = |path: &String| -> Result<(String, String), Problems> {
            let bytes = cycle::bytes(Argument::File, path, bounded::TOML)?;
            Ok((path.clone(), decode(path, &bytes)?))
        };
        let own: Vec<_> = rows.iter().map(own).collect::<Result<_, _>>()?;
        let files = cvtcycle::validate::files(&own, embedded)?;
        let is_wanted = |row: &ValidationRow| {
            let is_it = |chapter: &String| chapter.eq_ignore_ascii_case(&row.chapter);
            chapter.as_ref().is_none_or(is_it)
        };
        if !files.iter().flat_map(|file| &file.rows).any(is_wanted) {
            let chapter = chapter.as_deref().unwrap_or_default();
            let problem = Problem::unknown_name(format!("no row belongs to chapter `{chapter}`"));
            return Err(problem.key("chapter").value(chapter).into());
        }
        let candidate = CandidateVehicle {
            vehicle,
            lubricant,
            set,
            ..CandidateVehicle::default()
        };
        text(&json(&cvtcycle::validate::judge(
            &files, &candidate, is_wanted,
        )?))
    };
    job(py, None, Interrupted::Detaches, compare)?.map_err(refused)
}

/// Fits parameters to measurements.
#[pyfunction]
pub fn calibrate(
    py: Python<'_>,
    plan: String,
    starts: Option<u64>,
    seed: Option<u64>,
    folds: bool,
    threads: Option<usize>,
) -> PyResult<String> {
    if let Some(n) = starts.filter(|n| !(1..=MAX_STARTS).contains(n)) {
        let (value, allowed) = (n.to_string(), format!("1 to {MAX_STARTS}"));
        return Err(bad(
            "starts",
            &value,
            &allowed,
            &format!("{n} starts are out of range"),
        ));
    }
    let search = move |stop: &Stop| -> Result<String, Problems> {
        let mut plan = cvtcycle::calibrate::open(&plan)?;
        plan.search.starts = starts.map_or(plan.search.starts, |n| n as usize);
        plan.search.seed = seed.unwrap_or(plan.search.seed);
        plan.leave_out &= folds;
        text(&cvtcycle::calibrate::calibrate(&plan, stop)?)
    };
    job(py, threads, Interrupted::Stops, search)?.map_err(refused)
}
