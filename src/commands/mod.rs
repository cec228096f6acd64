//! The command line: words to checked input, run, print. The only place that prints.
//!
//! Every command is one file: its arguments, and a function from them to an [`Answer`] or to all problems of its
//! input. Exit codes: 0 fine; 1 ran, but a check failed; 2 bad input or output that cannot be written.

mod belt;
mod calibrate;
mod check;
mod explain;
mod list;
mod losses;
mod report;
mod rig;
mod run;
mod schema;
mod shell;
mod show;
mod study;
mod validate;

use std::ffi::OsString;
use std::process::ExitCode;

use crate::print::colour::{Colour, Paint};
use crate::print::{self, Answer, Reply, problem};
use clap::error::ErrorKind;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use cvtcycle::config::Problem;

/// Drive-cycle losses and fuel of cars with a pushing-belt CVT, cold and warm, from component physics.
#[derive(Debug, Parser)]
#[command(
    name = "cvtcycle",
    version,
    max_term_width = 100,
    propagate_version = true,
    after_help = "Example: cvtcycle run --cycle ece15_eudc --ambient -10\n\n\
        Exit codes: 0 fine; 1 ran, but a check failed (trace missed, energy not balanced); 2 bad input."
)]
struct Cli {
    /// When to colour the output; `auto` colours on a terminal and obeys NO_COLOR
    #[arg(
        long,
        value_enum,
        global = true,
        value_name = "WHEN",
        default_value = "auto",
        display_order = 1000
    )]
    color: Colour,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Drive a car and its baselines through a cycle: fuel, losses, temperatures
    Run(Box<run::Args>),
    /// Many runs: ambient temperatures, sweeps, sampling, and what they say
    Study(Box<study::Args>),
    /// Make a design-review report of a run, a study, or two runs against each other: one HTML file, and its figures
    Report(report::Args),
    /// Hold every printed number of the thesis, and your own, against the program
    Validate(Box<validate::Args>),
    /// Fit parameters to measurements, and say what the fit is worth
    Calibrate(Box<calibrate::Args>),
    /// Run the thesis's test rigs, virtual
    Rig(rig::Args),
    /// Show what each part of a transmission loses, at one operating point or over a grid
    Losses(Box<losses::Args>),
    /// The belt model at many operating points: a table in, a table out
    Belt(Box<belt::Args>),
    /// List what the program carries: cycles, vehicles, lubricants
    List(list::Args),
    /// Show every value of a vehicle or lubricant with its status and source, or a cycle
    Show(show::Args),
    /// Explain a key, a trace column or a flag: value in each file, unit, range, meaning
    Explain(explain::Args),
    /// Check vehicle, lubricant and cycle files without running them
    Check(check::Args),
    /// Print the JSON Schema of an input file, for editors and other programs
    Schema(schema::Args),
    /// Print the book of assumptions: where every value comes from
    Assumptions(shell::AssumptionsArgs),
    /// Print a completion script for a shell
    Completions(shell::CompletionsArgs),
    /// Print the manual page, of the program or of one command
    Man(shell::ManArgs),
}

/// What commands know of their surroundings.
#[derive(Clone, Copy, Debug)]
struct Context {
    /// Colours of standard output.
    paint: Paint,
    /// When to colour.
    colour: Colour,
}

/// Reads the arguments, runs the command, prints, and says how it ended.
pub fn main() -> ExitCode {
    let words: Vec<OsString> = std::env::args_os().collect();
    // Looked for before clap reads the words, since its own messages are to follow it as well.
    let asked = Colour::from_words(&words);
    let unreadable = words.iter().find(|word| word.to_str().is_none()).cloned();
    let cli = Cli::command()
        .color(asked.for_clap())
        .try_get_matches_from(words)
        .and_then(|matches| Cli::from_arg_matches(&matches));
    let (reply, colour) = match cli {
        Ok(cli) => (
            cli.command.answer(Context {
                paint: cli.color.stdout(),
                colour: cli.color,
            }),
            cli.color,
        ),
        Err(error) if error.kind() == ErrorKind::InvalidUtf8 => {
            (Err(no_text(unreadable).into()), asked)
        }
        Err(error) => (Ok(usage(&error, asked)), asked),
    };
    print::finish(reply, colour)
}

impl Command {
    fn answer(self, context: Context) -> Reply {
        match self {
            Command::Run(args) => run::answer(&args, context),
            Command::Study(args) => study::answer(&args, context),
            Command::Report(args) => report::answer(&args),
            Command::Validate(args) => validate::answer(&args, context),
            Command::Calibrate(args) => calibrate::answer(&args, context),
            Command::Rig(args) => rig::answer(&args, context),
            Command::Losses(args) => losses::answer(&args, context),
            Command::Belt(args) => belt::answer(&args, context),
            Command::List(args) => list::answer(&args, context),
            Command::Show(args) => show::answer(&args, context),
            Command::Explain(args) => explain::answer(&args, context),
            Command::Check(args) => check::answer(&args, context),
            Command::Schema(args) => schema::answer(&args),
            Command::Assumptions(args) => shell::assumptions(&args),
            Command::Completions(args) => Ok(shell::completions(&args, Cli::command())),
            Command::Man(args) => shell::man(&args, Cli::command()),
        }
    }
}

/// Names of files to read, and values, are texts; only directories and files to write may have any name that the system allows.
fn no_text(word: Option<OsString>) -> Problem {
    let value = word.unwrap_or_default().to_string_lossy().into_owned();
    let hint = "rename the file, or name it by a link; --out takes any name";
    problem("command line", &format!("`{value}` is not UTF-8"), hint).value(value.clone())
}

/// Help, version and clap's complaints, through our own writer: a closed pipe or a full disk is handled there.
fn usage(error: &clap::Error, colour: Colour) -> Answer {
    let paint = if error.use_stderr() {
        colour.stderr()
    } else {
        colour.stdout()
    };
    let text = error.render();
    let text = if paint.is_on() {
        text.ansi().to_string()
    } else {
        text.to_string()
    };
    // 2 for bad usage, 0 for help; no other code exists.
    let code = u8::try_from(error.exit_code()).unwrap_or(2);
    if error.use_stderr() {
        Answer {
            stderr: text,
            code,
            ..Answer::default()
        }
    } else {
        Answer {
            stdout: text,
            code,
            ..Answer::default()
        }
    }
}
