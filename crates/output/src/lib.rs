//! Result files: columns, traces, summaries, records of a run's inputs, and files that are whole or absent.

pub mod attribution;
pub mod escape;
pub mod file;
pub mod files;
pub mod fleet_spread;
pub mod history;
pub mod loss_forms;
pub mod loss_table;
pub mod losses;
pub mod number;
pub mod progress;
pub mod provenance;
pub mod record;
pub mod rig;
pub mod summary;
pub mod table;
pub mod trace;
pub mod variator;

pub use cvtcycle_model::drive::{EnergyTerms, PhaseTotals, Row, TERM_NAMES, Totals};
pub use cvtcycle_model::flags::Flags;
pub use cvtcycle_model::transmission::component::{ByComponent, Component};
pub use history::History;

/// Name and version of the program, as cited in the result files.
pub const PROGRAM: &str = concat!("cvtcycle ", env!("CARGO_PKG_VERSION"));
/// Identifies the build of the program: a hash of its sources, its data and its libraries' versions. Programs of one version that may compute
/// different numbers have different builds.
pub const BUILD: &str = env!("CVTCYCLE_BUILD");
