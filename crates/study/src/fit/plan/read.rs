//! The head of a plan, and all its parts together.

use std::sync::OnceLock;

use super::found::{Context, Found};
use super::group;
use super::parameter;
use super::types::{CalibrationPlan, Observable, Search, problem};
use crate::check::candidate::CandidateVehicle;
use crate::check::rows::RowFile;
use crate::check::source::{self, Source};
use crate::check::{COMMON, embedded_rows};
use cvtcycle_config::setup::{Kind, NamedBy, catalogue, is_path, text_of};
use cvtcycle_config::{Bound, Document, Problem, ProblemKind, Problems, Reader, Section, near};

/// Most starts.
const MOST_STARTS: i64 = 1000;

/// Reads the plan that a word of the user means: an embedded name, or the path of a TOML file.
///
/// # Errors
/// Unknown name, unreadable path, and all problems of the file and of the data that it names.
pub fn load(word: &str) -> Result<CalibrationPlan, Problems> {
    sound(gather(word)?)
}

fn sound((plan, problems): (CalibrationPlan, Problems)) -> Result<CalibrationPlan, Problems> {
    if problems.is_empty() {
        Ok(plan)
    } else {
        Err(problems)
    }
}

/// As [`load`], but returns the readable part of a bad plan with its problems, for further checks.
///
/// # Errors
/// An unknown name, an unreadable path, a text that is no TOML.
pub fn gather(word: &str) -> Result<(CalibrationPlan, Problems), Problems> {
    let (file, text, _) = text_of(word, Kind::Calibration, NamedBy::Caller)?;
    partly(&file, &text)
}

/// Reads a plan and the data files that it names; `file` is the plan's own name or path.
///
/// # Errors
/// All problems of all of them.
pub fn read(file: &str, text: &str) -> Result<CalibrationPlan, Problems> {
    sound(partly(file, text)?)
}

fn partly(file: &str, text: &str) -> Result<(CalibrationPlan, Problems), Problems> {
    let mut document = Document::parse(file, text)?;
    let (parameters, data) = (
        document.take_tables("parameter"),
        document.take_tables("data"),
    );
    let rows = shipped_rows().as_ref().map_err(Clone::clone)?;
    let reader = Reader::new(&document);
    let root = reader.root();
    let head = root.table("calibration");
    let common = common_sources().as_ref().map_err(Clone::clone)?;
    let mut sources = source::read(&root.table("sources"), common);
    sources.extend(common.iter().cloned());
    let mut plan = head_of(&head, file, text);
    let exists = head.exists();
    let mut problems: Problems = reader
        .finish()
        .err()
        .unwrap_or_default()
        .into_iter()
        .map(fitting)
        .collect();
    let hinted = |problems: &[Problem], word: &str| {
        problems
            .iter()
            .flat_map(|problem| &problem.suggested)
            .any(|name| name == word)
    };
    if !exists && !hinted(&problems, "[calibration]") {
        let hint = "add [calibration] with the vehicle that is fitted";
        problems.push(problem(
            &plan.place,
            "calibration",
            "a table",
            "the plan has no [calibration]".to_owned(),
            hint,
        ));
    }
    // What is written in another way is there all the same.
    let parameters_written = parameters
        .len()
        .max(usize::from(hinted(&problems, "[[parameter]]")));
    let data_written = data.len().max(usize::from(hinted(&problems, "[[data]]")));
    for document in &parameters {
        match parameter::read(document) {
            Ok(free) => plan.parameters.push(free),
            Err(found) => problems.append(found),
        }
    }
    source::resolve_paths(&mut sources, file);
    let context = Context {
        sources: &sources,
        keys: catalogue::known_names(),
        rows,
        file,
    };
    plan.views.push(sources.clone());
    for document in &data {
        match group::read(document, &context) {
            Ok(found) => join(&mut plan, found),
            // Two groups may name the same bad file.
            Err(mut found) => {
                found.retain(|problem| !problems.contains(problem));
                problems.append(found);
            }
        }
    }
    let sound = problems.is_empty();
    problems.append(clashes(&plan, [parameters_written, data_written], sound));
    Ok((plan, problems))
}

