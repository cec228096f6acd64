//! Reads a directory of results.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::problems::{belongs, consistent, problem, unreadable};
use cvtcycle_analysis::answer::Answer;
use cvtcycle_config::bounded;
use cvtcycle_config::{Input, Place, Problem, ProblemKind, Problems, Setting};
use cvtcycle_output::files::{self, hex, sum_of};
use cvtcycle_output::history::History;
use cvtcycle_output::provenance::hash;
use cvtcycle_output::record::{self, Record};
use cvtcycle_output::summary::{SCHEMA, Summary};
use cvtcycle_study::answer::ambient::{WarmUp, warm_ups};
use cvtcycle_study::execute::manifest::TRACES;
use cvtcycle_study::statistics::Confidence;
use cvtcycle_study::store::{self, is_study, read_trace_parquet};
use cvtcycle_study::{Answer as StudyAnswer, StudyManifest, StudyTable, answer};

/// Summary of a run or a validation.
const SUMMARY: &str = "summary.json";
/// Manifest of a study.
const STUDY: &str = "study.json";

/// Results in a directory.
#[derive(Debug)]
pub enum ResultDir {
    /// A run.
    Run(Box<RunResults>),
    /// A study.
    Study(Box<StudyResults>),
}

/// A run, with the studies and the validation in its directory.
#[derive(Debug)]
pub struct RunResults {
    /// Directory.
    pub path: PathBuf,
    /// Summary.
    pub summary: Summary,
    /// Inputs; `None` for a directory of an early version.
    pub record: Option<Record>,
    /// Trace of each car.
    pub histories: Vec<Option<History>>,
    /// Studies of the run.
    pub studies: Vec<StudyResults>,
    /// Validation of the model.
    pub validation: Option<Value>,
    /// Ranges, options and next test from one sample, where they were computed for the report.
    pub answer: Option<Answer>,
    /// Why there is no answer, where it was to be computed.
    pub no_answer: Option<String>,
    /// Sentences on missing parts.
    pub missing: Vec<String>,
}

/// A study, finished or not.
#[derive(Debug)]
pub struct StudyResults {
    /// Directory.
    pub path: PathBuf,
    /// Plan, design and cars.
    pub outline: StudyManifest,
    /// Manifest.
    pub manifest: Value,
    /// Parts.
    pub store: store::Study,
    /// Statistics.
    pub answer: StudyAnswer,
    /// Warm-up of each run, for a matrix with traces.
    pub warm_ups: Vec<WarmUp>,
}

impl StudyResults {
    /// Opens a study, and computes its statistics.
    ///
    /// # Errors
    /// The directory holds no study, or a manifest or a part cannot be read.
    pub fn open(path: &Path, confidence: Confidence) -> Result<Self, Problem> {
        let (outline, store) = Self::stored(path)?;
        Self::from_store(outline, store, confidence)
    }

    /// As [`StudyResults::open`], with the cars named as in tables and figures of a report.
    ///
    /// # Errors
    /// As of [`StudyResults::open`].
    pub fn open_for_report(path: &Path, confidence: Confidence) -> Result<Self, Problem> {
        let (mut outline, store) = Self::stored(path)?;
        let names = outline.cars.clone();
        for car in &mut outline.cars {
            *car = label(store.manifest(), car);
        }
        Self::traced(outline, store, confidence, &names)
    }

    /// Name of a car in tables and figures.
    pub fn label(&self, vehicle: &str) -> String {
        label(&self.manifest, vehicle)
    }

    /// Opens a study without its statistics.
    ///
    /// # Errors
    /// The directory holds no study, or the manifest cannot be read.
    pub fn stored(path: &Path) -> Result<(StudyManifest, store::Study), Problem> {
        let store = store::Study::open(path)?;
        let text = String::from_utf8_lossy(&store.plan()?).into_owned();
        let file = path.join("plan.toml").display().to_string();
        let outline = StudyManifest::read(store.manifest(), &file, &text).map_err(|words| {
            let hint = "read it with the program that wrote it, or run it again";
            problem(
                &path.join(STUDY),
                &format!("cannot read the study: {words}"),
                hint,
            )
        })?;
        Ok((outline, store))
    }

    /// Computes the statistics of the existing parts.
    ///
    /// # Errors
    /// A part cannot be read.
    pub fn from_store(
        outline: StudyManifest,
        store: store::Study,
        confidence: Confidence,
    ) -> Result<Self, Problem> {
        let names = outline.cars.clone();
        Self::traced(outline, store, confidence, &names)
    }

