//! The test benches, the belt command and tables of losses, through the library and the program.

#[path = "../common/mod.rs"]
mod common;

mod belt;
mod losses;
mod rig_transmission;
mod rig_variator;
