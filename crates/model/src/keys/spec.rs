//! Makers of rows: kind and presence.

use super::{Bound, Choice, Column, Kind, Presence};

/// Kind and presence of a key.
pub type Spec = (Kind<'static>, Presence<'static>);

/// A required number from `low` to `high`.
pub const fn number(low: f64, high: f64) -> Spec {
    (Kind::Number(Bound::closed(low, high)), Presence::Required)
}

/// A required number above `low`, up to `high`.
pub const fn above(low: f64, high: f64) -> Spec {
    (Kind::Number(Bound::open_low(low, high)), Presence::Required)
}

/// A required text.
pub const fn text() -> Spec {
    (Kind::Text, Presence::Required)
}

/// A required name of a CSV file.
pub const fn csv() -> Spec {
    (Kind::Csv, Presence::Required)
}

/// True or false, with a default.
pub const fn flag(default: bool) -> Spec {
    (Kind::Flag, Presence::Flag(default))
}

/// An integer with a default.
pub const fn integer(low: i64, high: i64, default: i64) -> Spec {
    (Kind::Integer(low, high), Presence::Integer(default))
}

/// One of some words, with a default.
pub const fn words(choices: &'static [Choice], default: &'static str) -> Spec {
    (Kind::Words(choices), Presence::Word(default))
}

/// One of some tables, required.
pub const fn options(choices: &'static [Choice]) -> Spec {
    (Kind::Options(choices), Presence::Required)
}

/// A list of texts, empty where it is absent.
pub const fn texts() -> Spec {
    (Kind::Texts, Presence::Optional)
}

/// A required text, of which the function says which ones are known.
pub const fn name(known: fn() -> String) -> Spec {
    (Kind::Name(known), Presence::Required)
}

/// A required list of values of this kind; the text says of what.
pub const fn list_of(item: &'static Kind<'static>, what: &'static str) -> Spec {
    (Kind::List(item, what), Presence::Required)
}

/// A required value of any of these kinds.
pub const fn either(kinds: &'static [Kind<'static>]) -> Spec {
    (Kind::Either(kinds), Presence::Required)
}

/// Required numbers from `low` to `high`: one, a list or a range `"from..to:step"`.
#[must_use]
pub const fn grid(low: f64, high: f64) -> Spec {
    (Kind::Grid(Bound::closed(low, high)), Presence::Required)
}

/// A required list of numbers from `low` to `high`.
pub const fn list(low: f64, high: f64, least: usize, most: usize) -> Spec {
    (
        Kind::Numbers(Bound::closed(low, high), least, most),
        Presence::Required,
    )
}

/// A required number in a stated range.
pub const fn within(range: Bound) -> Spec {
    (Kind::Number(range), Presence::Required)
}

/// A required list of numbers in a stated range.
pub const fn numbers(each: Bound, least: usize, most: usize) -> Spec {
    (Kind::Numbers(each, least, most), Presence::Required)
}

/// Required rows.
pub const fn rows(columns: &'static [Column<'static>]) -> Spec {
    (Kind::Rows(columns), Presence::Required)
}

/// With a default number, in the key's unit.
pub const fn or(default: f64, spec: Spec) -> Spec {
    (spec.0, Presence::Number(default))
}

/// With a default option.
pub const fn or_word(default: &'static str, spec: Spec) -> Spec {
    (spec.0, Presence::Word(default))
}

/// May be absent.
pub const fn optional(spec: Spec) -> Spec {
    (spec.0, Presence::Optional)
}

/// With a default that follows from other values.
pub const fn computed(words: &'static str, spec: Spec) -> Spec {
    (spec.0, Presence::Computed(words))
}

/// Required on a condition.
pub const fn required_if(words: &'static str, spec: Spec) -> Spec {
    (spec.0, Presence::RequiredIf(words))
}
