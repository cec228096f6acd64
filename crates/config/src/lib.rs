//! Text to checked input: values in SI units, each with its origin, and every problem with its place.
//!
//! A [`Document`] is the parsed text with its places, a [`Reader`] one pass over it, a [`setup::ParamSet`] the checked values of a car, of which
//! `with(key, value)` gives another one. A *vehicle* is a file, and the model's car before an ambient temperature is known
//! (`cvtcycle_model::drive::Vehicle`); a *car* is a vehicle that is ready to drive at one; a *setup* is a vehicle with its fluids, its names and
//! the origin of each value. The
//! keys of vehicles, lubricants and rigs are rows of the model (`cvtcycle_model::keys`); messages,
//! `explain`, the schema and the book of assumptions come from the same rows as the reading.
//!
//! | room | content |
//! |---|---|
//! | `problem` | what is wrong, where, and its text |
//! | `files` | files that an input names, limits of their size, the files that the program carries |
//! | `csv` | CSV tables against a schema |
//! | `document` | TOML text to a tree with places; overrides over it |
//! | `reader` | values of keys in SI units with their origin: numbers, lists, choices, maps; a record of them for the parts of the model |
//! | `setup` | vehicles, lubricants, rig; sets of values; the catalogue of keys, the book of assumptions |
//! | `cycle` | drive cycles |
//! | `procedure` | tests: a cycle with its start, temperature, load and figures |
//! | `schema` | JSON Schema of the files |
pub mod channel;
pub mod csv;
pub mod log;
pub mod cycle;
mod document;
mod files;
mod problem;
pub mod procedure;
mod reader;
pub mod schema;
pub mod setup;

pub use cvtcycle_model::keys::Bound;
use cvtcycle_model::keys::Quantity;
pub use document::Document;
pub use document::overrides::{Acts, Override};
pub use document::syntax::decode;
pub use document::target::{KeyPath, Target};
pub use files::{bounded, carried, embedded};
pub use problem::near::{did_you_mean, near, suggestion};
pub use problem::place::{Argument, Input, Place};
pub use problem::render::render;
pub use problem::visible::{is_hidden, one_line, visible};
pub use problem::{Problem, ProblemKind, Problems, Proposal, Setting, readable};
pub use reader::Reader;
pub use reader::lists::{decimal, evenly};
pub use reader::log::KeyInfo;
pub use reader::maps::loss_map_axes;
pub use reader::raw_value::RawValue;
pub use reader::section::Section;
pub use setup::rig;

/// A value in the unit of the key, converted to SI (temperatures to kelvin).
#[must_use]
pub fn to_si(key: &str, value: f64) -> f64 {
    Quantity::from_key(key).to_si(value)
}

/// The unit of a key as people write it, `-` for a dimensionless one.
#[must_use]
pub fn unit_of(key: &str) -> &'static str {
    Quantity::from_key(key).unit()
}
