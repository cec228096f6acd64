//! Statistics of studies: pure functions on columns of outputs.
//!
//! A value that is not finite means that there is none: it is left out *and counted*. Intervals are of the [`Confidence`] that is asked
//! for, 95 % by default, and only a sample has them. What does not follow from the data (the spread of one value, the indices of a constant) is NaN, and `None` where an interval is meant; JSON shows both as
//! `null`. Nothing here depends on the number of threads.

mod confidence;
mod describe;
mod enough;
mod groups;
mod information;
mod intervals;
mod order;
mod passes;
mod rank;
mod sobol;
mod spread;
mod tornado;

pub use confidence::{Confidence, of_hundred};
pub use describe::{Quantile, Share, Summary, quantile_of_sorted, quantiles};
pub use enough::Enough;
pub use groups::{Group, Groups, group_means, group_means_over};
pub use information::{Column, Shares, sd_left, shares};
pub use intervals::least_draws;
pub use passes::Numbers;
pub use rank::{RankFactor, RankSensitivity, rank_sensitivity};
pub use sobol::{Blocks, Bootstrap, FactorIndices, SobolIndices, sobol_convergence, sobol_indices};
pub use spread::Spread;
pub use tornado::{Tornado, TornadoBar, TornadoEnd, TornadoInput, tornado};

use serde::Serialize;

/// An estimate with what is known of its error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// The estimate itself; NaN where it is not defined.
    pub value: f64,
    /// Interval, ascending; `None` where it is not defined.
    pub interval: Option<[f64; 2]>,
}

impl Estimate {
    /// Neither a value nor an interval.
    pub const NONE: Estimate = Estimate {
        value: f64::NAN,
        interval: None,
    };
}
