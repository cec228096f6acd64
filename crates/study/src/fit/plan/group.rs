//! One `[[data]]` of a plan, and its observations.

use std::sync::Arc;

use super::files::{self, Made};
use super::{Group, Measured, Observation, What, at_item, problem};
use crate::check::expr::{Expr, Gives, parse};
use crate::check::names::FileNames;
use crate::check::source::Source;
use crate::check::{File, Printed, within};
use cvtcycle_config::{Bound, Document, Place, Problem, Problems, Reader, Section, near};

/// Ways to give data, just one of which a group has.
const WAYS: [&str; 5] = ["rows", "compute", "points", "trace", "scalars"];

/// What the groups of a plan look at.
pub(super) struct Around<'a> {
    /// The plan's own sources, then the common ones.
    pub sources: &'a [Source],
    /// Known keys.
    pub keys: &'a [String],
    /// Validation rows of the program.
    pub rows: &'a [File],
    /// The plan, as problems cite it.
    pub file: &'a str,
}

/// What a group gives; views, benches and runs are counted within it.
#[derive(Default)]
pub(super) struct Found {
    pub group: Option<Group>,
    /// Fold of each observation by name.
    pub folds: Vec<String>,
    pub observations: Vec<Observation>,
    /// Lists of sources: none stands for the plan's own.
    pub views: Vec<Option<Vec<Source>>>,
    pub made: Made,
    pub rows: Vec<String>,
}

/// Reads a group.
///
/// # Errors
/// All its problems.
pub(super) fn read(document: &Document, around: &Around) -> Result<Found, Problems> {
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
        ["rows"] => rows(&s, around, &mut found),
        ["compute"] => statement(&s, around, &mut found),
        [way] => files::read(&s, way, around, &mut found),
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
            Err(told(nothing, &name, around.file).into())
        }
        Ok(_) => Ok(found),
        Err(problems) => Err(problems
            .into_iter()
            .map(|p| told(p, &name, around.file))
            .collect()),
    }
}

