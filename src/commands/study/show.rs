//! `study show`: what a directory says, finished or partial.

use std::path::PathBuf;

use cvtcycle::report::found::StudyFound;

use super::common::reply;
use crate::commands::Context;
use crate::print::Reply;

/// Arguments of `study show`.
#[derive(Clone, Debug, clap::Args)]
#[command(
    after_help = "Example:\n  cvtcycle study show my_study\n\nOf an interrupted study it shows what the finished parts say, and how many they are."
)]
pub struct Args {
    /// Directory that was given to --out
    #[arg(value_name = "DIR")]
    dir: PathBuf,
    /// Print one JSON object instead of tables
    #[arg(long)]
    json: bool,
    /// Print nothing but problems
    #[arg(long, short)]
    quiet: bool,
}

/// Runs the command.
pub fn answer(args: &Args, context: Context) -> Reply {
    let study = StudyFound::open(&args.dir)?;
    reply(&study, args.json, args.quiet, context)
}
