//! A directory to what is in it.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use cvtcycle_config::bounded::{self, ReadError};
use cvtcycle_config::{Place, Problem, Problems};
use cvtcycle_output::history::History;
use cvtcycle_output::record::{self, Record};
use cvtcycle_output::summary::{RunSummary, SCHEMA, Summary};
use cvtcycle_study::ambient::{WarmUp, warm_ups};
use cvtcycle_study::manifest::TRACES;
use cvtcycle_study::store::{self, is_study, read_trace_parquet};
use cvtcycle_study::{Answer, StudyManifest, StudyTable, answer};

/// The file of numbers of a run or a validation.
const SUMMARY: &str = "summary.json";
/// The manifest of a study.
const STUDY: &str = "study.json";

/// What a directory holds.
#[derive(Debug)]
pub enum Found {
    /// A run.
    Run(Box<RunFound>),
    /// A study.
    Study(Box<StudyFound>),
}

/// A run with what stands beside it.
#[derive(Debug)]
pub struct RunFound {
    /// The directory.
    pub path: PathBuf,
    /// Its numbers.
    pub summary: Summary,
    /// What it was made from; none of a directory of an early version.
    pub record: Option<Record>,
    /// The trace of each car.
    pub histories: Vec<Option<History>>,
    /// Studies beside it.
    pub studies: Vec<StudyFound>,
    /// A validation beside it.
    pub validation: Option<Value>,
    /// What is not there, in words.
    pub missing: Vec<String>,
}

/// A study, finished or not.
#[derive(Debug)]
pub struct StudyFound {
    /// The directory.
    pub path: PathBuf,
    /// What it is.
    pub outline: StudyManifest,
    /// Its manifest.
    pub manifest: Value,
    /// Its parts.
    pub store: store::Study,
    /// What it says.
    pub answer: Answer,
    /// Warm-up of each run, where it is a matrix with traces.
    pub warm_ups: Vec<WarmUp>,
}

impl StudyFound {
    /// Opens and answers.
    ///
    /// # Errors
    /// A directory that is no study, a manifest or a part that cannot be read.
    pub fn open(path: &Path) -> Result<Self, Problem> {
        let store = store::Study::open(path)?;
        let text = String::from_utf8_lossy(&store.plan()?).into_owned();
        let file = path.join("plan.toml").display().to_string();
        let outline = StudyManifest::read(store.manifest(), &file, &text).map_err(|words| {
            problem(
                &path.join(STUDY),
                &format!("cannot read the study: {words}"),
                "read it with the program that wrote it, or run it again",
            )
        })?;
        Self::of(outline, store)
    }

    /// Answers from the parts that are there.
    ///
    /// # Errors
    /// A part that cannot be read.
    pub fn of(outline: StudyManifest, store: store::Study) -> Result<Self, Problem> {
        let frame = StudyTable::new(&outline, &store)?;
        let answer = answer(&frame)?;
        let traced = store.layout().tables.iter().any(|table| table == TRACES);
        let warm_ups = match &answer.matrix {
            Some(matrix) if traced => warm_ups(&frame, matrix).unwrap_or_default(),
            _ => Vec::new(),
        };
        let (path, manifest) = (store.path().to_path_buf(), store.manifest().clone());
        Ok(StudyFound {
            path,
            outline,
            manifest,
            store,
            answer,
            warm_ups,
        })
    }

    /// Its table.
    ///
    /// # Errors
    /// A part that cannot be read.
    pub fn frame(&self) -> Result<StudyTable<'_>, Problem> {
        StudyTable::new(&self.outline, &self.store)
    }

    /// Parts that are there, and that there will be.
    #[must_use]
    pub fn parts(&self) -> (usize, usize) {
        let status = self.store.status();
        (status.present, status.expected)
    }
}