/// The rows that the program carries: the same for every plan, read once.
fn shipped_rows() -> &'static Result<Vec<RowFile>, Problems> {
    static ROWS: OnceLock<Result<Vec<RowFile>, Problems>> = OnceLock::new();
    let texts = || {
        embedded_rows()
            .iter()
            .map(|(name, text)| ((*name).to_owned(), (*text).to_owned()))
            .collect::<Vec<_>>()
    };
    ROWS.get_or_init(|| crate::check::read(COMMON, &texts()))
}

/// The sources that every plan may use.
fn common_sources() -> &'static Result<Vec<Source>, Problems> {
    static COMMON_SOURCES: OnceLock<Result<Vec<Source>, Problems>> = OnceLock::new();
    COMMON_SOURCES.get_or_init(|| {
        let files = crate::check::read(COMMON, &[(String::new(), String::new())])?;
        Ok(files
            .into_iter()
            .next_back()
            .map(|file| file.sources)
            .unwrap_or_default())
    })
}

fn head_of(s: &Section, file: &str, text: &str) -> CalibrationPlan {
    let integer = |key: &str, range, default, doc: &str| s.integer_or(key, range, default, doc);
    let search = Search {
        starts: usize::try_from(integer(
            "starts",
            1..=MOST_STARTS,
            4,
            "number of starts; the first one is at the values of the files",
        ))
        .unwrap_or(1),
        seed: integer("seed", 0..=i64::MAX, 1, "seed of the other starts").unsigned_abs(),
        max_evaluations: usize::try_from(integer(
            "most_evaluations",
            1..=1_000_000,
            5000,
            "most evaluations of a start",
        ))
        .unwrap_or(1),
        tolerance: s.number_or(
            "tolerance",
            Bound::closed(1e-14, 1e-2),
            1e-8,
            "relative change at which a start ends",
        ),
        leave_out: s.boolean_or(
            "leave_out",
            true,
            "whether each fold is predicted by a fit to the others",
        ),
    };
    let vehicle = s.text_or(
        "vehicle",
        "rover_216_cvt",
        "vehicle whose values are fitted",
    );
    let within = |word: String| {
        let folder = std::path::Path::new(file)
            .parent()
            .filter(|_| is_path(&word));
        folder.map_or_else(
            || word.clone(),
            |folder| folder.join(&word).to_string_lossy().into_owned(),
        )
    };
    CalibrationPlan {
        file: file.to_owned(),
        text: text.to_owned(),
        title: s.text_or("title", &stem(file), "name for people"),
        car: CandidateVehicle {
            vehicle: within(vehicle),
            lubricant: s
                .optional_text("lubricant", "transmission oil in place of the vehicle's")
                .map(within),
            engine_oil: s
                .optional_text("engine_oil", "engine oil in place of the vehicle's")
                .map(within),
            set: s.overrides("set", "overrides KEY=VALUE, held during the fit"),
            named_by: NamedBy::File,
        },
        search,
        parameters: Vec::new(),
        groups: Vec::new(),
        folds: Vec::new(),
        observations: Vec::new(),
        views: Vec::new(),
        benches: Vec::new(),
        runs: Vec::new(),
        rows: Vec::new(),
        files: Vec::new(),
        place: s.place(""),
        places: ["vehicle", "lubricant", "engine_oil", "set"].map(|key| s.place(key)),
    }
}

fn stem(file: &str) -> String {
    let name = file.strip_prefix("embedded:").unwrap_or(file);
    std::path::Path::new(name).file_stem().map_or_else(
        || name.to_owned(),
        |stem| stem.to_string_lossy().into_owned(),
    )
}

/// A problem without hints that fit vehicle files only.
fn fitting(problem: Problem) -> Problem {
    const TABLES: [(&str, &str); 4] = [
        ("calibration", "[calibration]"),
        ("sources", "[sources.NAME]"),
        ("parameter", "[[parameter]]"),
        ("data", "[[data]]"),
    ];
    let meant = near(&problem.key, TABLES.iter().map(|(key, _)| *key))
        .first()
        .copied()
        .unwrap_or(problem.key.as_str());
    let table = TABLES
        .iter()
        .find(|(key, _)| *key == meant && problem.kind == ProblemKind::UnknownKey);
    let Some((key, header)) = table else {
        return problem;
    };
    let hint = if *key == problem.key {
        format!("it is written as {header}")
    } else {
        format!("did you mean {header}?")
    };
    problem.suggest(&[header]).hint(hint)
}

