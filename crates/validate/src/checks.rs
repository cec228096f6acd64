//! Expressions of a row, and keys that depend on each other.

use super::expr::{Expr, Fault, Gives, Names, parse};
use super::keys::ROW;
use super::rows::ValidationRow;
use super::rule::{Fleet, Printed, Verdict};
use super::source::{Kind, Source};
use super::tables;
use cvtcycle_config::ProblemKind;
use cvtcycle_config::ProblemKind::{Conflict, Missing};
use cvtcycle_config::setup::catalogue;
use cvtcycle_config::{Place, Problem, Section};
use cvtcycle_model::keys::{Key, Values};

/// Allowed keys of a number or range together.
const VALUE_OR_ENDS: &str = "value, or low and high";

/// A number or range: `value`, or `low` and `high`, of which one may be absent.
pub fn number_or_range(s: &Section, keys: [&Key<'static>; 3]) -> Option<(f64, f64)> {
    let [value, low, high] = keys.map(|key| s.optional(key));
    if value.is_some() && (low.is_some() || high.is_some()) {
        let message = "`value` with `low` or `high`";
        s.complain_by_name(
            ProblemKind::Conflict,
            "value",
            VALUE_OR_ENDS,
            message,
            "keep one of the forms",
        );
    }
    if low.zip(high).is_some_and(|(low, high)| low > high) {
        let message = "`low` is above `high`";
        s.complain_by_name(
            ProblemKind::Conflict,
            "low",
            "at most `high`",
            message,
            "swap them",
        );
    }
    let (least, largest) = (f64::NEG_INFINITY, f64::INFINITY);
    match value {
        Some(x) => Some((x, x)),
        None if low.is_none() && high.is_none() => None,
        None => Some((low.unwrap_or(least), high.unwrap_or(largest))),
    }
}

/// The printed numbers. Of an expression that is `broken` the kind of result is not known.
pub fn printed(s: &Section, compute: Option<&Expr>, broken: bool) -> Option<Printed> {
    let numbers = number_or_range(s, [&ROW.value, &ROW.low, &ROW.high]);
    let numbers = numbers.map(|(low, high)| Printed::Range(low, high));
    let numbers = match fleet(s) {
        Some(_) if numbers.is_some() => {
            let message = "a fleet with `value`, `low` or `high`";
            s.conflict(
                "mean",
                "mean, sd and n alone",
                message,
                "keep one of the forms",
            );
            numbers
        }
        found => found.map(Printed::Fleet).or(numbers),
    };
    let expect = s.has("expect").then(|| s.flag(&ROW.expect));
    match (compute.map(Expr::gives), numbers) {
        (Some(Gives::Truth), Some(_)) => {
            let message = "`compute` gives yes or no, but a number is printed";
            s.complain_by_name(
                ProblemKind::Conflict,
                "compute",
                "a number or a range",
                message,
                "compute the number",
            );
            None
        }
        (Some(Gives::Truth), None) => Some(Printed::Truth(expect.unwrap_or(true))),
        (Some(_), None) => {
            let message = "`compute` gives a number, but none is printed";
            s.missing(
                "value",
                VALUE_OR_ENDS,
                message,
                "add `value`, `low` or `high`",
            );
            None
        }
        (Some(_), numbers) => {
            if expect.is_some() {
                let message = "`expect` belongs to an order or sign";
                s.complain_by_name(ProblemKind::Conflict, "expect", "", message, "remove it");
            }
            numbers
        }
        (None, numbers) => numbers.filter(|_| broken),
    }
}

/// The fleet of a row of kind F; no other row has one.
fn fleet(s: &Section) -> Option<Fleet> {
    let [mean, sd, n] = [&ROW.mean, &ROW.sd, &ROW.n].map(|key| s.optional(key));
    let (any, is_fleet) = (mean.or(sd).or(n).is_some(), s.word(&ROW.kind) == "F");
    let z = s.number(&ROW.z);
    if any && !is_fleet {
        let message = "`mean`, `sd` and `n` belong to a fleet";
        s.conflict("kind", "F", message, "write kind = \"F\"");
    }
    if is_fleet && (mean.is_none() || sd.is_none() || n.is_none()) {
        let message = "a fleet needs `mean`, `sd` and `n`";
        s.missing("mean", "mean, sd and n", message, "take them from the data");
    }
    Some(Fleet {
        mean: mean?,
        sd: sd?,
        n: n?,
        z,
    })
}

/// Checks that a row has the parts that its keys imply.
pub fn complete(s: &Section, row: &ValidationRow) {
    let is = |verdict| row.recorded == Some(verdict);
    let is_computed = !row.compute_text.trim().is_empty();
    let is_compared = !is(Verdict::NotComparable);
    let is_fitted = !row.fitted_to.is_empty();
    let complain = |kind, found: bool, key: &str, allowed: &str, message: &str, hint: &str| {
        if found {
            s.complain(kind, key, allowed, message, hint);
        }
    };
    let found = !is_computed && is_compared;
    let message = "the row is not computed";
    let hint = "add an expression, or verdict = \"not comparable\" and a reason";
    complain(Missing, found, "compute", "an expression", message, hint);
    let found = is_computed && !is_compared;
    let message = "a computed row cannot be `not comparable`";
    let (allowed, hint) = (
        "agrees, fit, identity, differs",
        "remove `compute` or the verdict",
    );
    complain(Conflict, found, "verdict", allowed, message, hint);
    let found = (is(Verdict::Differs) || !is_compared) && row.reason.trim().is_empty();
    let (message, hint) = ("the verdict needs a reason", "say in a sentence why");
    complain(Missing, found, "reason", "a sentence", message, hint);
    let found = is(Verdict::Differs) && !s.has("cause");
    let message = "a row that differs needs its computed cause";
    let hint = "add a table `cause` with `what` and `compute`: a number that shows the reason";
    complain(Missing, found, "cause", "a table", message, hint);
    let found = is(Verdict::Fit) && !is_fitted;
    let message = "a fit names the parameters that were fitted to it";
    complain(
        Missing,
        found,
        "fitted_to",
        "keys of parameters",
        message,
        "",
    );
    let found = is(Verdict::Agrees) && is_fitted;
    let message = "a row to which a parameter was fitted never `agrees`";
    complain(
        Conflict,
        found,
        "verdict",
        "fit, differs",
        message,
        "record `fit`",
    );
}

/// Sources of a file, and the known keys.
pub struct FileNames<'a> {
    /// Sources of computed values.
    pub sources: &'a [Source],
}

