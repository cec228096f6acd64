//! Text to checked input: values in SI units, each with its origin, and every problem with its place.
//!
//! A [`Document`] is the parsed text with its places, a [`Reader`] one pass over it. Whoever reads a
//! key states its allowed range and its meaning in the same call, so that the messages, `explain` and
//! the page of assumptions cannot drift from what the program really reads.
mod assign;
pub mod cycle;
pub mod setup;
pub mod rig;
mod parts;
mod bound;
pub mod bounded;
mod choice;
mod document;
mod draft;
mod lists;
mod near;
mod problem;
mod reader;
mod render;
mod section;
mod shape;
mod source;
mod syntax;
mod units;
mod value;
mod written;

pub use bound::Bound;
pub use document::Document;
pub use draft::{Draft, KeyPath};
pub use near::near;
pub use problem::readable;
pub use problem::{Place, Problem, append};
pub use reader::{KeyInfo, Reader};
pub use render::render;
pub use section::Section;
pub use syntax::decode;
pub use units::{to_si, unit_of};
pub use written::Written;

#[cfg(test)]
mod tests;
