//! One `[[data]]` of a plan, and its observations.

use std::sync::Arc;

use super::files;
use super::found::{About, Context, Found, observation};
use super::types::{Group, Measured, Observable, problem};
use crate::check::checks::number_or_range;
use crate::check::expr::{Expr, Gives};
use crate::check::names::{FileNames, expression};
use crate::check::rows::{RowFile, ValidationRow};
use crate::check::rule::Printed;
use cvtcycle_config::{Bound, Document, Problem, Problems, Reader, Section, did_you_mean};

/// Forms of data, one of which a group has.
const WAYS: [&str; 5] = ["rows", "compute", "points", "trace", "scalars"];

/// Reads a group.
///
/// # Errors
/// All its problems.
pub(super) fn read(document: &Document, context: &Context) -> Result<Found, Problems> {
    let reader = Reader::new(document);
    let s = reader.root();
    let ways: Vec<&str> = WAYS.into_iter().filter(|way| s.has(way)).collect();
    let name = s.text_or(
        "name",
        ways.first().copied().unwrap_or("data"),
        "name of the group",
    );
    let common_sd = s.optional_number(
        "common_sd",
        Bound::positive(),
        "standard deviation of an error that all have in common",
    );
    let group = Group {
        name: name.clone(),
        from: s.text("from", "where the data come from"),
        common_sd,
        place: s.place("name"),
    };
    let fold = s.text_or(
        "fold",
        &name,
        "name of the fold: groups of one fold are left out together",
    );
    let mut found = Found {
        group: Some(group),
        ..Found::default()
    };
    match ways.as_slice() {
        ["rows"] => rows(&s, context, &mut found),
        ["compute"] => statement(&s, context, &mut found),
        [way] => files::read(&s, way, context, &mut found),
        [] => {
            let hint = "give `rows`, `compute`, `points`, `trace` or `scalars`";
            s.report_problem(problem(
                &s.place("rows"),
                "",
                &WAYS.join(", "),
                "the group has no data".to_owned(),
                hint,
            ));
        }
        [.., last] => {
            s.complain(
                last,
                "one of them",
                &format!("{} stand together", ways.join(" and ")),
                "write a [[data]] for each",
            );
            // Which keys belong to it is not known.
            s.names()
                .into_iter()
                .for_each(|key| drop(s.raw(key, "", "")));
        }
    }
    if found.folds.is_empty() {
        found.folds = vec![fold; found.observations.len()];
    }
    let place = s.place(ways.first().copied().unwrap_or_default());
    match reader.finish() {
        Ok(_) if found.observations.is_empty() => {
            let hint = match ways[0] {
                "rows" => "name at least one row; `cvtcycle validate` lists them",
                "compute" => "write an expression over the sources; docs/validation_format.md",
                _ => {
                    "name a CSV file, relative to the plan, and fill the cells of what was measured"
                }
            };
            let message = "there is no measured number in it".to_owned();
            let nothing = problem(
                &place,
                ways[0],
                "at least one measured number",
                message,
                hint,
            );
            Err(in_group(nothing, &name, context.file).into())
        }
        Ok(_) => Ok(found),
        Err(problems) => Err(problems
            .into_iter()
            .map(|p| in_group(p, &name, context.file))
            .collect()),
    }
}

/// A problem under the name of its group.
fn in_group(problem: Problem, name: &str, plan: &str) -> Problem {
    // The problem of another file has that file's place.
    if problem.place.file_name() != Some(plan) {
        return problem;
    }
    problem.with_context(&format!("data `{name}`: "))
}

/// The standard deviation that a whole group has: `sd`, or a share of what was measured.
fn sd_of(s: &Section) -> impl Fn(f64) -> f64 {
    let absolute = s.optional_number(
        "sd",
        Bound::positive(),
        "standard deviation, in the unit of the data",
    );
    let share = s.optional_number(
        "sd_share",
        Bound::positive(),
        "standard deviation as a share of the measured number",
    );
    match (absolute, share) {
        (Some(_), Some(_)) => s.complain(
            "sd_share",
            "`sd` or `sd_share`",
            "`sd` with `sd_share`",
            "keep one of them",
        ),
        (None, None) => {
            let hint = "how far may a repeated measurement be off? give that as `sd`";
            s.complain(
                "sd",
                "`sd` or `sd_share`",
                "the data have no standard deviation",
                hint,
            );
        }
        _ => {}
    }
    move |x: f64| {
        absolute
            .or(share.map(|share| share * x.abs()))
            .unwrap_or(f64::NAN)
    }
}

