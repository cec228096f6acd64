//! Result files: columns, traces, summaries, records of what a run was made from, and files that are whole or absent.

pub mod attribution;
pub mod escape;
pub mod file;
pub mod files;
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

/// Name and version of the program, as the result files cite it.
pub const PROGRAM: &str = concat!("cvtcycle ", env!("CARGO_PKG_VERSION"));
/// Which build of the program this is: a hash of its sources, its data and its libraries' versions. Programs of one version that may compute
/// other numbers have other builds.
pub const BUILD: &str = env!("CVTCYCLE_BUILD");
