//! Ranges of keys as numbers.

/// Parses the ends of an allowed range.
#[must_use]
pub fn range(allowed: &str) -> Option<(f64, f64)> {
    let words: Vec<&str> = allowed.split(' ').collect();
    let number = |at: usize| words.get(at).and_then(|word| word.parse::<f64>().ok());
    match words.as_slice() {
        ["integer", "from", ..] => Some((number(2)?, number(4)?)),
        ["above", ..] => Some((number(1)?.max(1e-3 * number(4)?), number(4)?)),
        [_, "to", ..] => Some((number(0)?, number(2)?)),
        _ => None,
    }
}
