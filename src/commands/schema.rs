//! `schema`: JSON Schema of an input file, for editors.

use clap::{Args, ValueEnum};
use cvtcycle::config::schema;
use cvtcycle::model::files;
use cvtcycle::model::keys::Table;
use cvtcycle::study::check::keys::VALIDATION;
use cvtcycle::study::fit::plan::keys::CALIBRATION;
use cvtcycle::study::plan::PLAN;

use crate::print::{CommandOutput, CommandResult};

/// Arguments of `schema`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Example: cvtcycle schema vehicle > vehicle.schema.json

With the path of the schema in the first line of a vehicle file, #:schema ./vehicle.schema.json, an editor with a TOML server shows \
ranges, units and meanings, and marks errors.")]
pub struct SchemaArgs {
    /// Kind of file
    #[arg(value_enum)]
    kind: SchemaKind,
}

/// Kinds of files with a schema.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum SchemaKind {
    /// Vehicle
    Vehicle,
    /// Lubricant
    Lubricant,
    /// Conditions of the test rigs
    Rig,
    /// Plan of a calibration
    Calibration,
    /// Rows of `validate`
    Validation,
    /// Plan of a study
    Plan,
}

impl SchemaKind {
    /// Its word, and the keys of its files.
    const fn keys(self) -> (&'static str, Table) {
        match self {
            SchemaKind::Vehicle => ("vehicle", files::VEHICLE),
            SchemaKind::Lubricant => ("lubricant", files::LUBRICANT),
            SchemaKind::Rig => ("rig", files::RIG),
            SchemaKind::Calibration => ("calibration", CALIBRATION),
            SchemaKind::Validation => ("validation", VALIDATION),
            SchemaKind::Plan => ("plan", PLAN),
        }
    }
}

/// Runs `schema`.
pub fn schema(args: &SchemaArgs) -> CommandResult {
    let (word, keys) = args.kind.keys();
    CommandOutput::json(&schema::of(word, &keys))
}
