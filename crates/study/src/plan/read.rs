//! The head of a plan, and all its parts together.

use super::keys::{STUDY, default, known_words};
use super::{Base, FactorValue, Keep, Places, Plan, design, factor, form, options};
use cvtcycle_config::ProblemKind;
use cvtcycle_config::{
    Document, Override, Problem, Problems, RawValue, Reader, Section, did_you_mean,
};
use cvtcycle_model::keys::{Key, Values};
use cvtcycle_model::transmission::cvt::variator::Formulation;
use cvtcycle_output::trace::COLUMNS;

/// Reads a plan.
pub(super) fn plan(file: &str, text: &str) -> Result<Plan, Problems> {
    let mut document = Document::parse(file, text)?;
    let tables = document.take_tables("factor");
    let forms = document.take_tables("form");
    let (mut plan, mut problems) = head(&document, file, text);
    let is_of = |problem: &Problem, key: &str| problem.key.starts_with(key);
    let design_is_read = !problems
        .iter()
        .any(|problem| problem.key == "study" || is_of(problem, "study.design"));
    for table in &tables {
        match factor::read(table) {
            Ok(factor) => plan.factors.push(factor),
            Err(found) => problems.append(found),
        }
    }
    for table in &forms {
        match form::read(table) {
            Ok(form) => plan.forms.push(form),
            Err(found) => problems.append(found),
        }
    }
    if plan.forms.len() == forms.len() && plan.factors.len() == tables.len() {
        problems.append(form::join(&mut plan));
    }
    problems.append(design::clashes(&plan.factors));
    // Factors may be written in a way that gives none.
    if design_is_read && !problems.iter().any(|problem| is_of(problem, "factor")) {
        problems.append(design::limits(&plan, tables.len()));
    }
    if problems.is_empty() {
        problems = design::reach(&plan);
        problems.append(design::shadowed(&plan));
    }
    if problems.is_empty() {
        return Ok(plan);
    }
    problems.sort_by_key(|problem| {
        let place = &problem.place;
        (problem.not_shown().is_some(), place.line, place.column)
    });
    Err(problems)
}

fn head(document: &Document, file: &str, text: &str) -> (Plan, Problems) {
    let reader = Reader::new(document);
    let s = reader.root().table("study");
    let mut places = Places::new(s.place(""));
    let design = design::read(&s, &mut places);
    let plan = Plan {
        file: file.to_owned(),
        text: text.to_owned(),
        title: Values::text_or(&s, &STUDY.title, &stem(file)),
        question: Values::text_or(&s, &STUDY.question, ""),
        base: base(&s, &mut places),
        factors: Vec::new(),
        forms: Vec::new(),
        design,
        keep: keep(&s, &mut places),
        analyse: names(&s, &STUDY.analyse, &mut places).unwrap_or_default(),
        most_runs: s.integer(&STUDY.most_runs).unsigned_abs(),
        by_box: None,
        skip_missing: s.word(&STUDY.missing) == "skip",
        clip: s.word(&STUDY.bounds) == "clip",
        places,
    };
    let problems = reader.finish().err().unwrap_or_default();
    // Hints that fit vehicle files only.
    let fitting = |problem: Problem| match problem.key.starts_with("factor") {
        true => problem.hint("factors are written as [[factor]]"),
        false => problem,
    };
    (plan, problems.map(fitting))
}

fn stem(file: &str) -> String {
    let name = file.strip_prefix("embedded:").unwrap_or(file);
    let stem = std::path::Path::new(name).file_stem();
    stem.map_or_else(
        || name.to_owned(),
        |stem| stem.to_string_lossy().into_owned(),
    )
}

fn base(s: &Section, places: &mut Places) -> Base {
    let mut get = |row: &Key| {
        let written = s.written(row)?;
        places.add(row.name, written.place());
        options::value(row, &written)
    };
    let mut text = |row: &Key| {
        get(row)
            .or_else(|| default(row))
            .map(|value| value.to_string())
    };
    let vehicle = text(&STUDY.vehicle).unwrap_or_default();
    let cycle = text(&STUDY.cycle).unwrap_or_default();
    let start = text(&STUDY.start).unwrap_or_default();
    let (lubricant, engine_oil) = (text(&STUDY.lubricant), text(&STUDY.engine_oil));
    let formulation = text(&STUDY.formulation).unwrap_or_default();
    let mut number = |row: &Key| match get(row).or_else(|| default(row)) {
        Some(FactorValue::Number(x)) => x,
        _ => f64::NAN,
    };
    Base {
        ambient_degc: number(&STUDY.ambient_degc),
        dt_s: number(&STUDY.dt_s),
        vehicle,
        baselines: baselines(s, places),
        cycle,
        start,
        lubricant,
        engine_oil,
        set: overrides(s, &STUDY.set, places),
        set_all: overrides(s, &STUDY.set_all, places),
        formulation: Formulation::named(&formulation).unwrap_or_default(),
    }
}