/// A problem under the name of its group.
fn told(problem: Problem, name: &str, plan: &str) -> Problem {
    // What stands in another file says so itself.
    if problem.place.file != plan {
        return problem;
    }
    let hint = problem.hint.replace("the top of the file", "its [[data]]");
    problem.with_context(&format!("data `{name}`: ")).hint(hint)
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
            "`sd` beside `sd_share`",
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
fn share_of_nothing(s: &Section, what: &str, size: f64) {
    // Just 0: a small number has a small deviation, as was asked for.
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
fn rows(s: &Section, around: &Around, found: &mut Found) {
    let ids = s.texts("rows", "identifiers of validation rows");
    let sd = sd_of(s);
    let all = || {
        around
            .rows
            .iter()
            .flat_map(|file| file.rows.iter().map(move |row| (file, row)))
    };
    for id in ids {
        let place = at_item(s.place("rows"), &format!("{id:?}"));
        let complain = |message: String, hint: &str| {
            let value = format!("{id:?}");
            s.report_problem(
                problem(&place, "rows", "rows that compute a number", message, hint).value(value),
            );
        };
        let Some((file, row)) = all().find(|(_, row)| row.id == id) else {
            let close = near(&id, all().map(|(_, row)| row.id.as_str()));
            let hint = if close.is_empty() {
                "`cvtcycle validate` lists them".to_owned()
            } else {
                format!("did you mean {}?", close.join(" or "))
            };
            complain(format!("there is no validation row `{id}`"), &hint);
            continue;
        };
        let (Some(expr), Some(Printed::Range(low, high))) = (&row.compute, row.printed) else {
            complain(
                format!("row {id} computes no number"),
                "an order or a sign has no residual: write its margin as a `compute` of your own",
            );
            continue;
        };
        if expr.gives() != Gives::Number {
            complain(
                format!("row {id} computes a range"),
                "write its ends as `compute = \"min(...)\"` and `\"max(...)\"`",
            );
            continue;
        }
        if found.rows.contains(&id) {
            complain(format!("row {id} stands twice"), "remove one");
            continue;
        }
        let measured = if low < high {
            Measured::Within(low, high)
        } else {
            Measured::Value(low)
        };
        // Of a range the end that the print gives counts.
        let size = if low.is_finite() && high.is_finite() {
            f64::midpoint(low, high)
        } else if low.is_finite() {
            low
        } else {
            high
        };
        share_of_nothing(s, &format!("row {id}"), size);
        found.views.push(Some(file.sources.clone()));
        let view = found.views.len() - 1;
        let about = About {
            label: id.clone(),
            what: row.what.clone(),
            unit: row.unit.clone(),
            place,
        };
        found.observations.push(observation(
            about,
            measured,
            sd(size),
            What::Expression {
                view,
                expr: Arc::new(expr.clone()),
            },
        ));
        found.rows.push(id);
    }
}

/// What a reader sees of an observation.
pub(super) struct About {
    pub label: String,
    pub what: String,
    pub unit: String,
    pub place: Place,
}

/// An observation of the group that is read.
pub(super) fn observation(
    about: About,
    measured: Measured,
    sd: f64,
    what_computed: What,
) -> Observation {
    let About {
        label,
        what,
        unit,
        place,
    } = about;
    Observation {
        group: 0,
        fold: 0,
        label,
        what,
        column: String::new(),
        unit,
        measured,
        sd,
        weight_sd: sd,
        what_computed,
        place,
    }
}

/// An expression of the plan's own.
fn statement(s: &Section, around: &Around, found: &mut Found) {
    let text = s.text(
        "compute",
        "expression over the sources; docs/validation_format.md",
    );
    let unit = s.text_or("unit", "-", "unit of measured and computed numbers");
    let meaning = s.text_or("what", "", "what it is");
    let any = Bound::any();
    let value = s.optional_number("value", any, "measured number");
    let (low, high) = (
        s.optional_number("low", any, "least measured number"),
        s.optional_number("high", any, "largest measured number"),
    );
    let measured = match (value, low, high) {
        (Some(x), None, None) => Measured::Value(x),
        (None, None, None) => {
            s.complain(
                "value",
                "value, or low and high",
                "nothing was measured",
                "add `value`, or `low` and `high`",
            );
            Measured::Value(f64::NAN)
        }
        (Some(_), ..) => {
            s.complain(
                "value",
                "value, or low and high",
                "`value` beside `low` or `high`",
                "keep one of the forms",
            );
            Measured::Value(f64::NAN)
        }
        (None, low, high) => {
            let (low, high) = (
                low.unwrap_or(f64::NEG_INFINITY),
                high.unwrap_or(f64::INFINITY),
            );
            if low > high {
                s.complain(
                    "low",
                    "at most `high`",
                    "`low` is above `high`",
                    "swap them",
                );
            }
            Measured::Within(low, high)
        }
    };
    let size = match measured {
        Measured::Value(x) => x,
        Measured::Within(low, high) if low.is_finite() && high.is_finite() => {
            f64::midpoint(low, high)
        }
        Measured::Within(low, high) => {
            if low.is_finite() {
                low
            } else {
                high
            }
        }
    };
    let sd = sd_of(s)(size);
    share_of_nothing(s, "the number", size);
    let Some(expr) = expression(s, &text, around) else {
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
        What::Expression {
            view: 0,
            expr: Arc::new(expr),
        },
    ));
}

fn expression(s: &Section, text: &str, around: &Around) -> Option<Expr> {
    if text.trim().is_empty() {
        return None;
    }
    match parse(
        text,
        &FileNames {
            sources: around.sources,
            keys: around.keys,
        },
    ) {
        Ok(expr) => Some(expr),
        Err(faults) => {
            faults.into_iter().for_each(|fault| {
                s.report_problem(within(s.place("compute"), "compute", text, fault))
            });
            None
        }
    }
}
