//! The head of a plan, and all its parts together.

use std::sync::OnceLock;

use super::keys::HEAD;
use super::{CalibrationPlan, Context, Found, FreeParameter, group, parameter, problem};
use crate::solve::Options;
use cvtcycle_config::ProblemKind::{self, Duplicate, Missing};
use cvtcycle_config::setup::{Kind, NamedBy, text_of};
use cvtcycle_config::{Document, Place, Problem, Problems, Reader, Section, near};
use cvtcycle_model::keys::Values;
use cvtcycle_validate::checks::FileNames;
use cvtcycle_validate::rows::RowFile;
use cvtcycle_validate::source::{self, Source, relative_to};
use cvtcycle_validate::{COMMON, CandidateVehicle, embedded_rows};

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
    let [parameters, data] = ["parameter", "data"].map(|name| document.take_tables(name));
    let rows = shipped_rows().as_ref().map_err(Clone::clone)?;
    let common = common_sources().as_ref().map_err(Clone::clone)?;
    let reader = Reader::new(&document);
    let root = reader.root();
    let head = root.table("calibration");
    let mut sources = source::read(&root.table("sources"), common);
    source::resolve_paths(&mut sources, file);
    let own = sources.len();
    sources.extend(common.iter().cloned());
    let mut plan = head_of(&head, file, text);
    let exists = head.exists();
    let mut problems = reader.finish().err().unwrap_or_default().map(fitting);
    let suggested: Vec<String> = problems.iter().flat_map(|p| p.suggested.clone()).collect();
    let is_hinted = |header: &str| suggested.iter().any(|name| name == header);
    if !exists && !is_hinted("[calibration]") {
        let message = "the plan has no [calibration]".to_owned();
        let hint = "add [calibration] with the vehicle that is fitted";
        let place = &plan.place;
        problems.push(problem(
            Missing,
            place,
            "calibration",
            "a table",
            message,
            hint,
        ));
    }
    problems.extend(source::within_budget(&sources[..own]).err());
    // Tables written in another form count as present, so that they are not reported as missing.
    let written = [("[[parameter]]", &parameters), ("[[data]]", &data)];
    let written = written.map(|(header, list)| list.len().max(usize::from(is_hinted(header))));
    for document in &parameters {
        match parameter::read(document, file) {
            Ok(free) => plan.parameters.push(free),
            Err(found) => problems.append(found),
        }
    }
    plan.views.push(sources.clone());
    plan.views
        .extend(rows.iter().map(|file| file.sources.clone()));
    let names = FileNames { sources: &sources };
    for document in &data {
        let context = Context {
            names: &names,
            rows,
            file,
            benches: plan.benches.len(),
            runs: plan.runs.len(),
        };
        match group::read(document, &context) {
            Ok(found) => join(&mut plan, found),
            // Two groups may name the same bad file.
            Err(mut found) => {
                found.retain(|problem| !problems.contains(problem));
                problems.append(found);
            }
        }
    }
    let is_sound = problems.is_empty();
    problems.append(clashes(&plan, written, is_sound));
    Ok((plan, problems))
}

/// The rows that the program carries: the same for every plan, read once.
fn shipped_rows() -> &'static Result<Vec<RowFile>, Problems> {
    static ROWS: OnceLock<Result<Vec<RowFile>, Problems>> = OnceLock::new();
    ROWS.get_or_init(|| {
        let files = embedded_rows().iter();
        let texts = files.map(|(name, text)| ((*name).to_owned(), (*text).to_owned()));
        cvtcycle_validate::read(COMMON, &texts.collect::<Vec<_>>())
    })
}

/// The sources that every plan may use.
fn common_sources() -> &'static Result<Vec<Source>, Problems> {
    static COMMON_SOURCES: OnceLock<Result<Vec<Source>, Problems>> = OnceLock::new();
    COMMON_SOURCES.get_or_init(|| {
        let mut files = cvtcycle_validate::read(COMMON, &[(String::new(), String::new())])?;
        Ok(files.pop().map(|file| file.sources).unwrap_or_default())
    })
}

fn head_of(s: &Section, file: &str, text: &str) -> CalibrationPlan {
    let count = |key| usize::try_from(s.integer(key)).unwrap_or(1);
    let word = |key| s.optional_text(key).map(|word| relative_to(file, &word));
    CalibrationPlan {
        file: file.to_owned(),
        text: text.to_owned(),
        title: Values::text_or(s, &HEAD.title, &stem(file)),
        car: CandidateVehicle {
            vehicle: relative_to(file, &Values::text(s, &HEAD.vehicle)),
            lubricant: word(&HEAD.lubricant),
            engine_oil: word(&HEAD.engine_oil),
            set: s.overrides(&HEAD.set),
            named_by: NamedBy::File,
        },
        search: Options {
            starts: count(&HEAD.starts),
            seed: s.integer(&HEAD.seed).unsigned_abs(),
            max_evaluations: count(&HEAD.most_evaluations),
            tolerance: Values::number(s, &HEAD.tolerance),
        },
        leave_out: s.flag(&HEAD.leave_out),
        place: s.place(""),
        places: ["vehicle", "lubricant", "engine_oil", "set"].map(|key| s.place(key)),
        ..CalibrationPlan::default()
    }
}

