//! Parameters fitted to measurements: plan -> data -> residuals -> least squares -> what the fit is worth -> fitted files.
//!
//! | part | content |
//! |---|---|
//! | `plan` | a TOML file to a plan: free parameters, groups of data |
//! | `data` | measured CSV files to observations |
//! | `model` | numbers for the parameters to computed observations: rigs and cycles are run anew |
//! | `solve` | least squares, bounds, several starts, covariance, what the data do not identify; knows no physics |
//! | `outcome` | everything that a calibration found |
//! | `fitted` | vehicle and lubricant files with the fitted values |
//!
//! A residual is (computed - measured) / sd. What is computed comes from the sources and expressions of [`crate::check`], so that a
//! number is computed in the same way for a fit and for a verdict. A measured range has no residual within it.

pub mod data;
pub mod fitted;
pub mod model;
pub mod outcome;
pub mod plan;
mod run;
pub mod tables;
pub mod solve;

pub use cvtcycle_config::embedded::calibrations as embedded_calibrations;
pub use run::{calibrate, open};
