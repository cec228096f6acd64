//! The program: command line to output and exit code.

use std::ffi::OsString;
use std::sync::{Mutex, PoisonError};

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{ColorChoice, CommandFactory, FromArgMatches, Subcommand};
use cvtcycle::config::setup::{Kind, is_path};
use cvtcycle::config::{Problem, is_hidden, visible};

use super::{Cli, Command, CommandLine, RunOnly};
use crate::args::problems::bad_value;
use crate::print::colour::choice;
use crate::print::{self, CommandOutput, Ending, Terminal};

/// Words after the program's name, recorded in the inputs of a run.
static WORDS: Mutex<Vec<OsString>> = Mutex::new(Vec::new());

/// Words of the command line after the program's name.
pub fn words() -> Vec<OsString> {
    WORDS.lock().unwrap_or_else(PoisonError::into_inner).clone()
}

/// Runs the program: parses the command line (its first word is the program's name), runs the command, prints, and returns the
/// exit code. It configures the whole process: threads, Ctrl-C, standard output.
pub fn program(words: impl IntoIterator<Item = OsString>) -> u8 {
    let words: Vec<OsString> = words.into_iter().collect();
    *WORDS.lock().unwrap_or_else(PoisonError::into_inner) = words.iter().skip(1).cloned().collect();
    // Found before clap parses the words, because clap's messages are coloured too.
    let colour = choice(&words);
    let is_run = words.get(1).is_some_and(|word| word == "run");
    let quick = is_run.then(|| parse::<RunOnly>(&words, colour).ok());
    // Help and problems come from the whole tree of commands.
    let parsed = match quick.flatten() {
        Some(line) => Ok(line.into()),
        None => parse::<Command>(&words, colour),
    };
    match parsed {
        Ok(cli) => {
            let terminal = Terminal::new(cli.color);
            print::finish(cli.execute(terminal), terminal)
        }
        Err(mut error) => {
            suggest_vehicle(&mut error, &words);
            let terminal = Terminal::new(colour);
            let result = match error.kind() {
                ErrorKind::InvalidUtf8 => Err(not_utf8(&words).into()),
                _ => Ok(usage(&error, terminal)),
            };
            print::finish(result, terminal)
        }
    }
}

/// Parses the command line with the commands of a tree.
fn parse<C: Subcommand>(
    words: &[OsString],
    colour: ColorChoice,
) -> Result<CommandLine<C>, clap::Error> {
    let command = CommandLine::<C>::command().color(colour);
    CommandLine::from_arg_matches(&command.try_get_matches_from(words)?)
}

/// Suggests `--vehicle` for a file without an option (`run mycar.toml`) where the command has it.
fn suggest_vehicle(error: &mut clap::Error, words: &[OsString]) {
    let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidArg) else {
        return;
    };
    let program = Cli::command();
    let name = words.get(1).and_then(|word| word.to_str());
    let command = name.and_then(|name| program.find_subcommand(name));
    let has_vehicle = |command: &clap::Command| {
        let mut options = command.get_arguments();
        options.any(|option| option.get_long() == Some("vehicle"))
    };
    let is_file =
        !word.starts_with('-') && (is_path(word) || Kind::Vehicle.names().contains(&word.as_str()));
    if error.kind() == ErrorKind::UnknownArgument && is_file && command.is_some_and(has_vehicle) {
        let tip = format!("a vehicle is named by an option: --vehicle {word}");
        error.insert(
            ContextKind::Suggested,
            ContextValue::StyledStrs(vec![tip.into()]),
        );
    }
}

/// Reports words that are not UTF-8. Only output paths may be.
fn not_utf8(words: &[OsString]) -> Problem {
    let word = words.iter().find(|word| word.to_str().is_none());
    let value = word.map_or_else(String::new, |word| word.to_string_lossy().into_owned());
    let message = format!("`{value}` is not UTF-8");
    let hint = "rename the file, or name it by a link; --out takes any name";
    bad_value("command line", &value, "", &message, hint)
}

/// Prints help, version and usage errors through the program's own writer, which handles a closed pipe and a full disk.
fn usage(error: &clap::Error, terminal: Terminal) -> CommandOutput {
    let plain = error.render().to_string();
    // The message repeats words of the command line.
    let has_hidden = plain.contains(is_hidden);
    let text = |colours: bool| match colours && !has_hidden {
        true => error.render().ansi().to_string(),
        false => visible(&plain).into_owned(),
    };
    match error.use_stderr() {
        true => CommandOutput {
            problems: text(terminal.stderr.is_on()),
            ending: Ending::BadInput,
            ..CommandOutput::default()
        },
        false => CommandOutput {
            help: text(terminal.stdout.is_on()),
            ..CommandOutput::default()
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tree with all commands reads the same from the words of a run; what it refuses is refused by both.
    #[test]
    fn a_run_is_parsed_alike_without_the_other_commands() {
        let lines = [
            "run",
            "run --cycle ftp75 --ambient=-10 --baseline twin --set a.b=1 --set c.d=2 --price never",
            "run --color never --json --out there --force --format both --draws 256",
            "run -q --color=always --strict",
        ];
        let words = |line: &str| -> Vec<OsString> {
            let words = ["cvtcycle"].into_iter().chain(line.split(' '));
            words.map(OsString::from).collect()
        };
        for line in lines.map(words) {
            let quick = parse::<RunOnly>(&line, ColorChoice::Never).expect("words of a run");
            let whole = parse::<Command>(&line, ColorChoice::Never).expect("words of a run");
            assert_eq!(format!("{:?}", Cli::from(quick)), format!("{whole:?}"));
        }
        let refused = [
            "run --no-such",
            "run --help",
            "run car.toml",
            "run --format csv",
        ];
        for line in refused.map(words) {
            assert!(parse::<RunOnly>(&line, ColorChoice::Never).is_err());
            assert!(parse::<Command>(&line, ColorChoice::Never).is_err());
        }
    }
}