    /// As above, for cars whose names in the traces, `names`, differ from those in the outline.
    fn traced(
        outline: StudyManifest,
        store: store::Study,
        confidence: Confidence,
        names: &[String],
    ) -> Result<Self, Problem> {
        let frame = StudyTable::new(&outline, &store)?;
        let answer = answer(&frame, confidence)?;
        let traced = store.layout().tables.iter().any(|table| table == TRACES);
        let warm_ups = match &answer.matrix {
            Some(matrix) if traced => warm_ups(&frame, matrix, names).unwrap_or_default(),
            _ => Vec::new(),
        };
        store.unchanged()?;
        let (path, manifest) = (store.path().to_path_buf(), store.manifest().clone());
        Ok(StudyResults {
            path,
            outline,
            manifest,
            store,
            answer,
            warm_ups,
        })
    }

    /// Table of the runs.
    ///
    /// # Errors
    /// A part cannot be read.
    pub fn frame(&self) -> Result<StudyTable<'_>, Problem> {
        StudyTable::new(&self.outline, &self.store)
    }

    /// Sentence on the missing parts, if the study is not finished.
    pub fn unfinished(&self) -> Option<String> {
        let (there, all) = self.parts();
        let path = self.path.display();
        let text = format!("the study in {path} is not finished: {there} of {all} parts");
        (there < all).then_some(text)
    }

    /// Number of existing and of planned parts.
    pub fn parts(&self) -> (usize, usize) {
        let status = self.store.status();
        (status.present, status.expected)
    }
}

/// Name of a car of a study's manifest in tables and figures: the short name, unless two cars share it. Column names of levers begin with the
/// name of their car.
fn label(manifest: &Value, vehicle: &str) -> String {
    let cars = manifest["cars"].as_array().into_iter().flatten();
    let named = |car: &Value| {
        let name = car["name"].as_str()?.split('/').next()?.to_owned();
        Some((name, car["short"].as_str()?.to_owned()))
    };
    let cars: BTreeSet<(String, String)> = cars.filter_map(named).collect();
    let alone = |short: &&String| cars.iter().filter(|other| other.1 == **short).count() == 1;
    let own = cars.iter().find(|(name, _)| name == vehicle);
    let short = own.map(|(_, short)| short).filter(alone);
    let short = short.filter(|short| !short.is_empty());
    short.map_or(vehicle, String::as_str).to_owned()
}

/// Reads a directory: a study, or a run with studies (`DIR/*/study.json`) and a validation (`DIR/*/summary.json` of `validate`) in
/// subdirectories. `extra` names more such directories.
///
/// # Errors
/// All problems: a missing directory, one without results of this program, a newer schema, damaged files.
pub fn find(path: &Path, extra: &[PathBuf]) -> Result<ResultDir, Problems> {
    let entries = fs::read_dir(path).map_err(|error| unreadable(path, &error.into()))?;
    settle(path)?;
    if is_study(path) {
        return Ok(ResultDir::Study(Box::new(StudyResults::open_for_report(
            path,
            Confidence::default(),
        )?)));
    }
    let file = path.join(SUMMARY);
    if !file.exists() {
        let hint = "name a directory that `cvtcycle run` or `cvtcycle study` has written";
        let shown = path.display();
        let message =
            format!("{shown} holds no run and no study: it has neither {SUMMARY} nor {STUDY}");
        return Err(problem(path, &message, hint).into());
    }
    let (value, sum) = json(&file)?;
    if is_validation(&value) {
        let hint = "its report is validation.html in that directory; it can be added to the report of a run";
        let message = "this is the answer of `cvtcycle validate`, not of a run";
        let problem = problem(path, message, hint);
        return Err(problem.settings(&[Setting::Added]).into());
    }
    if is_optimum(&value) {
        let hint = "its bound.csv, least_speed.csv and path.csv are its tables; drive the vehicle file with its line for a report";
        let message = "this is the answer of `cvtcycle optimum`, which has no report";
        return Err(problem(path, message, hint).into());
    }
    let mut found = run(path, &file, value, &sum)?;
    let subdirectories = entries.flatten().map(|entry| entry.path());
    let mut subdirectories: Vec<PathBuf> = subdirectories.filter(|path| path.is_dir()).collect();
    subdirectories.sort();
    let mut problems = Problems::new();
    let mut seen = BTreeSet::new();
    let required = extra.iter().map(|dir| (dir, true));
    for (dir, required) in required.chain(subdirectories.iter().map(|dir| (dir, false))) {
        // A study may be named twice, and also lie in the directory of the run.
        if seen.insert(dir.canonicalize().unwrap_or_else(|_| dir.clone())) {
            problems.extend(add(&mut found, dir, required).err());
        }
    }
    if problems.is_empty() {
        Ok(ResultDir::Run(Box::new(found)))
    } else {
        Err(problems)
    }
}

