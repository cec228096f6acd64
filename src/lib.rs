//! Drive-cycle losses and fuel of cars with a pushing-metal-V-belt CVT, cold and warm.
//!
//! One crate for each layer; each uses only those before it in the order model, config, output, study and validate, analysis and calibrate,
//! report. The features are `cli` (default), the program, and `studies`, the crates from study on. The program is the function `program`,
//! which the binary and the Python package call.

#[cfg(feature = "cli")]
mod args;
#[cfg(feature = "cli")]
mod commands;
#[cfg(feature = "studies")]
pub mod equations;
#[cfg(feature = "studies")]
pub mod explain;
#[cfg(feature = "cli")]
mod print;

// The program is written as a user of the library.
#[cfg(feature = "cli")]
extern crate self as cvtcycle;

#[cfg(feature = "cli")]
pub use commands::program;

#[cfg(feature = "studies")]
pub use cvtcycle_analysis as analysis;
#[cfg(feature = "studies")]
pub use cvtcycle_calibrate as calibrate;
pub use cvtcycle_config as config;
#[cfg(feature = "studies")]
pub use cvtcycle_fleet as fleet;
pub use cvtcycle_model as model;
pub use cvtcycle_output as output;
#[cfg(feature = "studies")]
pub use cvtcycle_report as report;
#[cfg(feature = "studies")]
pub use cvtcycle_study as study;
#[cfg(feature = "studies")]
pub use cvtcycle_validate as validate;
