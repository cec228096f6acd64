//! What packagers and readers need: completions, manual pages, the book of assumptions.

use cvtcycle::config::setup::assumptions::book;

use crate::args::did_you_mean;
use crate::print::{Answer, Reply, problem};

/// Arguments of `completions`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "Example: cvtcycle completions bash > cvtcycle.bash")]
pub struct CompletionsArgs {
    /// Shell
    #[arg(value_enum)]
    shell: clap_complete::Shell,
}

/// Arguments of `man`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "Example: cvtcycle man run > cvtcycle-run.1")]
pub struct ManArgs {
    /// Command; without it the page of the whole program
    command: Option<String>,
}

/// Arguments of `assumptions`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "Example: cvtcycle assumptions > assumptions.md")]
pub struct AssumptionsArgs {
    /// Print one JSON object that holds the Markdown text
    #[arg(long)]
    json: bool,
}

/// Runs `completions`.
pub fn completions(args: &CompletionsArgs, mut program: clap::Command) -> Answer {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut program, "cvtcycle", &mut script);
    Answer::text(String::from_utf8_lossy(&script).into_owned())
}

/// Runs `man`.
pub fn man(args: &ManArgs, mut program: clap::Command) -> Reply {
    program.build();
    let page = match &args.command {
        None => program,
        Some(name) => {
            let found = program.find_subcommand(name).cloned();
            found.ok_or_else(|| {
                let names: Vec<&str> = program
                    .get_subcommands()
                    .map(clap::Command::get_name)
                    .collect();
                let hint = did_you_mean(name, &names)
                    .unwrap_or_else(|| format!("one of {}", names.join(", ")));
                vec![problem(
                    "man",
                    &format!("there is no command named `{name}`"),
                    &hint,
                )]
            })?
        }
    };
    let mut text = Vec::new();
    let rendered = clap_mangen::Man::new(page).render(&mut text);
    rendered.map_err(|error| vec![problem("man", &error.to_string(), "")])?;
    Ok(Answer::text(String::from_utf8_lossy(&text).into_owned()))
}

/// Runs `assumptions`.
pub fn assumptions(args: &AssumptionsArgs) -> Reply {
    if args.json {
        return Answer::json(&serde_json::json!({ "markdown": book() }));
    }
    Ok(Answer::text(book()))
}
