//! Figures that a decision is made on, each with a title that says what its numbers say: how sure the answer is, where the fuel goes against
//! a baseline, what the cold costs, what a test would tell, what published numbers agree.

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

/// Left edge of titles and of what lies below a plot, pixels.
const MARGIN: f64 = 12.0;
/// Upper edge of the first plot, below title and subject, pixels.
const TOP: f64 = 58.0;