/// The name of a file without folder and ending; another word as it is.
pub fn stem(file: &str) -> String {
    let name = file.strip_prefix("embedded:").unwrap_or(file);
    let stem = std::path::Path::new(name).file_stem();
    stem.map_or_else(
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
    if problem.kind != ProblemKind::UnknownKey {
        return problem;
    }
    let close = near(&problem.key, TABLES.iter().map(|(key, _)| *key));
    let meant = close.first().copied().unwrap_or(&problem.key);
    let Some((key, header)) = TABLES.iter().find(|(key, _)| *key == meant) else {
        return problem;
    };
    let hint = match *key == problem.key {
        true => format!("it is written as {header}"),
        false => format!("did you mean {header}?"),
    };
    problem.suggest(&[header]).hint(hint)
}

/// Adds a group to the plan.
fn join(plan: &mut CalibrationPlan, found: Found) {
    let group = plan.groups.len();
    for (mut observation, name) in found.observations.into_iter().zip(found.folds) {
        let fold = plan.folds.iter().position(|known| *known == name);
        observation.group = group;
        observation.fold = fold.unwrap_or(plan.folds.len());
        if fold.is_none() {
            plan.folds.push(name);
        }
        plan.observations.push(observation);
    }
    plan.groups.push(found.group);
    plan.benches.extend(found.benches);
    plan.runs.extend(found.runs);
    plan.rows.extend(found.rows);
    plan.files.extend(found.files);
}

/// True if a vehicle has both numbers.
fn shares_a_vehicle(plan: &CalibrationPlan, a: &FreeParameter, b: &FreeParameter) -> bool {
    let mut named = a.vehicles.iter().chain([&plan.car.vehicle]);
    named.any(|vehicle| a.is_of(vehicle, plan) && b.is_of(vehicle, plan))
}

/// All clashes; `[parameters, groups]` is how many were written, and `sound` whether nothing else is wrong.
fn clashes(plan: &CalibrationPlan, [parameters, groups]: [usize; 2], sound: bool) -> Problems {
    let mut problems = Problems::new();
    let mut add = |kind, place: &Place, key: &str, allowed: &str, message: String, hint: &str| {
        problems.push(problem(kind, place, key, allowed, message, hint));
    };
    if parameters == 0 {
        let (allowed, message) = ("at least one [[parameter]]", "nothing is free".to_owned());
        let hint = "add a [[parameter]] with key, low and high";
        add(Missing, &plan.place, "parameter", allowed, message, hint);
    }
    if groups == 0 {
        let (allowed, message) = ("at least one [[data]]", "there are no data".to_owned());
        let hint = "add a [[data]] with what was measured";
        add(Missing, &plan.place, "data", allowed, message, hint);
    }
    for (k, free) in plan.parameters.iter().enumerate() {
        let both = plan.parameters[..k].iter().find_map(|other| {
            let key = free
                .keys()
                .find(|key| other.keys().any(|own| own == *key))?;
            shares_a_vehicle(plan, other, free).then_some((other, key))
        });
        if let Some((first, key)) = both {
            let line = first.place.line;
            let message = format!("`{key}` is free twice, first in line {line}");
            add(Duplicate, &free.place, "key", "", message, "remove one");
        }
    }
    for (k, group) in plan.groups.iter().enumerate() {
        if let Some(first) = plan.groups[..k]
            .iter()
            .find(|other| other.name == group.name)
        {
            let (name, line) = (&group.name, first.place.line);
            let message = format!("the name `{name}` was used before, by the data in line {line}");
            add(
                Duplicate,
                &group.place,
                "name",
                "",
                message,
                "give each [[data]] a `name` of its own",
            );
        }
    }
    for (k, id) in plan.rows.iter().enumerate() {
        if plan.rows[..k].contains(id) {
            // Observations of rows bear their identifiers.
            let last = plan.observations.iter().rfind(|o| o.label == *id);
            let place = last.map_or(&plan.place, |o| &o.place);
            let message = format!("row {id} is used by two groups");
            let hint = "a number counts once: remove it from one of them";
            add(Duplicate, place, "rows", "", message, hint);
        }
    }
    let measured = plan.observations.len();
    let priors = plan
        .parameters
        .iter()
        .filter(|free| free.prior.is_some())
        .count();
    if sound && groups > 0 && measured + priors < parameters {
        let message = format!(
            "too few data: measured numbers {measured}, priors {priors}, parameters {parameters}"
        );
        let allowed = format!("at least {parameters} measured numbers and priors together");
        let hint = "hold some parameters, add data, or give priors";
        add(Missing, &plan.place, "data", &allowed, message, hint);
    }
    problems
}
