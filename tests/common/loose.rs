//! Reads values without a table of keys: name, range and meaning are arguments.

use std::ops::RangeInclusive;

use cvtcycle_config::Section;
use cvtcycle_model::keys::{Bound, Choice, Column, Key, Kind, Presence, Values, spec};

/// Counterparts of the methods of [`Values`] that take the parts of a key.
#[allow(dead_code, reason = "each test crate uses a part of it")]
pub trait Loose: Values {
    fn number(&self, key: &'static str, allowed: Bound, doc: &'static str) -> f64 {
        Values::number(self, &Key::new(key, spec::within(allowed), doc))
    }

    fn number_or(&self, key: &'static str, allowed: Bound, default: f64, doc: &'static str) -> f64 {
        let spec = spec::or(default, spec::within(allowed));
        Values::number(self, &Key::new(key, spec, doc))
    }

    fn optional_number(&self, key: &'static str, allowed: Bound, doc: &'static str) -> Option<f64> {
        Values::optional(self, &Key::new(key, spec::within(allowed), doc))
    }

    fn integer_or(
        &self,
        key: &'static str,
        range: RangeInclusive<i64>,
        default: i64,
        doc: &'static str,
    ) -> i64 {
        let spec = spec::integer(*range.start(), *range.end(), default);
        Values::integer(self, &Key::new(key, spec, doc))
    }

    fn boolean_or(&self, key: &'static str, default: bool, doc: &'static str) -> bool {
        Values::flag(self, &Key::new(key, spec::flag(default), doc))
    }

    fn text(&self, key: &'static str, doc: &'static str) -> String {
        Values::text(self, &Key::new(key, spec::text(), doc))
    }

    fn text_or(&self, key: &'static str, default: &str, doc: &'static str) -> String {
        Values::text_or(self, &Key::new(key, spec::text(), doc), default)
    }

    fn word_or(
        &self,
        key: &'static str,
        words: &[&'static str],
        default: &'static str,
        doc: &'static str,
    ) -> &'static str {
        let choices = choices(words);
        let spec = (Kind::Words(choices), Presence::Word(default));
        Values::word(self, &Key::new(key, spec, doc))
    }

    fn choose(
        &self,
        key: &'static str,
        options: &[&'static str],
        default: Option<&'static str>,
        doc: &'static str,
    ) -> (&'static str, Self) {
        let choices = choices(options);
        let presence = default.map_or(Presence::Required, Presence::Word);
        Values::choose(
            self,
            &Key::new(key, (Kind::Options(choices), presence), doc),
        )
    }

    fn numbers(
        &self,
        key: &'static str,
        each: Bound,
        length: RangeInclusive<usize>,
        doc: &'static str,
    ) -> Vec<f64> {
        let spec = spec::numbers(each, *length.start(), *length.end());
        Values::numbers(self, &Key::new(key, spec, doc))
    }

    fn rows(
        &self,
        key: &'static str,
        columns: &'static [Column<'static>],
        doc: &'static str,
    ) -> Vec<Vec<f64>> {
        let spec = (Kind::Rows(columns), Presence::Optional);
        Values::rows(self, &Key::new(key, spec, doc)).unwrap_or_default()
    }
}

impl Loose for Section<'_> {}

/// Options without keys of their own; leaked, as the rows of the model are statics.
fn choices(words: &[&'static str]) -> &'static [Choice] {
    let choices = words.iter().map(|word| Choice::word(word, ""));
    Box::leak(choices.collect())
}
