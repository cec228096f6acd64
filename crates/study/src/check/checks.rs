//! Keys of a row that depend on each other.

use super::expr::{Expr, Gives};
use super::rows::ValidationRow;
use super::rule::{Printed, Verdict};
use cvtcycle_config::{Bound, Section, did_you_mean};

/// Pages of the book that a row may belong to.
pub const MECHANISMS: [&str; 28] = [
    "introduction",
    "belt",
    "solve",
    "geometry",
    "tension",
    "bands",
    "film",
    "slip",
    "deflection",
    "formulations",
    "pump",
    "input_shaft",
    "reverse_clutch",
    "final_drive",
    "launch",
    "ratio_control",
    "pressure",
    "manual",
    "lubricant",
    "engine",
    "road_load",
    "thermal",
    "maps",
    "ledgers",
    "rigs",
    "vehicle",
    "hydraulics",
    "user",
];

/// Kinds of statement.
pub const KINDS: [&str; 5] = ["N", "O", "C", "L", "X"];

/// Page of the book.
pub fn mechanism(s: &Section) -> String {
    s.word_or("mechanism", &MECHANISMS, "user", "page of the book")
        .to_owned()
}

/// The recorded verdict.
pub fn verdict(s: &Section) -> Option<Verdict> {
    let word = s.optional_text("verdict", "recorded verdict")?;
    let found = Verdict::from_word(&word);
    if found.is_none() {
        let hint = did_you_mean(&word, Verdict::WORDS).unwrap_or_default();
        s.complain(
            "verdict",
            &Verdict::WORDS.join(", "),
            &format!("there is no verdict `{word}`"),
            &hint,
        );
    }
    found
}

/// A number or range: `value`, or `low` and `high`, of which one may be absent.
pub fn number_or_range(s: &Section, kind: &str) -> Option<(f64, f64)> {
    let any = Bound::any();
    let value = s.optional_number("value", any, &format!("{kind} number"));
    let low = s.optional_number("low", any, &format!("smallest {kind} number"));
    let high = s.optional_number("high", any, &format!("largest {kind} number"));
    if value.is_some() && (low.is_some() || high.is_some()) {
        s.complain(
            "value",
            "value, or low and high",
            "`value` with `low` or `high`",
            "keep one of the forms",
        );
    }
    if let (Some(low), Some(high)) = (low, high)
        && low > high
    {
        s.complain(
            "low",
            "at most `high`",
            "`low` is above `high`",
            "swap them",
        );
    }
    match (value, low, high) {
        (Some(x), ..) => Some((x, x)),
        (None, None, None) => None,
        _ => Some((
            low.unwrap_or(f64::NEG_INFINITY),
            high.unwrap_or(f64::INFINITY),
        )),
    }
}

/// The printed numbers. Of an expression that is `broken` the kind of result is not known.
pub fn printed(s: &Section, compute: Option<&Expr>, broken: bool) -> Option<Printed> {
    let numbers = number_or_range(s, "printed").map(|(low, high)| Printed::Range(low, high));
    let expect = s.has("expect").then(|| {
        s.boolean_or(
            "expect",
            true,
            "whether the order or sign is printed as holding",
        )
    });
    match (compute.map(Expr::gives), numbers) {
        (Some(Gives::Truth), Some(_)) => {
            s.complain(
                "compute",
                "a number or a range",
                "`compute` gives yes or no, but a number is printed",
                "compute the number",
            );
            None
        }
        (Some(Gives::Truth), None) => Some(Printed::Truth(expect.unwrap_or(true))),
        (Some(_), None) => {
            s.complain(
                "value",
                "value, or low and high",
                "`compute` gives a number, but none is printed",
                "add `value`, `low` or `high`",
            );
            None
        }
        (Some(_), numbers) => {
            if expect.is_some() {
                s.complain(
                    "expect",
                    "",
                    "`expect` belongs to an order or sign",
                    "remove it",
                );
            }
            numbers
        }
        (None, numbers) => numbers.filter(|_| broken),
    }
}

/// What a row needs besides its keys.
pub fn complete(s: &Section, row: &ValidationRow) {
    let bare = row.compute_text.trim().is_empty();
    let compared = row.recorded != Some(Verdict::NotComparable);
    if bare && compared {
        let hint = "add an expression, or verdict = \"not comparable\" and a reason";
        s.complain("compute", "an expression", "the row is not computed", hint);
    }
    if !bare && !compared {
        s.complain(
            "verdict",
            "agrees, fit, differs",
            "a computed row cannot be `not comparable`",
            "remove `compute` or the verdict",
        );
    }
    let needs = matches!(
        row.recorded,
        Some(Verdict::Differs | Verdict::NotComparable)
    );
    if needs && row.reason.trim().is_empty() {
        s.complain(
            "reason",
            "a sentence",
            "the verdict needs a reason",
            "say in a sentence why",
        );
    }
    if row.recorded == Some(Verdict::Differs) && !s.has("cause") {
        let hint = "add a table `cause` with `what` and `compute`: a number that shows the reason";
        s.complain(
            "cause",
            "a table",
            "a row that differs needs its computed cause",
            hint,
        );
    }
    if row.recorded == Some(Verdict::Fit) && row.fitted_to.is_empty() {
        s.complain(
            "fitted_to",
            "keys of parameters",
            "a fit names the parameters that were fitted to it",
            "",
        );
    }
    if row.recorded == Some(Verdict::Agrees) && !row.fitted_to.is_empty() {
        s.complain(
            "verdict",
            "fit, differs",
            "a row to which a parameter was fitted never `agrees`",
            "record `fit`",
        );
    }
}