/// Reports a share of a number of 0, which leaves no standard deviation.
fn share_of_zero(s: &Section, what: &str, size: f64) {
    // Only 0: a small number has a small deviation.
    if s.has("sd_share") && size.abs() < f64::MIN_POSITIVE {
        let message =
            format!("{what} is 0, or a range about 0: no share of it is a standard deviation");
        s.complain(
            "sd_share",
            "for numbers other than 0",
            &message,
            "give `sd` in the unit of the data",
        );
    }
}

/// Printed numbers of the program's own validation rows.
fn rows(s: &Section, context: &Context, found: &mut Found) {
    let ids = s.texts("rows", "identifiers of validation rows");
    let sd = sd_of(s);
    for id in ids {
        let place = s.place("rows").of_item(&format!("{id:?}"));
        match row(&id, context, found) {
            Ok((file, row, expr, measured)) => {
                let size = measured.size();
                share_of_zero(s, &format!("row {id}"), size);
                found.views.push(Some(file.sources.clone()));
                let view = found.views.len() - 1;
                let expr = Arc::new(expr.clone());
                let about = About {
                    label: id.clone(),
                    what: row.what.clone(),
                    unit: row.unit.clone(),
                    place,
                };
                let observable = Observable::Expression { view, expr };
                found
                    .observations
                    .push(observation(about, measured, sd(size), observable));
                found.rows.push(id);
            }
            Err((message, hint)) => {
                let allowed = "rows that compute a number";
                let problem = problem(&place, "rows", allowed, message, &hint);
                s.report_problem(problem.value(format!("{id:?}")));
            }
        }
    }
}

/// A validation row that gives a number, or message and hint.
fn row<'a>(
    id: &String,
    context: &Context<'a>,
    found: &Found,
) -> Result<(&'a RowFile, &'a ValidationRow, &'a Expr, Measured), (String, String)> {
    let all = || {
        let files = context.rows.iter();
        files.flat_map(|file| file.rows.iter().map(move |row| (file, row)))
    };
    let refuse = |message: String, hint: &str| Err((message, hint.to_owned()));
    let Some((file, row)) = all().find(|(_, row)| row.id == *id) else {
        let hint = did_you_mean(id, all().map(|(_, row)| row.id.as_str()))
            .unwrap_or_else(|| "`cvtcycle validate` lists them".to_owned());
        return Err((format!("there is no validation row `{id}`"), hint));
    };
    let (Some(expr), Some(Printed::Range(low, high))) = (&row.compute, row.printed) else {
        return refuse(
            format!("row {id} computes no number"),
            "an order or a sign has no residual: write its margin as a `compute` of your own",
        );
    };
    if expr.gives() != Gives::Number {
        return refuse(
            format!("row {id} computes a range"),
            "write its ends as `compute = \"min(...)\"` and `\"max(...)\"`",
        );
    }
    if found.rows.contains(id) {
        return refuse(format!("row {id} is there twice"), "remove one");
    }
    Ok((file, row, expr, Measured::between(low, high)))
}

/// An expression of the plan's own.
fn statement(s: &Section, context: &Context, found: &mut Found) {
    let text = s.text(
        "compute",
        "expression over the sources; docs/validation_format.md",
    );
    let unit = s.text_or("unit", "-", "unit of measured and computed numbers");
    let meaning = s.text_or("what", "", "what it is");
    let measured = number_or_range(s, "measured");
    if measured.is_none() {
        let hint = "add `value`, or `low` and `high`";
        s.complain(
            "value",
            "value, or low and high",
            "nothing was measured",
            hint,
        );
    }
    let (low, high) = measured.unwrap_or((f64::NAN, f64::NAN));
    let measured = Measured::between(low, high);
    let size = measured.size();
    let sd = sd_of(s)(size);
    share_of_zero(s, "the number", size);
    let names = FileNames {
        sources: context.sources,
        keys: context.keys,
    };
    let Some(expr) = expression(s, "compute", &text, &names) else {
        return;
    };
    if expr.gives() != Gives::Number {
        let hint =
            "write a range as `min(...)` and `max(...)`, an order as a difference with `low = 0`";
        s.complain(
            "compute",
            "a number",
            "`compute` gives no single number",
            hint,
        );
        return;
    }
    found.views.push(None);
    let label = s.text_or("name", "", "name of the group");
    let about = About {
        label,
        what: meaning,
        unit,
        place: s.place("compute"),
    };
    found.observations.push(observation(
        about,
        measured,
        sd,
        Observable::Expression {
            view: 0,
            expr: Arc::new(expr),
        },
    ));
}
