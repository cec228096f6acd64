//! Figures for decisions, each with its result as title: confidence in the answer, fuel against a baseline, cost of the cold, benefit of a test,
//! agreement with published numbers.

mod agreement;
mod information;
mod repeats;
mod says;
mod strip;
mod waterfall;

pub use agreement::{CheckedNumber, agreement};
pub use information::information;
pub use repeats::{Repeat, repeats};
pub use says::{against, level};
pub use strip::{Against, answer_strip};
pub use waterfall::{PerKm, waterfall};

/// Left edge of titles and of blocks below a plot, pixels.
const MARGIN: f64 = 12.0;
/// Upper edge of the first plot, below title and subject, pixels.
const TOP: f64 = 58.0;
