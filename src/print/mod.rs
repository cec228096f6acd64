//! The only place that prints: results, tables, problems, progress.

pub mod colour;
pub mod progress;
mod screen;

use std::io::{self, BufWriter, Write};
use std::path::PathBuf;

use cvtcycle::config::{Problem, Problems, Proposal, render};
pub use cvtcycle::output::escape::json_text;
use cvtcycle::output::files::OutputDir;
use cvtcycle::output::table::wrapped;
use serde::Serialize;

use crate::args::problems::{cite_options, problem};
use crate::args::{OutputArgs, TableOutputArgs};
pub use colour::{Paint, Terminal};
pub use screen::Form;
use screen::Screen;

/// End of a command; each has an exit code.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ending {
    /// Fine.
    #[default]
    Success,
    /// Ran, with a failed check.
    CheckFailed,
    /// Bad input, or output that cannot be written.
    BadInput,
    /// Stopped by Ctrl-C.
    Interrupted,
}

impl Ending {
    /// Exit code of the process.
    pub fn code(self) -> u8 {
        match self {
            Ending::Success => 0,
            Ending::CheckFailed => 1,
            Ending::BadInput => 2,
            Ending::Interrupted => 130,
        }
    }
}

/// Text of both streams, and the end of the command.
#[derive(Clone, Debug, Default)]
pub struct CommandOutput {
    pub stdout: String,
    pub stderr: String,
    /// Problems for standard error, before other text, with the escape codes of their renderer, which escapes hidden characters.
    pub problems: String,
    /// Help for standard output, with the escape codes of its renderer.
    pub help: String,
    pub ending: Ending,
}

/// Output of a command, or all problems of its input.
pub type CommandResult = Result<CommandOutput, Problems>;

impl CommandOutput {
    /// Prints a text.
    pub fn text(stdout: String) -> Self {
        CommandOutput {
            stdout,
            ..CommandOutput::default()
        }
    }

    /// Prints one JSON object.
    pub fn json(value: &impl Serialize) -> CommandResult {
        json_text(value).map(CommandOutput::text)
    }
}

/// Results of a command: JSON, failed checks, files.
#[derive(Debug, Default)]
pub struct Results {
    /// JSON object.
    pub json: String,
    /// Failed checks, one line each. Any of them gives exit code 1.
    pub failures: Vec<String>,
    /// Files that were written.
    pub files: WrittenFiles,
}

impl Results {
    /// Collects results.
    pub fn new(json: String, failures: Vec<String>, files: WrittenFiles) -> Self {
        Results {
            json,
            failures,
            files,
        }
    }

    /// Formats by the options: JSON, tables, or nothing on standard output; warnings on standard error.
    pub fn output(self, args: &OutputArgs, tables: impl FnOnce() -> String) -> CommandOutput {
        let stdout = match (args.json(), args.quiet) {
            (true, _) => self.json.clone(),
            (false, true) => String::new(),
            (false, false) => tables() + &self.files.list(),
        };
        CommandOutput {
            stdout,
            ..self.warnings()
        }
    }

    /// As [`Results::output`], if JSON or CSV is printed already.
    pub fn table_output(
        self,
        args: &TableOutputArgs,
        table: impl FnOnce() -> String,
    ) -> CommandOutput {
        match args.is_streamed() {
            true => self.warnings(),
            false => self.output(&args.output, table),
        }
    }

    /// Warnings and end, for results printed already.
    pub fn warnings(&self) -> CommandOutput {
        let warnings = self.failures.iter().cloned().chain(self.files.left_over());
        CommandOutput {
            stderr: warnings.map(|line| format!("cvtcycle: {line}\n")).collect(),
            ending: match self.failures.is_empty() {
                true => Ending::Success,
                false => Ending::CheckFailed,
            },
            ..CommandOutput::default()
        }
    }
}

/// Maximum number of written files listed by name; more are counted.
const MAX_NAMED: usize = 6;

/// Files of a run, and leftovers of an earlier run in the same directory.
#[derive(Debug, Default)]
pub struct WrittenFiles {
    dir: PathBuf,
    paths: Vec<PathBuf>,
    left_over: Vec<String>,
    note: &'static str,
}

impl WrittenFiles {
    /// Fills the output directory, if there is one, and commits all files or none. `fill` returns a line to print after
    /// the list of files.
    pub fn write(
        out: Option<OutputDir>,
        fill: impl FnOnce(&mut OutputDir) -> Result<&'static str, Problems>,
    ) -> Result<Self, Problems> {
        let Some(mut dir) = out else {
            return Ok(Self::default());
        };
        let note = fill(&mut dir)?;
        let left_over = dir.left_over();
        Ok(WrittenFiles {
            dir: dir.path().to_owned(),
            paths: dir.commit()?,
            left_over,
            note,
        })
    }

    fn list(&self) -> String {
        let dir = self.dir.display();
        let names = self.paths.iter().map(|path| {
            let name = path.strip_prefix(&self.dir).unwrap_or(path);
            name.display().to_string()
        });
        let names: Vec<String> = names.collect();
        let written = match names.len() {
            0 => return String::new(),
            1..=MAX_NAMED => wrapped(&names.join(", "), &format!("Files written in {dir}: ")),
            count => format!("Files written in {dir}: {count}\n"),
        };
        format!("\n{written}{}", self.note)
    }

    fn left_over(&self) -> Option<String> {
        let names = self.left_over.join(", ");
        (!names.is_empty()).then(|| format!("files of an earlier run were not replaced: {names}"))
    }
}