/// Adds a group to the plan, counting on what is there.
fn join(plan: &mut CalibrationPlan, found: Found) {
    let (views, benches, runs) = (plan.views.len(), plan.benches.len(), plan.runs.len());
    // The plan's own list of sources is the first one.
    let mut places = Vec::new();
    for view in found.views {
        match view {
            None => places.push(0),
            Some(sources) => {
                let known = plan.views[views..]
                    .iter()
                    .position(|other| same(other, &sources))
                    .map(|k| views + k);
                places.push(known.unwrap_or(plan.views.len()));
                if known.is_none() {
                    plan.views.push(sources);
                }
            }
        }
    }
    let group = plan.groups.len();
    for (mut observation, fold) in found.observations.into_iter().zip(found.folds) {
        observation.group = group;
        observation.fold = plan
            .folds
            .iter()
            .position(|name| *name == fold)
            .unwrap_or_else(|| {
                plan.folds.push(fold);
                plan.folds.len() - 1
            });
        match &mut observation.observable {
            Observable::Expression { view, .. } => *view = places[*view],
            Observable::Point { bench, .. } => *bench += benches,
            Observable::Trace { run, .. } | Observable::Total { run, .. } => *run += runs,
        }
        plan.observations.push(observation);
    }
    plan.groups.extend(found.group);
    plan.benches.extend(found.made.benches);
    plan.runs.extend(found.made.runs);
    plan.rows.extend(found.rows);
    plan.files.extend(found.made.files);
}

/// Whether two lists of sources are those of the same file.
fn same(a: &[Source], b: &[Source]) -> bool {
    a.len() == b.len()
        && a.iter()
            .zip(b)
            .all(|(a, b)| a.name == b.name && a.place == b.place)
}

/// What is wrong between the parts, `[parameters, groups]` being how many were written.
fn clashes(plan: &CalibrationPlan, [parameters, groups]: [usize; 2], sound: bool) -> Problems {
    let mut problems = Problems::new();
    if parameters == 0 {
        problems.push(problem(
            &plan.place,
            "parameter",
            "at least one [[parameter]]",
            "nothing is free".into(),
            "add a [[parameter]] with key, low and high",
        ));
    }
    if groups == 0 {
        problems.push(problem(
            &plan.place,
            "data",
            "at least one [[data]]",
            "there are no data".into(),
            "add a [[data]] with what was measured",
        ));
    }
    for (k, free) in plan.parameters.iter().enumerate() {
        if let Some(first) = plan.parameters[..k]
            .iter()
            .find(|other| other.key == free.key)
        {
            let message = format!(
                "`{}` is free twice, first in line {}",
                free.key, first.place.line
            );
            problems.push(problem(&free.place, "key", "", message, "remove one"));
        }
    }
    for (k, group) in plan.groups.iter().enumerate() {
        if let Some(first) = plan.groups[..k]
            .iter()
            .find(|other| other.name == group.name)
        {
            let message = format!(
                "the name `{}` was used before, by the data in line {}",
                group.name, first.place.line
            );
            problems.push(problem(
                &group.place,
                "name",
                "",
                message,
                "give each [[data]] a `name` of its own",
            ));
        }
    }
    for (k, id) in plan.rows.iter().enumerate() {
        if plan.rows[..k].contains(id) {
            // Observations of rows bear their identifiers.
            let place = plan
                .observations
                .iter()
                .rfind(|o| o.label == *id)
                .map_or(&plan.place, |o| &o.place);
            let hint = "a number counts once: remove it from one of them";
            problems.push(problem(
                place,
                "rows",
                "",
                format!("row {id} is used by two groups"),
                hint,
            ));
        }
    }
    // Fewer data and priors than parameters.
    let known = plan.observations.len()
        + plan
            .parameters
            .iter()
            .filter(|free| free.prior.is_some())
            .count();
    if sound && groups > 0 && known < parameters {
        let message = format!(
            "too few data: measured numbers {}, priors {}, parameters {parameters}",
            plan.observations.len(),
            known - plan.observations.len()
        );
        problems.push(problem(
            &plan.place,
            "data",
            &format!("at least {parameters} measured numbers and priors together"),
            message,
            "hold some parameters, add data, or give priors",
        ));
    }
    problems
}