/// Adds the study or the validation of a directory; unless required, the directory may hold something else.
fn add(found: &mut RunResults, dir: &Path, required: bool) -> Result<(), Problem> {
    if is_study(dir) {
        found
            .studies
            .push(StudyResults::open_for_report(dir, Confidence::default())?);
        return Ok(());
    }
    settle(dir)?;
    let file = dir.join(SUMMARY);
    let found_file = file.exists().then(|| json(&file).ok()).flatten();
    let found_value = found_file.map(|(value, _)| value);
    let is_answer_of_optimum = found_value.as_ref().is_some_and(is_optimum);
    match found_value.filter(is_validation) {
        Some(value) => found.validation = Some(value),
        None if required => {
            let hint = "name a directory that `cvtcycle study` or `cvtcycle validate` has written";
            let what = match is_answer_of_optimum {
                true => "holds the answer of `cvtcycle optimum`, which has no report",
                false => "holds neither a study nor a validation",
            };
            let message = format!("{} {what}", dir.display());
            return Err(problem(dir, &message, hint));
        }
        None => {}
    }
    Ok(())
}

/// Completes an interrupted commit.
fn settle(dir: &Path) -> Result<(), Problem> {
    let settled = files::settle(dir);
    settled.map_err(|problem| problem.in_file(dir.display().to_string()))
}

/// True for the summary of `optimum`.
fn is_optimum(value: &Value) -> bool {
    value["bounds"].is_array() && value["least_speeds"].is_array()
}

fn is_validation(value: &Value) -> bool {
    value["counts"].is_object() && value["rows"].is_array()
}

fn run(path: &Path, file: &Path, value: Value, sum: &str) -> Result<RunResults, Problems> {
    let summary: Summary = typed(file, value, SCHEMA)?;
    let mut missing = Vec::new();
    let record_file = path.join(record::FILE);
    let mut record = None;
    if record_file.exists() {
        let (value, _) = json(&record_file)?;
        let found = typed::<Record>(&record_file, value, record::SCHEMA)?;
        if found.manifest.run != summary.manifest.run {
            return Err(mixed(path, record::FILE, "of another run than").into());
        }
        if summary.manifest.run.is_empty() {
            missing.push(
                "the files have no word for their run: they are from an earlier version, and may be of several runs".to_owned(),
            );
        }
        record = Some(found);
    } else {
        missing.push(format!(
            "{} is not there: hashes, changed values, the fuel map and what matters are left out",
            record::FILE
        ));
    }
    if summary.runs.is_empty() {
        return Err(problem(file, "the summary names no car", "run it again").into());
    }
    let runs = summary.runs.iter();
    let mut problems: Problems = runs.filter_map(|run| consistent(file, run).err()).collect();
    let mut histories = Vec::new();
    for run in &summary.runs {
        let (car, history) = (&run.vehicle, history(path, &run.vehicle, record.as_ref()));
        match history {
            Ok(Some(trace)) => {
                let whole = belongs(path, run, &trace.history)
                    .and_then(|()| same(path, &trace.name, &trace.sum, record.as_ref()));
                problems.extend(whole.err());
                histories.push(Some(trace.history));
            }
            Ok(None) => {
                missing.push(format!(
                    "the trace of {car} is not there (trace_{car}.csv): its figures over time are left out"
                ));
                histories.push(None);
            }
            Err(found) => problems.extend(found),
        }
    }
    if !problems.is_empty() {
        return Err(problems);
    }
    same(path, SUMMARY, sum, record.as_ref())?;
    Ok(RunResults {
        path: path.to_path_buf(),
        summary,
        record,
        histories,
        studies: Vec::new(),
        validation: None,
        answer: None,
        no_answer: None,
        missing,
    })
}

