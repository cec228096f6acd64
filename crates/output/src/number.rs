//! Formats numbers: exactly for files, rounded for people.

use std::fmt::Write as _;

/// Placeholder for a missing number in tables for people.
pub const NONE: &str = "-";

/// Exact numbers below this have an exponent.
const SMALL: f64 = 1e-5;
/// Exact numbers from this on have an exponent.
const LARGE: f64 = 1e16;

/// Rounded numbers from this on have an exponent.
const MANY_FIGURES: f64 = 1e15;

/// Appends the shortest decimal that reads back to the same number, with an exponent below 1e-5 and from 1e16 on. Values that are not finite
/// become `NaN`, `inf` and `-inf`; zero has no sign.
pub fn push_exact(text: &mut String, x: f64) {
    let x = x + 0.0;
    let size = x.abs();
    if let Some(whole) = whole(x) {
        push_whole(text, whole);
        return;
    }
    if has_one_nearest(x) {
        push_digits(text, x);
        return;
    }
    // Writing into a String cannot fail.
    let done = match size <= 0.0 || !size.is_finite() || (SMALL..LARGE).contains(&size) {
        true => write!(text, "{x}"),
        false => write!(text, "{x:e}"),
    };
    debug_assert!(done.is_ok());
}

/// Appends the text of `{x}`: the shortest decimal that reads back to the same number, without an exponent.
pub fn push_plain(text: &mut String, x: f64) {
    if let Some(whole) = whole(x) {
        push_whole(text, whole);
        return;
    }
    if x.abs() >= SMALL && has_one_nearest(x) {
        push_digits(text, x);
        return;
    }
    let done = write!(text, "{x}");
    debug_assert!(done.is_ok());
}

/// Appends the text of `{x:?}`: as [`push_plain`], with a point in whole numbers, and with an exponent below 1e-4 and from 1e16 on.
pub fn push_debug(text: &mut String, x: f64) {
    let size = x.abs();
    if let Some(whole) = whole(x) {
        push_whole(text, whole);
        text.push_str(".0");
    } else if (10.0 * SMALL..LARGE).contains(&size) && has_one_nearest(x) {
        text.push_str(zmij::Buffer::new().format_finite(x));
    } else {
        // Writing into a String cannot fail.
        let done = write!(text, "{x:?}");
        debug_assert!(done.is_ok());
    }
}

/// Converts a whole, non-negative number that fits; `None` for negative zero.
fn whole(x: f64) -> Option<u32> {
    let whole = x as u32;
    (f64::from(whole).to_bits() == x.to_bits()).then_some(whole)
}

fn push_whole(text: &mut String, mut whole: u32) {
    let mut digits = [b'0'; 10];
    let mut at = digits.len();
    loop {
        at -= 1;
        digits[at] += (whole % 10) as u8;
        whole /= 10;
        if whole == 0 {
            break;
        }
    }
    text.extend(digits[at..].iter().map(|digit| char::from(*digit)));
}

/// Tests that no two shortest decimals can be equally near to a number; on such ties `zmij` takes the even one and the standard library the
/// larger. A number half-way between two decimals of k - 1 places is a multiple of 2^-k. Decimals of k - 2 places are too coarse for its last
/// bit 2^-m, those of k - 1 are not: (m - k) >= 0.69 m - 2, which below 2^40, where m >= 12, are six bits of zero at its end.
fn has_one_nearest(x: f64) -> bool {
    const LAST_BITS: u64 = 0x3f;
    x.to_bits() & LAST_BITS != 0 && x.abs() < (1_u64 << 40) as f64
}

/// Appends a number with a unique nearest shortest decimal, with an exponent below [`SMALL`]: the digits of `{x}` in a third of the time.
fn push_digits(text: &mut String, x: f64) {
    let mut digits = zmij::Buffer::new();
    let digits = digits.format_finite(x);
    text.push_str(digits.strip_suffix(".0").unwrap_or(digits));
}

/// Text of [`push_exact`]; empty for a number that is not finite.
pub fn exact(x: f64) -> String {
    let mut text = String::new();
    if x.is_finite() {
        push_exact(&mut text, x);
    }
    text
}

/// `None` unless finite; zero without a sign.
pub fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x + 0.0)
}

/// Formats with fixed decimals, without the sign of a rounded zero; [`NONE`] for a missing number. From 1e15 on, beyond the precision of an
/// `f64`, with an exponent.
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

/// Formats with fixed decimals and sign.
pub fn signed(x: impl Into<Option<f64>>, decimals: usize) -> String {
    let x = x.into();
    let text = fixed(x, decimals);
    if x.is_some_and(|x| x > 0.0) && has_digits(&text) {
        format!("+{text}")
    } else {
        text
    }
}

/// Tests for a digit other than zero.
fn has_digits(text: &str) -> bool {
    text.bytes().any(|b| (b'1'..=b'9').contains(&b))
}

/// Formats a part as per cent of a whole.
pub fn percent(part: impl Into<Option<f64>>, whole: f64, decimals: usize) -> String {
    fixed(part.into().map(|part| part / whole * 100.0), decimals)
}

/// Formats a user's number as the shortest text.
pub fn plain(x: f64) -> String {
    format!("{}", if x.abs() > 0.0 { x } else { 0.0 })
}

/// Formats a small error such as `3e-15`.
pub fn tiny(x: Option<f64>) -> String {
    match x {
        Some(x) if x.abs() > 0.0 => format!("{x:.0e}"),
        Some(_) => "0".to_owned(),
        None => NONE.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the standard library's digits. Covers bit patterns of all kinds, then numbers of tables: few decimals, any size.
    #[test]
    fn digits_equal_those_of_the_standard_library() {
        let ends = [
            0.0,
            -0.0,
            1.0,
            10.0,
            1e9,
            4_294_967_295.0,
            SMALL,
            LARGE,
            5e-324,
            f64::MAX,
            f64::NAN,
        ];
        let ends = ends
            .into_iter()
            .flat_map(|x: f64| [x, -x, x.next_down(), x + 1.0]);
        let bits = |k: u64| k.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let any = (0..200_000).map(|k| f64::from_bits(bits(k)));
        let sized = |k: u64| (bits(k) >> 40) as f64 * 10_f64.powi((k % 40) as i32 - 24);
        // Few bits give numbers half-way between two decimals, where the two differ.
        let halved = |k: u64| (bits(k) >> (24 + k % 20)) as f64 / (1_u64 << (k % 24)) as f64;
        let numbers = ends.chain(any).chain((0..200_000).map(sized));
        for x in numbers.chain((0..400_000).map(halved)) {
            let (mut text, mut plain) = (String::new(), String::new());
            push_exact(&mut text, x);
            push_plain(&mut plain, x);
            assert_eq!(plain, format!("{x}"));
            plain.clear();
            push_debug(&mut plain, x);
            assert_eq!(plain, format!("{x:?}"));
            let size = x.abs();
            let with_exponent = size > 0.0 && size.is_finite() && !(SMALL..LARGE).contains(&size);
            match with_exponent {
                true => assert_eq!(text, format!("{x:e}")),
                false => assert_eq!(text, format!("{}", x + 0.0)),
            }
        }
    }
}