impl Names for FileNames<'_> {
    fn sources(&self) -> Vec<&str> {
        self.sources.iter().map(|source| &*source.name).collect()
    }

    fn columns(&self, source: usize, totals: bool) -> Vec<&str> {
        match self.sources.get(source).map(|source| source.kind) {
            Some(kind) if kind == Kind::Run || !totals => tables::columns(kind, totals),
            _ => Vec::new(),
        }
    }

    fn keys(&self) -> &[String] {
        catalogue::known_names()
    }
}

/// Parses the expression of a key; its faults are reported as problems with their place in the text. None for an empty text.
pub fn expression(s: &Section, key: &str, text: &str, names: &FileNames) -> Option<Expr> {
    if text.trim().is_empty() {
        return None;
    }
    let report = |fault| s.report_problem(within(s.place(key), key, text, fault));
    let parsed = parse(text, names);
    parsed
        .map_err(|faults| faults.into_iter().for_each(report))
        .ok()
}

/// A fault in an expression as a problem at its place.
fn within(mut place: Place, key: &str, text: &str, fault: Fault) -> Problem {
    // The place is exact if the text is on one line without escapes.
    let quoted = place.line_text.chars().skip(place.column.saturating_sub(1));
    let quoted = quoted.collect::<String>();
    let unquoted = quoted.strip_prefix(['"', '\'']);
    if unquoted.is_some_and(|rest| rest.starts_with(text)) {
        place.column += 1 + fault.at;
        place.width = fault.width;
    }
    let hint = match fault.hint.as_str() {
        "" => "docs/validation_format.md shows what an expression may hold",
        hint => hint,
    };
    Problem::syntax(format!("`{key}`: {}", fault.message))
        .at(place)
        .key(key)
        .names_key()
        .value(fault.word)
        .hint(hint)
}
