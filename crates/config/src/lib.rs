//! Text to checked input: values in SI units, each with its origin, and every problem with its place.
//!
//! A [`Document`] is the parsed text with its places, a [`Reader`] one pass over it. The
//! keys of vehicles, lubricants and rigs are rows of the model (`cvtcycle_model::keys`); messages,
//! `explain`, the schema and the book of assumptions come from the same rows as the reading.
mod assign;
pub mod csv;
pub mod cycle;
pub mod setup;
pub mod rig;
pub mod bounded;
mod choice;
mod document;
mod files;
mod maps;
mod patched;
pub mod embedded;
mod lists;
mod log;
mod near;
mod overrides;
mod place;
mod problem;
mod problems;
mod reader;
mod render;
pub mod schema;
mod section;
mod shape;
mod source;
mod syntax;
mod unknown;
mod value;
mod values;
mod raw_value;

pub use cvtcycle_model::keys::Bound;
use cvtcycle_model::keys::Quantity;
pub use document::Document;
pub use log::KeyInfo;
pub use near::{did_you_mean, near, suggestion};
pub use overrides::{KeyPath, Override, Target};
pub use patched::PatchedDocument;
pub use place::{Argument, Input, Place};
pub use problem::{Problem, ProblemKind, Setting, readable};
pub use problems::Problems;
pub use raw_value::RawValue;
pub use reader::Reader;
pub use render::render;
pub use section::Section;
pub use syntax::decode;

/// A value in the unit of the key, converted to SI (temperatures to kelvin).
#[must_use]
pub fn to_si(key: &str, value: f64) -> f64 {
    Quantity::of(key).to_si(value)
}

/// The unit of a key as people write it, `-` for a dimensionless one.
#[must_use]
pub fn unit_of(key: &str) -> &'static str {
    Quantity::of(key).unit()
}