/// Joins sections of a text, each below its heading. Empty ones are left out.
pub fn sections<S: AsRef<str>>(
    sections: impl IntoIterator<Item = (S, String)>,
    paint: Paint,
) -> String {
    let shown = sections.into_iter().filter(|(_, body)| !body.is_empty());
    let section = |(title, body): (S, String)| format!("\n{}{body}", bold(title.as_ref(), paint));
    shown.map(section).collect()
}

/// Styles a sentence as a heading, wrapped to the line width.
pub fn bold(sentence: &str, paint: Paint) -> String {
    let lines = wrapped(sentence, "");
    lines
        .lines()
        .map(|line| paint.heading(line) + "\n")
        .collect()
}

/// Streams a long text through `f` to standard output.
/// # Errors
/// Failing standard output, with the system's message; a closed pipe is not an error.
pub fn to_stdout(
    form: Form,
    f: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), Problems> {
    let mut out = BufWriter::new(Screen::new(io::stdout().lock(), form));
    unless_closed(f(&mut out).and_then(|()| out.flush())).map_err(|error| unwritten(&error).into())
}

/// Streams a table as JSON or CSV, if one of them is chosen.
pub fn stream(
    args: &TableOutputArgs,
    json: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    csv: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), Problems> {
    match args.is_streamed() {
        true if args.output.json() => to_stdout(Form::Json, json),
        true => to_stdout(Form::Text(Paint::NONE), csv),
        false => Ok(()),
    }
}

/// Prints the output of a command or its problems, and returns the exit code.
pub fn finish(result: CommandResult, terminal: Terminal) -> u8 {
    let mut output = result.unwrap_or_else(|problems| CommandOutput {
        problems: problems_text(&problems.map(cite_options), terminal.stderr.is_on()),
        ending: Ending::BadInput,
        ..CommandOutput::default()
    });
    let stdout = write(
        io::stdout().lock(),
        &output.help,
        &output.stdout,
        terminal.stdout,
    );
    if let Err(error) = stdout {
        let text = render(&[unwritten(&error)], terminal.stderr.is_on());
        output.problems.insert_str(0, &text);
        output.ending = Ending::BadInput;
    }
    // A failing standard error leaves no stream for a message.
    drop(write(
        io::stderr().lock(),
        &output.problems,
        &output.stderr,
        terminal.stderr,
    ));
    output.ending.code()
}

/// Problems as text, and below them the same call with the columns with which a file is read.
pub fn problems_text(problems: &[Problem], colour: bool) -> String {
    let mut text = render(problems, colour);
    let mut proposals: Vec<&Proposal> = problems
        .iter()
        .filter_map(|problem| problem.proposal.as_deref())
        .collect();
    proposals.dedup();
    for own in proposals {
        text += &format!("try: {}\n", with_choice(std::env::args().skip(1), own));
    }
    text
}

/// A call of the program with these columns in place of others, and with these repairs besides others, as a shell takes it.
fn with_choice(arguments: impl Iterator<Item = String>, own: &Proposal) -> String {
    let choices = [("--columns", &own.columns), ("--repair", &own.repair)];
    let mut words = vec!["cvtcycle".to_owned()];
    let mut repairs: Vec<String> = Vec::new();
    let mut before: Option<&str> = None;
    for argument in arguments {
        let (name, value) = match (before.take(), argument.split_once('=')) {
            (Some(name), _) => (name, Some(argument.as_str())),
            (None, Some((name, value))) => (name, Some(value)),
            (None, None) => (argument.as_str(), None),
        };
        let Some((name, _)) = choices
            .iter()
            .find(|(own, text)| *own == name && !text.is_empty())
        else {
            words.push(quoted(&argument));
            continue;
        };
        match value {
            None => before = Some(name),
            Some(value) if *name == "--repair" => repairs.push(value.to_owned()),
            Some(_) => {}
        }
    }
    if !own.columns.is_empty() {
        words.extend(["--columns".to_owned(), quoted(&own.columns)]);
    }
    if !own.repair.is_empty() {
        repairs.push(own.repair.clone());
        words.extend(["--repair".to_owned(), quoted(&repairs.join(","))]);
    }
    words.join(" ")
}

/// A word as a shell takes it: in quotes where it has more than letters, figures and signs without meaning there.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./=:,%+@".contains(c);
    match word {
        "" => "\"\"".to_owned(),
        word if word.chars().all(is_plain) => word.to_owned(),
        // Double quotes are those of all shells; where the word has signs that they do not hold, single ones.
        word if !word.contains(['"', '$', '`', '\\', '!']) => format!("\"{word}\""),
        word => format!("'{}'", word.replace('\'', "'\\''")),
    }
}

fn unwritten(error: &io::Error) -> Problem {
    let hint = "free some space, or send the output elsewhere";
    problem("standard output", &format!("cannot write: {error}"), hint)
}

/// Writes a warning to standard error at once, before the end of the command.
pub fn warn(line: &str) {
    let line = format!("cvtcycle: {line}\n");
    // Without a stream the warning is lost.
    drop(write(io::stderr().lock(), "", &line, Paint::NONE));
}

/// Writes styled text of a renderer, then text of any origin with hidden characters escaped.
fn write(mut out: impl Write, styled: &str, text: &str, paint: Paint) -> io::Result<()> {
    let written = out.write_all(styled.as_bytes());
    let mut screen = Screen::new(out, Form::Text(paint));
    let written = written.and_then(|()| screen.write_all(text.as_bytes()));
    unless_closed(written.and_then(|()| screen.flush()))
}

/// Ignores a closed pipe (`| head`).
fn unless_closed(result: io::Result<()>) -> io::Result<()> {
    match result {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => other,
    }
}
