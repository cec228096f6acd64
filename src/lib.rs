//! Drive-cycle losses and fuel of cars with a pushing-metal-V-belt CVT, cold and warm.
//!
//! One crate a layer, each of which uses only those above it in this list.

pub use cvtcycle_config as config;
pub use cvtcycle_model as model;
pub use cvtcycle_output as output;
pub use cvtcycle_report as report;
pub use cvtcycle_study as study;
