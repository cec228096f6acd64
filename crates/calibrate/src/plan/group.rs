//! One `[[data]]` of a plan, and its observations.

use std::sync::Arc;

use super::files;
use super::keys::DATA;
use super::{Context, Found, Group, Measured, Observable, Observation, problem};
use cvtcycle_config::ProblemKind::{Conflict, Duplicate, Missing, WrongType};
use cvtcycle_config::{Document, Problem, Problems, Reader, Section, did_you_mean};
use cvtcycle_model::keys::Values;
use cvtcycle_validate::checks::expression;
use cvtcycle_validate::checks::number_or_range;
use cvtcycle_validate::expr::{Expr, Gives};
use cvtcycle_validate::rows::ValidationRow;
use cvtcycle_validate::rule::Printed;

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
    let way = ways.first().copied();
    let name = Values::text_or(&s, &DATA.name, way.unwrap_or("data"));
    let group = Group {
        name: name.clone(),
        from: Values::text(&s, &DATA.from),
        common_sd: s.optional(&DATA.common_sd),
        place: s.place("name"),
    };
    let fold = Values::text_or(&s, &DATA.fold, &name);
    let mut found = Found {
        group,
        ..Found::default()
    };
    match ways.as_slice() {
        ["rows"] => rows(&s, context, &mut found),
        ["compute"] => statement(&s, context, &mut found),
        [way] => files::read(&s, way, context, &mut found),
        [] => {
            let hint = "give `rows`, `compute`, `points`, `trace` or `scalars`";
            let message = "the group has no data".to_owned();
            s.report_problem(problem(
                Missing,
                &s.place("rows"),
                "",
                &WAYS.join(", "),
                message,
                hint,
            ));
        }
        [.., last] => {
            let message = format!("{} in one group", ways.join(" and "));
            s.conflict(last, "one of them", &message, "write a [[data]] for each");
            // Which keys belong to it is not known.
            s.pass_over();
        }
    }
    if found.folds.is_empty() {
        found.folds = vec![fold; found.observations.len()];
    }
    let place = s.place(way.unwrap_or_default());
    // The problem of another file has that file's place.
    let in_group = |problem: Problem| match problem.place.file_name() == Some(context.file) {
        true => problem.with_context(&format!("data `{name}`: ")),
        false => problem,
    };
    reader.finish().map_err(|problems| problems.map(in_group))?;
    if found.observations.is_empty() {
        let way = way.unwrap_or_default();
        let hint = match way {
            "rows" => "name at least one row; `cvtcycle validate` lists them",
            "compute" => "write an expression over the sources; docs/validation_format.md",
            _ => "name a CSV file, relative to the plan, and fill the cells of what was measured",
        };
        let message = "there is no measured number in it".to_owned();
        let nothing = problem(
            Missing,
            &place,
            way,
            "at least one measured number",
            message,
            hint,
        );
        return Err(in_group(nothing).into());
    }
    Ok(found)
}

/// The standard deviation that a whole group has: `sd`, or a share of what was measured.
fn sd_of(s: &Section) -> impl Fn(f64) -> f64 {
    let (absolute, share) = (s.optional(&DATA.sd), s.optional(&DATA.sd_share));
    let (allowed, both) = ("`sd` or `sd_share`", "`sd` with `sd_share`");
    match (absolute, share) {
        (Some(_), Some(_)) => {
            s.complain_by_name(Conflict, "sd_share", allowed, both, "keep one of them");
        }
        (None, None) => {
            let message = "the data have no standard deviation";
            let hint = "how far may a repeated measurement be off? give that as `sd`";
            s.missing("sd", allowed, message, hint);
        }
        _ => {}
    }
    let of_share = move |x: f64| share.map(|share| share * x.abs());
    move |x: f64| absolute.or(of_share(x)).unwrap_or(f64::NAN)
}

/// Reports a share of a number of 0, which leaves no standard deviation.
fn share_of_zero(s: &Section, what: &str, size: f64) {
    // Only 0: a small number has a small deviation.
    if s.has("sd_share") && size.abs() < f64::MIN_POSITIVE {
        let message =
            format!("{what} is 0, or a range about 0: no share of it is a standard deviation");
        let hint = "give `sd` in the unit of the data";
        s.conflict("sd_share", "for numbers other than 0", &message, hint);
    }
}

