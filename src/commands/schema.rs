//! `schema`: JSON Schema of an input file, for editors.

use clap::ValueEnum;
use cvtcycle::config::schema;
use cvtcycle::config::setup::Kind;

use crate::print::{Answer, Reply};

/// Arguments of `schema`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Example: cvtcycle schema vehicle > vehicle.schema.json

Name the file in the first line of a vehicle, and an editor with a TOML server shows ranges, units and
meanings and marks mistakes: #:schema ./vehicle.schema.json")]
pub struct Args {
    /// Kind of file
    #[arg(value_enum)]
    kind: File,
}

/// Kind of file.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum File {
    /// Vehicle
    Vehicle,
    /// Lubricant
    Lubricant,
    /// Conditions of the test rigs
    Rig,
}

/// Runs the command.
pub fn answer(args: &Args) -> Reply {
    let kind = match args.kind {
        File::Vehicle => Kind::Vehicle,
        File::Lubricant => Kind::Lubricant,
        File::Rig => Kind::Rig,
    };
    Answer::json(&schema::of(kind))
}
