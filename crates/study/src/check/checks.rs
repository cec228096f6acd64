//! Keys of a row that depend on each other.

use super::expr::{Expr, Gives};
use super::keys::ROW;
use super::rows::ValidationRow;
use super::rule::{Printed, Verdict};
use cvtcycle_config::Section;
use cvtcycle_model::keys::{Key, Values};

/// What the keys of a number or range accept together.
const VALUE_OR_ENDS: &str = "value, or low and high";

/// A number or range: `value`, or `low` and `high`, of which one may be absent.
pub fn number_or_range(s: &Section, keys: [&Key; 3]) -> Option<(f64, f64)> {
    let [value, low, high] = keys.map(|key| s.optional(key));
    if value.is_some() && (low.is_some() || high.is_some()) {
        let message = "`value` with `low` or `high`";
        s.complain("value", VALUE_OR_ENDS, message, "keep one of the forms");
    }
    if low.zip(high).is_some_and(|(low, high)| low > high) {
        let message = "`low` is above `high`";
        s.complain("low", "at most `high`", message, "swap them");
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
    let expect = s.has("expect").then(|| s.flag(&ROW.expect));
    match (compute.map(Expr::gives), numbers) {
        (Some(Gives::Truth), Some(_)) => {
            let message = "`compute` gives yes or no, but a number is printed";
            s.complain(
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
            s.complain(
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
                s.complain("expect", "", message, "remove it");
            }
            numbers
        }
        (None, numbers) => numbers.filter(|_| broken),
    }
}

/// What a row needs besides its keys.
pub fn complete(s: &Section, row: &ValidationRow) {
    let is = |verdict| row.recorded == Some(verdict);
    let is_computed = !row.compute_text.trim().is_empty();
    let is_compared = !is(Verdict::NotComparable);
    let is_fitted = !row.fitted_to.is_empty();
    let complain = |found: bool, key: &str, allowed: &str, message: &str, hint: &str| {
        if found {
            s.complain(key, allowed, message, hint);
        }
    };
    let found = !is_computed && is_compared;
    let message = "the row is not computed";
    let hint = "add an expression, or verdict = \"not comparable\" and a reason";
    complain(found, "compute", "an expression", message, hint);
    let found = is_computed && !is_compared;
    let message = "a computed row cannot be `not comparable`";
    let (allowed, hint) = ("agrees, fit, differs", "remove `compute` or the verdict");
    complain(found, "verdict", allowed, message, hint);
    let found = (is(Verdict::Differs) || !is_compared) && row.reason.trim().is_empty();
    let (message, hint) = ("the verdict needs a reason", "say in a sentence why");
    complain(found, "reason", "a sentence", message, hint);
    let found = is(Verdict::Differs) && !s.has("cause");
    let message = "a row that differs needs its computed cause";
    let hint = "add a table `cause` with `what` and `compute`: a number that shows the reason";
    complain(found, "cause", "a table", message, hint);
    let found = is(Verdict::Fit) && !is_fitted;
    let message = "a fit names the parameters that were fitted to it";
    complain(found, "fitted_to", "keys of parameters", message, "");
    let found = is(Verdict::Agrees) && is_fitted;
    let message = "a row to which a parameter was fitted never `agrees`";
    complain(found, "verdict", "fit, differs", message, "record `fit`");
}
