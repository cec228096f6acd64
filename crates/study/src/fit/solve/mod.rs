//! Nonlinear least squares with bounds and priors, and what a fit is worth. No physics: parameters are numbers, the model is a trait.
//!
//! Levenberg-Marquardt in More's form (MINPACK; crate `levenberg-marquardt`) goes down in variables in which bounds cannot be crossed.
//! Equations have the labels CA-1 to CA-20, each in the table at the head of its file.
//!
//! | module | what stands there | labels |
//! |---|---|---|
//! | `ask` | the model, counted and checked | CA-1 |
//! | `bounded` | bounds by transformation | CA-2 ... CA-4 |
//! | `slope` | derivatives by differences, columns in parallel | CA-5, CA-6 |
//! | `point` | values, answer and cost | CA-7 |
//! | `descend` | one start: down, to a bound or off it, down again | CA-8 |
//! | `starts` | where starts are | CA-9 |
//! | `fit` | all starts; the best of them | |
//! | `uncertainty` | covariance, chi squared, directions | CA-10 ... CA-15 |
//! | `words` | what the data alone do not identify | CA-16 ... CA-18, CA-20 |
//! | `leave_out` | fitted without a group, compared with it | CA-19 |
//!
//! The same input gives the same bytes on any number of threads, unless somebody stops it.

mod ask;
mod bounded;
mod descend;
mod fit;
mod leave_out;
mod point;
mod slope;
mod starts;
mod types;
mod uncertainty;
mod words;

pub use fit::fit;
pub use leave_out::{Fold, leave_out};
pub use types::{End, Failure, Fit, Options, Parameter, Prior, Residuals, Start};
pub use uncertainty::{Bound, Direction, Uncertainty, uncertainty};
pub use words::words;
