//! Problems of options.

use cvtcycle::config::Problem;

/// A problem of an option or argument.
pub fn problem(option: &str, message: &str, hint: &str) -> Problem {
    Problem::invalid(message)
        .in_file(option)
        .key(option)
        .hint(hint)
}

/// A problem of the value of an option, with the allowed values.
pub fn bad_value(option: &str, value: &str, allowed: &str, message: &str, hint: &str) -> Problem {
    problem(option, message, hint).value(value).allowed(allowed)
}

/// A question for the known names that are similar to the given one; empty if there are none.
pub fn did_you_mean(value: &str, known: &[&str]) -> String {
    cvtcycle::config::did_you_mean(value, known.iter().copied()).unwrap_or_default()
}
