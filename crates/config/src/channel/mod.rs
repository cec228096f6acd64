//! Channels of recordings: their quantities, names and units, and the repairs of a recording by name.

mod quantity;
mod repairs;

pub(crate) use quantity::is_identity;
pub use quantity::{Quantity, Unit};
pub use repairs::Repairs;

/// A text in lower case, its words joined by `_`; a sign alone stays as it is.
pub(crate) fn bare(text: &str) -> String {
    let lower = text.trim().to_lowercase();
    let is_letter = |c: char| c.is_alphanumeric() || c == '°';
    let words = lower.split(|c: char| !is_letter(c));
    let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
    match words.is_empty() {
        true => lower,
        false => words.join("_"),
    }
}