/// Checks that a file is the one that the record lists.
fn same(path: &Path, name: &str, sum: &str, record: Option<&Record>) -> Result<(), Problem> {
    let listed = record.and_then(|record| record.files.get(name));
    match listed.is_none_or(|listed| listed == sum) {
        true => Ok(()),
        false => Err(mixed(path, name, "not the file that was written with")),
    }
}

fn mixed(path: &Path, name: &str, what: &str) -> Problem {
    let other = if name == SUMMARY {
        record::FILE
    } else {
        SUMMARY
    };
    let message = format!("{name} in {} is {what} {other}", path.display());
    let hint = "it has been changed or belongs to another run; run it again";
    problem(&path.join(name), &message, hint)
}

/// A trace, and its file.
struct TraceFile {
    history: History,
    name: String,
    sum: String,
}

/// Reads the trace of a car from one of the files of the run.
fn history(
    path: &Path,
    vehicle: &str,
    record: Option<&Record>,
) -> Result<Option<TraceFile>, Problems> {
    // The name is part of a file name and must not contain path separators.
    if vehicle.is_empty() || vehicle.contains(['/', '\\', ':']) {
        let message =
            format!("`{vehicle}` cannot be the name of a vehicle: no file can be named after it");
        return Err(problem(&path.join(SUMMARY), &message, "run it again").into());
    }
    let is_there = |name: &String| {
        record.is_none_or(|record| record.has_file(name)) && path.join(name).exists()
    };
    let name = format!("trace_{vehicle}.csv");
    if is_there(&name) {
        let csv = path.join(&name);
        let bytes =
            bounded::read_file(&csv, bounded::TRACE).map_err(|error| unreadable(&csv, &error))?;
        let history = History::read_csv(&csv.display().to_string(), &bytes)?;
        let sum = hash(&bytes);
        return Ok(Some(TraceFile { history, name, sum }));
    }
    let name = format!("trace_{vehicle}.parquet");
    if !is_there(&name) {
        return Ok(None);
    }
    let parquet = path.join(&name);
    let history = read_trace_parquet(&parquet)?;
    let sum = fs::File::open(&parquet).and_then(|file| sum_of(&file));
    let sum = sum.map_err(|error| unreadable(&parquet, &error.into()))?;
    let sum = hex(&sum);
    Ok(Some(TraceFile { history, name, sum }))
}

/// Reads the value of a JSON file, and its checksum.
fn json(path: &Path) -> Result<(Value, String), Problem> {
    let bytes =
        bounded::read_file(path, bounded::RECORD).map_err(|error| unreadable(path, &error))?;
    Ok((value(path, &bytes)?, hash(&bytes)))
}

fn value(path: &Path, bytes: &[u8]) -> Result<Value, Problem> {
    bounded::json(bytes).map_err(|problem| {
        let place = Place {
            input: Input::File(path.display().to_string()),
            ..problem.place.clone()
        };
        problem.at(place)
    })
}

/// Parses the text of a `summary.json`; `name` is used in problems.
///
/// # Errors
/// The text is not JSON of this program, or too large.
pub fn parse_summary(name: &str, bytes: &[u8]) -> Result<Summary, Problem> {
    typed(Path::new(name), value(Path::new(name), bytes)?, SCHEMA)
}

/// Parses the text of an `inputs.json`, as [`parse_summary`] does.
///
/// # Errors
/// As [`parse_summary`].
pub fn parse_record(name: &str, bytes: &[u8]) -> Result<Record, Problem> {
    let value = value(Path::new(name), bytes)?;
    typed(Path::new(name), value, record::SCHEMA)
}

/// Parses JSON of a known schema.
fn typed<T: serde::de::DeserializeOwned>(
    path: &Path,
    value: Value,
    known: u32,
) -> Result<T, Problem> {
    match value["schema"].as_u64() {
        Some(schema) if schema > u64::from(known) => {
            let program = value["program"].as_str().unwrap_or("a newer version");
            let message = format!(
                "it has schema {schema}, written by {program}; this program reads schema {known}"
            );
            let hint = "make the report with the program that wrote it";
            Err(problem(path, &message, hint))
        }
        Some(_) => serde_json::from_value(value).map_err(|error| {
            let message = format!("the file is not as this program writes it: {error}");
            problem(path, &message, "it is damaged; run it again").kind(ProblemKind::Damaged)
        }),
        None => Err(problem(
            path,
            "the file has no `schema`: it was not written by this program",
            "name a directory of `cvtcycle run`",
        )),
    }
}
