//! `rig`: the thesis's test rigs, virtual.

mod transmission;
mod variator;

use clap::Subcommand;

use super::Context;
use crate::print::Reply;

/// Arguments of `rig`.
#[derive(Clone, Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  cvtcycle rig transmission --test transient\n  cvtcycle rig variator --ratio low"
)]
pub struct Args {
    #[command(subcommand)]
    rig: Rig,
}

#[derive(Clone, Debug, Subcommand)]
enum Rig {
    /// The transmission rig of thesis chapters 4 and 5: torque loss of a whole box, taken apart, warmed and cooled
    Transmission(Box<transmission::Args>),
    /// The variator rig of thesis chapter 6: belt slip against output torque, radii, breakpoints
    Variator(Box<variator::Args>),
}

/// Runs the command.
pub fn answer(args: &Args, context: Context) -> Reply {
    match &args.rig {
        Rig::Transmission(args) => transmission::answer(args, context),
        Rig::Variator(args) => variator::answer(args, context),
    }
}
