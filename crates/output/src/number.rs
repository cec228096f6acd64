//! Numbers as text: exact for files, rounded for people.

use std::fmt::Write as _;

/// Text in place of a missing number in tables for people.
pub const NONE: &str = "-";

/// A number from here on is given with an exponent.
const MANY_FIGURES: f64 = 1e15;

/// Appends the shortest decimal that reads back to the same number, with an exponent below 1e-5 and from 1e16 on; `NaN`, `inf` and
/// `-inf` for what is not finite, zero without a sign.
pub fn push_exact(text: &mut String, x: f64) {
    let x = x + 0.0;
    let size = x.abs();
    // Writing into a String cannot fail.
    let done = if size <= 0.0 || !size.is_finite() || (1e-5..1e16).contains(&size) {
        write!(text, "{x}")
    } else {
        write!(text, "{x:e}")
    };
    debug_assert!(done.is_ok());
}

/// The text of [`push_exact`]; empty for a number that is not finite.
pub fn exact(x: f64) -> String {
    let mut text = String::new();
    if x.is_finite() {
        push_exact(&mut text, x);
    }
    text
}

/// A number, or none where it is not finite; zero without a sign.
pub fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x + 0.0)
}

/// A number with fixed decimals, without the sign of a rounded zero; [`NONE`] where there is none. From 1e15 on, where the figures
/// before the point are more than a number has, with an exponent.
///
/// ```
/// use cvtcycle_output::number::fixed;
/// assert_eq!([fixed(2.416, 2), fixed(-0.001, 2), fixed(None, 2)], ["2.42", "0.00", "-"]);
/// assert_eq!(fixed(1.234e300, 2), "1.23e300");
/// ```
pub fn fixed(x: impl Into<Option<f64>>, decimals: usize) -> String {
    let Some(x) = x.into().filter(|x| x.is_finite()) else {
        return NONE.to_owned();
    };
    if x.abs() >= MANY_FIGURES {
        return format!("{x:.2e}");
    }
    let text = format!("{x:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if !has_digits(digits) => digits.to_owned(),
        _ => text,
    }
}

/// A number with fixed decimals and its sign.
pub fn signed(x: impl Into<Option<f64>>, decimals: usize) -> String {
    let x = x.into();
    let text = fixed(x, decimals);
    if x.is_some_and(|x| x > 0.0) && has_digits(&text) {
        format!("+{text}")
    } else {
        text
    }
}

/// Whether a text has a digit other than zero.
fn has_digits(text: &str) -> bool {
    text.bytes().any(|b| (b'1'..=b'9').contains(&b))
}

/// A part as per cent of a whole.
pub fn percent(part: impl Into<Option<f64>>, whole: f64, decimals: usize) -> String {
    fixed(part.into().map(|part| part / whole * 100.0), decimals)
}

/// The shortest text of a number that the user gave.
pub fn plain(x: f64) -> String {
    format!("{}", if x.abs() > 0.0 { x } else { 0.0 })
}

/// A small error such as `3e-15`.
pub fn tiny(x: Option<f64>) -> String {
    match x {
        Some(x) if x.abs() > 0.0 => format!("{x:.0e}"),
        Some(_) => "0".to_owned(),
        None => NONE.to_owned(),
    }
}