/// Looks into a directory: a study, or a run with studies (`DIR/*/study.json`) and a validation (`DIR/*/summary.json` of `validate`)
/// beside its files. `extra` names more such directories.
///
/// # Errors
/// All problems: no such directory, nothing of this program in it, a newer schema, damaged files.
pub fn find(path: &Path, extra: &[PathBuf]) -> Result<Found, Problems> {
    let entries = fs::read_dir(path).map_err(|error| unreadable(path, &error.into()))?;
    if is_study(path) {
        return StudyFound::open(path)
            .map(|study| Found::Study(Box::new(study)))
            .map_err(Problems::from);
    }
    let file = path.join(SUMMARY);
    if !file.exists() {
        let hint =
            "name the directory that was given to --out of `cvtcycle run` or `cvtcycle study`";
        return Err(problem(
            path,
            &format!(
                "{} holds no run and no study: it has neither {SUMMARY} nor {STUDY}",
                path.display()
            ),
            hint,
        )
        .into());
    }
    let value = json(&file).map_err(|problem| vec![problem])?;
    if is_validation(&value) {
        let hint = "its report is validation.html in that directory; beside a run it belongs into the run's report: `cvtcycle report RUN --with DIR`";
        return Err(problem(
            path,
            "this is the answer of `cvtcycle validate`, not of a run",
            hint,
        )
        .into());
    }
    let mut found = run(path, &file, value)?;
    let mut beside: Vec<PathBuf> = entries
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path.is_dir())
        .collect();
    beside.sort();
    let mut problems = Problems::new();
    let mut seen = std::collections::BTreeSet::new();
    for (dir, asked) in extra
        .iter()
        .map(|dir| (dir, true))
        .chain(beside.iter().map(|dir| (dir, false)))
    {
        // One study may be named twice, and stand beside the run as well.
        if seen.insert(dir.canonicalize().unwrap_or_else(|_| dir.clone())) {
            problems.extend(add(&mut found, dir, asked).err());
        }
    }
    if problems.is_empty() {
        Ok(Found::Run(Box::new(found)))
    } else {
        Err(problems)
    }
}

/// Adds what a directory holds beside a run; one that was not asked for may hold something else.
fn add(found: &mut RunFound, dir: &Path, asked: bool) -> Result<(), Problem> {
    if is_study(dir) {
        found.studies.push(StudyFound::open(dir)?);
        return Ok(());
    }
    let file = dir.join(SUMMARY);
    let value = if file.exists() {
        json(&file).ok()
    } else {
        None
    };
    match value.filter(is_validation) {
        Some(value) => found.validation = Some(value),
        None if asked => {
            let hint = "name the directory that was given to --out of `cvtcycle study` or `cvtcycle validate`";
            return Err(problem(
                dir,
                &format!("{} holds neither a study nor a validation", dir.display()),
                hint,
            ));
        }
        None => {}
    }
    Ok(())
}

fn is_validation(value: &Value) -> bool {
    value["counts"].is_object() && value["rows"].is_array()
}

fn run(path: &Path, file: &Path, value: Value) -> Result<RunFound, Problems> {
    let summary: Summary = typed(file, value, SCHEMA).map_err(|problem| vec![problem])?;
    let mut missing = Vec::new();
    let record_file = path.join(record::FILE);
    let record = if record_file.exists() {
        let value = json(&record_file).map_err(|problem| vec![problem])?;
        Some(
            typed::<Record>(&record_file, value, record::SCHEMA)
                .map_err(|problem| vec![problem])?,
        )
    } else {
        missing.push(format!(
            "{} is not there: hashes, changed values, the fuel map and what matters are left out",
            record::FILE
        ));
        None
    };
    if summary.runs.is_empty() {
        return Err(problem(file, "the summary names no car", "run it again").into());
    }
    let mut problems: Problems = summary
        .runs
        .iter()
        .filter_map(|run| consistent(file, run).err())
        .collect();
    let mut histories = Vec::new();
    for run in &summary.runs {
        match history(path, &run.vehicle) {
            Ok(Some(history)) => {
                problems.extend(belongs(path, run, &history).err());
                histories.push(Some(history));
            }
            Ok(None) => {
                missing.push(format!(
                    "the trace of {} is not there (trace_{}.csv): its figures over time are left out",
                    run.vehicle, run.vehicle
                ));
                histories.push(None);
            }
            Err(found) => problems.extend(found),
        }
    }
    if !problems.is_empty() {
        return Err(problems);
    }
    Ok(RunFound {
        path: path.to_path_buf(),
        summary,
        record,
        histories,
        studies: Vec::new(),
        validation: None,
        missing,
    })
}

/// Relative difference that rounding in sums over a whole trace may leave.
const ROUNDING: f64 = 1e-6;

fn near(a: f64, b: f64, scale: f64) -> bool {
    (a - b).abs() <= ROUNDING * scale.abs() + 1e-9
}

/// Whether the numbers of a car agree with each other: fuel with distance, and the terms of the ledger with the fuel.
fn consistent(file: &Path, run: &RunSummary) -> Result<(), Problem> {
    let ledger = |name: &str| run.ledger_kj.get(name).unwrap_or(0.0);
    let terms: f64 = [
        "wheels",
        "brake",
        "losses",
        "accessories",
        "kinetic",
        "engine_heat",
        "exhaust",
    ]
    .into_iter()
    .map(ledger)
    .sum();
    let fuel = run
        .fuel_l_per_100km
        .is_none_or(|fuel| near(fuel * run.distance_km / 100.0, run.fuel_l, run.fuel_l));
    // A run whose ledger did not close has said so itself.
    let open = run
        .failed_checks
        .iter()
        .any(|check| check == "ledger_error");
    if fuel
        && (open
            || (near(terms, run.fuel_energy_kj, run.fuel_energy_kj)
                && near(ledger("fuel"), run.fuel_energy_kj, run.fuel_energy_kj)))
    {
        return Ok(());
    }
    let message = format!(
        "the numbers of {} do not agree with each other: fuel, distance and the terms of its energy ledger",
        run.vehicle
    );
    Err(problem(
        file,
        &message,
        "the file has been changed; run it again",
    ))
}

