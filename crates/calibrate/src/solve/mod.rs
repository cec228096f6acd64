//! Nonlinear least squares with bounds and priors, and the uncertainty of the result. No physics: parameters are numbers, the model is a trait.
//!
//! Levenberg-Marquardt in More's form (MINPACK; crate `levenberg-marquardt`) in variables that cannot cross the bounds.
//! Equations have the labels CA-1 to CA-20, each in the table at the head of its file.
//!
//! | module | content | labels |
//! |---|---|---|
//! | `types` | input and result | |
//! | `objective` | the model, counted and checked; cost | CA-1, CA-7 |
//! | `bounded` | bounds by transformation | CA-2 ... CA-4 |
//! | `jacobian` | derivatives by differences, columns in parallel | CA-5, CA-6 |
//! | `least_squares` | one descent | |
//! | `search` | one start: descent, onto a bound or off it, descent again | CA-8 |
//! | `starts` | first values | CA-9 |
//! | `fit` | all starts; the best of them | |
//! | `uncertainty` | covariance, chi squared, directions | CA-10 ... CA-16 |
//! | `identifiability` | combinations that the data do not identify | CA-17, CA-18, CA-20 |
//! | `leave_out` | fit without a group, compared with it | CA-19 |
//!
//! The same input gives the same bytes on any number of threads, unless the fit is stopped.

mod bounded;
mod fit;
mod identifiability;
mod jacobian;
mod least_squares;
mod leave_out;
mod objective;
mod search;
mod starts;
mod types;
mod uncertainty;

pub use fit::fit;
pub use identifiability::not_identified;
pub use leave_out::{Fold, leave_out};
pub use types::{Failure, Fit, FitEnd, Options, Parameter, Prior, Residuals, Start};
pub use uncertainty::{Bound, Direction, Uncertainty, uncertainty};