/// Printed numbers of the program's own validation rows.
fn rows(s: &Section, context: &Context, found: &mut Found) {
    let ids = s.texts(&DATA.rows);
    let sd = sd_of(s);
    for id in ids {
        let place = s.place("rows").of_item(&format!("{id:?}"));
        match row(&id, context, found) {
            Ok((view, row, expr, measured)) => {
                let size = measured.size();
                share_of_zero(s, &format!("row {id}"), size);
                let expr = Arc::new(expr.clone());
                let observable = Observable::Expression { view, expr };
                found.observations.push(Observation {
                    what: row.what.clone(),
                    unit: row.unit.clone(),
                    place,
                    ..Observation::new(id.clone(), measured, sd(size), observable)
                });
                found.rows.push(id);
            }
            Err(problem) => s.report_problem(
                problem
                    .at(place)
                    .key("rows")
                    .value(format!("{id:?}"))
                    .allowed("rows that compute a number"),
            ),
        }
    }
}

/// A validation row that gives a number, with the index of its list of sources; or what is wrong.
fn row<'a>(
    id: &String,
    context: &Context<'a>,
    found: &Found,
) -> Result<(usize, &'a ValidationRow, &'a Expr, Measured), Problem> {
    let files = context.rows.iter().enumerate();
    let mut all = files.flat_map(|(k, file)| file.rows.iter().map(move |row| (k + 1, row)));
    let refuse = |kind, message: &str, hint: &str| {
        Err(Problem::new(kind, format!("row {id} {message}")).hint(hint))
    };
    let Some((view, row)) = all.find(|(_, row)| row.id == *id) else {
        let known = context.rows.iter().flat_map(|file| &file.rows);
        let hint = did_you_mean(id, known.map(|row| &*row.id))
            .unwrap_or_else(|| "`cvtcycle validate` lists them".to_owned());
        let message = format!("there is no validation row `{id}`");
        return Err(Problem::unknown_name(message).hint(hint));
    };
    let (Some(expr), Some(Printed::Range(low, high))) = (&row.compute, row.printed) else {
        let hint =
            "an order or a sign has no residual: write its margin as a `compute` of your own";
        return refuse(WrongType, "computes no number", hint);
    };
    if expr.gives() != Gives::Number {
        let hint = "write its ends as `compute = \"min(...)\"` and `\"max(...)\"`";
        return refuse(WrongType, "computes a range", hint);
    }
    if found.rows.contains(id) {
        return refuse(Duplicate, "is there twice", "remove one");
    }
    Ok((view, row, expr, Measured::between(low, high)))
}

/// An expression of the plan's own.
fn statement(s: &Section, context: &Context, found: &mut Found) {
    let text = Values::text(s, &DATA.compute);
    let (unit, what) = (Values::text(s, &DATA.unit), Values::text(s, &DATA.what));
    let measured = number_or_range(s, [&DATA.value, &DATA.low, &DATA.high]);
    if measured.is_none() {
        let hint = "add `value`, or `low` and `high`";
        let allowed = "value, or low and high";
        s.missing("value", allowed, "nothing was measured", hint);
    }
    let (low, high) = measured.unwrap_or((f64::NAN, f64::NAN));
    let measured = Measured::between(low, high);
    let size = measured.size();
    let sd = sd_of(s)(size);
    share_of_zero(s, "the number", size);
    let Some(expr) = expression(s, "compute", &text, context.names) else {
        return;
    };
    if expr.gives() != Gives::Number {
        let message = "`compute` gives no single number";
        let hint =
            "write a range as `min(...)` and `max(...)`, an order as a difference with `low = 0`";
        s.complain_by_name(WrongType, "compute", "a number", message, hint);
        return;
    }
    let label = if s.has("name") {
        found.group.name.clone()
    } else {
        String::new()
    };
    let expr = Arc::new(expr);
    let observable = Observable::Expression { view: 0, expr };
    found.observations.push(Observation {
        what,
        unit,
        place: s.place("compute"),
        ..Observation::new(label, measured, sd, observable)
    });
}