/// Whether a trace is that of the summary: as long, with the same fuel and the same losses.
fn belongs(path: &Path, run: &RunSummary, history: &History) -> Result<(), Problem> {
    let sum = |name: &str| {
        history
            .column(name)
            .iter()
            .zip(history.dt_s())
            .map(|(x, dt)| x * dt)
            .filter(|x| x.is_finite())
            .sum::<f64>()
    };
    let losses: f64 = history
        .components()
        .iter()
        .map(|c| sum(&format!("{}_loss_w", c.name())))
        .sum::<f64>()
        / 1e3;
    let told = [
        (
            "time",
            "s",
            history.dt_s().iter().sum::<f64>(),
            run.duration_s,
        ),
        ("fuel", "g", sum("fuel_g_s"), run.fuel_kg * 1e3),
        (
            "losses of the transmission",
            "kJ",
            losses,
            run.transmission_loss_kj(),
        ),
    ];
    let Some((what, unit, here, there)) = told
        .into_iter()
        .find(|(_, _, here, there)| !near(*here, *there, *there))
    else {
        return Ok(());
    };
    let message = format!(
        "the trace of {} is not that of the summary: {what} of {here:.3} {unit} in the trace, {there:.3} {unit} in summary.json",
        run.vehicle
    );
    let file = ["csv", "parquet"]
        .map(|ending| path.join(format!("trace_{}.{ending}", run.vehicle)))
        .into_iter()
        .find(|file| file.exists());
    Err(problem(
        &file.unwrap_or_else(|| path.to_path_buf()),
        &message,
        "the file has been cut or belongs to another run; run it again",
    ))
}

/// The trace of a car, from whichever file there is.
fn history(path: &Path, vehicle: &str) -> Result<Option<History>, Problems> {
    // A name is the middle of a file name and must not lead anywhere else.
    if vehicle.is_empty() || vehicle.contains(['/', '\\', ':']) {
        let message =
            format!("`{vehicle}` cannot be the name of a vehicle: no file can be named after it");
        return Err(problem(&path.join(SUMMARY), &message, "run it again").into());
    }
    let csv = path.join(format!("trace_{vehicle}.csv"));
    if csv.exists() {
        let bytes =
            bounded::read_file(&csv, bounded::TRACE).map_err(|error| unreadable(&csv, &error))?;
        return History::read_csv(&csv.display().to_string(), &bytes).map(Some);
    }
    let parquet = path.join(format!("trace_{vehicle}.parquet"));
    if parquet.exists() {
        read_trace_parquet(&parquet).map(Some)
    } else {
        Ok(None)
    }
}

fn json(path: &Path) -> Result<Value, Problem> {
    let bytes =
        bounded::read_file(path, bounded::RECORD).map_err(|error| unreadable(path, &error))?;
    serde_json::from_slice(&bytes).map_err(|error| {
        let place = Place {
            file: path.display().to_string(),
            line: error.line(),
            column: error.column(),
            ..Place::default()
        };
        Problem::invalid(format!("this is no whole JSON: {error}"))
            .at(place)
            .hint("the file is damaged; run it again")
    })
}

/// JSON of a known schema to what it stands for.
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
            Err(problem(
                path,
                &message,
                "make the report with the program that wrote it",
            ))
        }
        Some(_) => serde_json::from_value(value).map_err(|error| {
            problem(
                path,
                &format!("the file is not as this program writes it: {error}"),
                "it is damaged; run it again",
            )
        }),
        None => Err(problem(
            path,
            "the file has no `schema`: it was not written by this program",
            "name a directory of `cvtcycle run`",
        )),
    }
}

pub(super) fn problem(path: &Path, message: &str, hint: &str) -> Problem {
    let place = Place {
        file: path.display().to_string(),
        ..Place::default()
    };
    Problem::invalid(message).at(place).hint(hint)
}

fn unreadable(path: &Path, error: &ReadError) -> Problem {
    let hint = match error.kind() {
        std::io::ErrorKind::NotFound => "check the path; it is taken from the current directory",
        std::io::ErrorKind::NotADirectory => "name the directory, not a file in it",
        _ => "check the path and its permissions",
    };
    let allowed = error.allowed("");
    problem(
        path,
        &format!("cannot read {}: {error}", path.display()),
        error.hint(hint),
    )
    .allowed(allowed)
}
