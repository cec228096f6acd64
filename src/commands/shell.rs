//! `schema`, `completions`, `man` and `assumptions`: texts for editors, packagers and readers.

use clap::{Args, CommandFactory, ValueEnum};
use cvtcycle::analysis::levers::keys::LEVER_FILE;
use cvtcycle::calibrate::plan::keys::CALIBRATION;
use cvtcycle::config::procedure::TEST_FILE;
use cvtcycle::config::schema;
use cvtcycle::config::setup::assumptions::book;
use cvtcycle::equations::equations;
use cvtcycle::model::files;
use cvtcycle::model::keys::Table;
use cvtcycle::study::plan::PLAN;
use cvtcycle::validate::keys::VALIDATION;

use super::Cli;
use crate::args::JsonArgs;
use crate::args::problems::{did_you_mean, problem};
use crate::print::{CommandOutput, CommandResult};

/// Arguments of `completions`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Example: cvtcycle completions bash > cvtcycle.bash")]
pub struct CompletionsArgs {
    /// Shell
    #[arg(value_enum)]
    shell: clap_complete::Shell,
}

/// Arguments of `man`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Example: cvtcycle man run > cvtcycle-run.1")]
pub struct ManArgs {
    /// Command [default: the whole program]
    command: Option<String>,
}

/// Arguments of `assumptions`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Example: cvtcycle assumptions > assumptions.md")]
pub struct AssumptionsArgs {
    #[command(flatten)]
    output: JsonArgs,
}

/// Runs `completions`.
pub fn completions(args: &CompletionsArgs) -> CommandResult {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "cvtcycle", &mut script);
    Ok(CommandOutput::text(
        String::from_utf8_lossy(&script).into_owned(),
    ))
}

/// Runs `man`.
pub fn man(args: &ManArgs) -> CommandResult {
    let mut program = Cli::command();
    program.build();
    let page = match &args.command {
        None => program,
        Some(name) => program.find_subcommand(name).cloned().ok_or_else(|| {
            let names: Vec<&str> = program
                .get_subcommands()
                .map(clap::Command::get_name)
                .collect();
            let question = did_you_mean(name, &names);
            let list = format!("one of {}", names.join(", "));
            let hint = if question.is_empty() { list } else { question };
            let message = format!("there is no command named `{name}`");
            problem("man", &message, &hint)
        })?,
    };
    let mut text = Vec::new();
    let rendered = clap_mangen::Man::new(page).render(&mut text);
    rendered.map_err(|error| problem("man", &error.to_string(), ""))?;
    Ok(CommandOutput::text(
        String::from_utf8_lossy(&text).into_owned(),
    ))
}

/// Runs `assumptions`.
pub fn assumptions(args: &AssumptionsArgs) -> CommandResult {
    let equations: Vec<_> = equations().collect();
    let text = book(&equations);
    if args.output.json {
        return CommandOutput::json(&serde_json::json!({ "markdown": text }));
    }
    Ok(CommandOutput::text(text))
}

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
    /// Changes of a car's design
    Levers,
    /// Test of a regulation
    Test,
}

impl SchemaKind {
    /// Name of the kind, and the keys of its files.
    const fn keys(self) -> (&'static str, Table) {
        match self {
            SchemaKind::Vehicle => ("vehicle", files::VEHICLE),
            SchemaKind::Lubricant => ("lubricant", files::LUBRICANT),
            SchemaKind::Rig => ("rig", files::RIG),
            SchemaKind::Calibration => ("calibration", CALIBRATION),
            SchemaKind::Validation => ("validation", VALIDATION),
            SchemaKind::Plan => ("plan", PLAN),
            SchemaKind::Levers => ("levers", LEVER_FILE),
            SchemaKind::Test => ("test", TEST_FILE),
        }
    }
}

/// Runs `schema`.
pub fn schema(args: &SchemaArgs) -> CommandResult {
    let (word, keys) = args.kind.keys();
    CommandOutput::json(&schema::json_schema(word, &keys))
}
