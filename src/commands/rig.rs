//! `rig`: simulations of the test rigs of the thesis.

mod transmission;
mod variator;

use clap::{Args, Subcommand};

use super::Execute;
use crate::print::{CommandResult, Terminal};

/// Arguments of `rig`.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Examples:\n  cvtcycle rig transmission --test transient\n  cvtcycle rig variator --ratio low"
)]
pub struct RigArgs {
    #[command(subcommand)]
    rig: RigCommand,
}

#[derive(Clone, Debug, Subcommand)]
enum RigCommand {
    /// Transmission rig of thesis chapters 4 and 5: torque loss of a complete transmission and of its parts, warmed and cooled
    Transmission(Box<transmission::RigTransmissionArgs>),
    /// Variator rig of thesis chapter 6: belt slip against output torque, running radii, breakpoints
    Variator(Box<variator::RigVariatorArgs>),
}

impl RigArgs {
    /// Runs the command.
    pub fn execute(&self, terminal: Terminal) -> CommandResult {
        match &self.rig {
            RigCommand::Transmission(args) => args.execute(terminal),
            RigCommand::Variator(args) => args.execute(terminal),
        }
    }
}
