//! The head of a plan, and all its parts together.

use super::{Base, FactorValue, Keep, Places, Plan, design, factor, options};
use cvtcycle_config::{
    Document, Override, Problem, Problems, RawValue, Reader, Section, did_you_mean,
};
use cvtcycle_model::transmission::cvt::variator::Formulation;
use cvtcycle_output::trace::COLUMNS;

/// Runs above which the user has to agree, unless the plan says otherwise.
const MAX_RUNS: i64 = 100_000;

/// Reads a plan.
pub(super) fn plan(file: &str, text: &str) -> Result<Plan, Problems> {
    let mut document = Document::parse(file, text)?;
    let tables = document.take_tables("factor");
    let (mut plan, mut problems) = head(&document, file, text);
    let design_is_read = !problems
        .iter()
        .any(|problem| problem.key == "study" || problem.key.starts_with("study.design"));
    for table in &tables {
        match factor::read(table) {
            Ok(factor) => plan.factors.push(factor),
            Err(found) => problems.append(found),
        }
    }
    problems.append(design::clashes(&plan.factors));
    if design_is_read && !has_other_factors(&problems) {
        problems.append(design::limits(
            &plan.design,
            tables.len(),
            &plan.factors,
            &plan.places,
        ));
    }
    if problems.is_empty() {
        problems = design::reach(&plan);
    }
    if problems.is_empty() {
        return Ok(plan);
    }
    problems.sort_by_key(|problem| {
        (
            problem.not_shown().is_some(),
            problem.place.line,
            problem.place.column,
        )
    });
    Err(problems)
}

/// Whether factors are written in a way that gives none.
fn has_other_factors(problems: &[Problem]) -> bool {
    problems
        .iter()
        .any(|problem| problem.key.starts_with("factor"))
}

fn head(document: &Document, file: &str, text: &str) -> (Plan, Problems) {
    let reader = Reader::new(document);
    let s = reader.root().table("study");
    let mut places = Places::new(s.place(""));
    let design = design::read(&s, &mut places);
    let plan = Plan {
        file: file.to_owned(),
        text: text.to_owned(),
        title: s.text_or("title", &stem(file), "name for people"),
        question: s.text_or("question", "", "what the study is to answer"),
        base: base(&s, &mut places),
        factors: Vec::new(),
        design,
        keep: keep(&s),
        analyse: analyse(&s, &mut places),
        most_runs: s
            .integer_or(
                "most_runs",
                1..=i64::MAX,
                MAX_RUNS,
                "number of runs above which --yes is needed",
            )
            .unsigned_abs(),
        places,
    };
    let problems = reader.finish().err().unwrap_or_default();
    (plan, problems.into_iter().map(fitting).collect())
}

/// A problem without hints that fit vehicle files only.
fn fitting(problem: Problem) -> Problem {
    if problem.key.starts_with("factor") {
        problem.hint("factors are written as [[factor]]")
    } else {
        problem
    }
}

fn stem(file: &str) -> String {
    let name = file.strip_prefix("embedded:").unwrap_or(file);
    std::path::Path::new(name).file_stem().map_or_else(
        || name.to_owned(),
        |stem| stem.to_string_lossy().into_owned(),
    )
}

fn base(s: &Section, places: &mut Places) -> Base {
    let mut get = |key: &str, doc: &str| {
        let written = s.raw(key, &options::allowed(key), doc)?;
        places.add(key, written.place());
        options::value(key, &written)
    };
    let vehicle = get("vehicle", "the car in question");
    let cycle = get("cycle", "cycle of all runs");
    let ambient = get("ambient_degc", "ambient temperature");
    let start = get("start", "temperatures at the start");
    let lubricant = get("lubricant", "transmission oil of the car in question");
    let engine_oil = get("engine_oil", "engine oil of all cars");
    let step = get("dt_s", "longest time step");
    let formulation = get("formulation", "reading of the belt model");
    let text = |value: Option<FactorValue>, default: &str| {
        value.map_or_else(|| default.to_owned(), |value| value.to_string())
    };
    let number = |value: Option<FactorValue>, default: f64| match value {
        Some(FactorValue::Number(x)) => x,
        _ => default,
    };
    let formulation = text(formulation, "");
    Base {
        vehicle: text(vehicle, "rover_216_cvt"),
        baselines: baselines(s, places),
        cycle: text(cycle, "ece15_eudc"),
        ambient_degc: number(ambient, 25.0),
        start: text(start, "soak"),
        lubricant: lubricant.map(|value| value.to_string()),
        engine_oil: engine_oil.map(|value| value.to_string()),
        set: assignments(
            s,
            "set",
            "overrides KEY=VALUE of the car in question",
            places,
        ),
        set_all: assignments(s, "set_all", "overrides KEY=VALUE of all cars", places),
        dt_s: number(step, 1.0),
        formulation: Formulation::NAMES
            .iter()
            .find(|(name, _)| *name == formulation)
            .map_or(Formulation::Smooth, |(_, f)| *f),
    }
}