/// Items of a list, with their places noted; none if the key is absent or no list.
fn items<'r>(s: &Section<'r>, row: &Key, places: &mut Places) -> Option<Vec<RawValue<'r>>> {
    let written = s.written(row)?;
    places.add(row.name, written.place());
    let items = written.items();
    match &items {
        Some(items) => places.add_items(row.name, items),
        None => written.complain_by_name(
            ProblemKind::WrongType,
            &row.allowed(),
            &format!("`study.{}` is no list", row.name),
            &format!("write {} = [{}]", row.name, written.text()),
        ),
    }
    items
}

fn baselines(s: &Section, places: &mut Places) -> Option<Vec<String>> {
    let items = items(s, &STUDY.baselines, places)?;
    let names = items
        .iter()
        .filter_map(|item| options::value(&STUDY.vehicle, item));
    Some(names.map(|value| value.to_string()).collect())
}

/// Overrides `KEY=VALUE`.
fn overrides(s: &Section, row: &Key, places: &mut Places) -> Vec<Override> {
    let parse = |item: &RawValue| {
        let Some(text) = item.word() else {
            item.wrong_type("a text KEY=VALUE");
            return None;
        };
        let read = text.parse::<Override>();
        read.map_err(|problem| item.report(problem)).ok()
    };
    let items = items(s, row, places).unwrap_or_default();
    items.iter().filter_map(parse).collect()
}

fn keep(s: &Section, places: &mut Places) -> Keep {
    let row = &STUDY.keep;
    let Some(written) = s.written(row) else {
        return Keep::Summary;
    };
    places.add(row.name, written.place());
    let what = row.allowed();
    match (written.word(), written.items()) {
        (Some("everything"), _) => return Keep::Everything,
        (Some("summary"), _) => {}
        (_, Some(items)) => {
            if items.is_empty() {
                let message = "`study.keep` is an empty list";
                written.complain_by_name(
                    ProblemKind::Missing,
                    &what,
                    message,
                    "write keep = \"summary\"",
                );
            }
            return Keep::Columns(unlike(row, &items, is_trace_column));
        }
        (Some(word), None) => {
            let columns = || format!("write keep = [{}] for columns", written.text());
            let hint = did_you_mean(word, known_words(row)).unwrap_or_else(columns);
            written.complain_by_name(
                ProblemKind::UnknownName,
                &what,
                &format!("`{word}` is not known for `study.keep`"),
                &hint,
            );
        }
        (None, None) => written.wrong_type(&what),
    }
    Keep::Summary
}

/// Checks that the trace has a column; reports it if not.
fn is_trace_column(item: &RawValue, word: &str) -> bool {
    let names = || COLUMNS.iter().map(|column| &*column.name);
    let is_known = names().any(|name| name == word);
    if !is_known {
        let all = || "the trace of a run shows all".to_owned();
        let hint = did_you_mean(word, names()).unwrap_or_else(all);
        let message = format!("the trace has no column `{word}`");
        item.unknown_name("columns of the trace", &message, &hint);
    }
    is_known
}

/// Columns to analyse; their names are known only when the runs are.
fn names(s: &Section, row: &Key, places: &mut Places) -> Option<Vec<String>> {
    Some(unlike(row, &items(s, row, places)?, |_, _| true))
}

/// Names of columns that are known, each once.
fn unlike(
    row: &Key,
    items: &[RawValue],
    is_known: impl Fn(&RawValue, &str) -> bool,
) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for item in items {
        match item.word() {
            None => item.wrong_type("the name of a column"),
            Some(word) if !is_known(item, word) => {}
            Some(word) if found.iter().any(|other| other == word) => {
                let message = format!("`{word}` is listed twice in `study.{}`", row.name);
                item.complain_by_name(ProblemKind::Duplicate, "", &message, "remove one");
            }
            Some(word) => found.push(word.to_owned()),
        }
    }
    found
}