/// Items of a list, with their places noted; none if the key is absent or no list.
fn items<'r>(
    s: &Section<'r>,
    key: &str,
    what: &str,
    doc: &str,
    places: &mut Places,
) -> Option<Vec<RawValue<'r>>> {
    let written = s.raw(key, what, doc)?;
    places.add(key, written.place());
    let items = written.items();
    match &items {
        Some(items) => items
            .iter()
            .enumerate()
            .for_each(|(k, item)| places.add_item(key, k, item.place())),
        None => written.complain(
            what,
            &format!("`study.{key}` is no list"),
            &format!("write {key} = [{}]", written.text()),
        ),
    }
    items
}

fn baselines(s: &Section, places: &mut Places) -> Option<Vec<String>> {
    let items = items(
        s,
        "baselines",
        "a list of vehicles",
        "cars to compare with; [] for none",
        places,
    )?;
    Some(
        items
            .iter()
            .filter_map(|item| options::value("vehicle", item))
            .map(|value| value.to_string())
            .collect(),
    )
}

/// Assignments `KEY=VALUE`, checked as such.
fn assignments(s: &Section, key: &str, doc: &str, places: &mut Places) -> Vec<Override> {
    let items = items(s, key, "a list of texts KEY=VALUE", doc, places).unwrap_or_default();
    let mut good = Vec::new();
    for item in items {
        let Some(assignment) = item.word() else {
            item.wrong_type("a text KEY=VALUE");
            continue;
        };
        let example = "write, for example, \"road_load.mass_kg=1250\"";
        match assignment.parse::<Override>() {
            Ok(by) => good.push(by),
            Err(problem) => item.report(problem.allowed("KEY=VALUE").hint(example)),
        }
    }
    good
}

fn keep(s: &Section) -> Keep {
    let what = "summary, everything, or a list of columns of the trace";
    let Some(written) = s.raw("keep", what, "what is kept of each run") else {
        return Keep::Summary;
    };
    match (written.word(), written.items()) {
        (Some("summary"), _) => Keep::Summary,
        (Some("everything"), _) => Keep::Everything,
        (_, Some(items)) => Keep::Columns(columns(&written, &items, what)),
        (Some(word), None) => {
            let columns = format!("write keep = [{}] for columns", written.text());
            let hint = did_you_mean(word, ["summary", "everything"]).unwrap_or(columns);
            written.complain(
                what,
                &format!("`{word}` is not known for `study.keep`"),
                &hint,
            );
            Keep::Summary
        }
        (None, None) => {
            written.wrong_type(what);
            Keep::Summary
        }
    }
}

fn columns(whole: &RawValue, items: &[RawValue], what: &str) -> Vec<String> {
    if items.is_empty() {
        whole.complain(
            what,
            "`study.keep` is an empty list",
            "write keep = \"summary\"",
        );
    }
    let mut found: Vec<String> = Vec::new();
    for item in items {
        let Some(word) = item.word() else {
            item.wrong_type("the name of a column");
            continue;
        };
        if !COLUMNS.iter().any(|column| column.name == word) {
            let hint = did_you_mean(word, COLUMNS.iter().map(|column| &*column.name))
                .unwrap_or_else(|| "the trace of `run --out` shows all".to_owned());
            item.complain(
                "columns of the trace",
                &format!("the trace has no column `{word}`"),
                &hint,
            );
        } else if found.iter().any(|other| other == word) {
            item.complain(
                "",
                &format!("`{word}` is listed twice in `study.keep`"),
                "remove one",
            );
        } else {
            found.push(word.to_owned());
        }
    }
    found
}

/// Columns to analyse; their names are known only when the runs are.
fn analyse(s: &Section, places: &mut Places) -> Vec<String> {
    let items = items(
        s,
        "analyse",
        "a list of columns of the results",
        "columns that are analysed",
        places,
    )
    .unwrap_or_default();
    let mut found: Vec<String> = Vec::new();
    for item in items {
        match item.word() {
            None => item.wrong_type("the name of a column"),
            Some(word) if found.iter().any(|other| other == word) => {
                item.complain(
                    "",
                    &format!("`{word}` is listed twice in `study.analyse`"),
                    "remove one",
                );
            }
            Some(word) => found.push(word.to_owned()),
        }
    }
    found
}
