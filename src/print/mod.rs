//! What a command answers, and how it reaches the user.

pub mod colour;
pub mod grid;
pub mod progress;
pub mod stream;

use std::io::{self, Write};
use std::process::ExitCode;

use cvtcycle::config::{Problem, Problems, render};

use colour::Colour;

/// Ran, but a check failed.
pub const FAILED: u8 = 1;
/// Bad input, or output that cannot be written.
pub const BAD_INPUT: u8 = 2;

/// Text for the user and how the command ended.
#[derive(Clone, Debug, Default)]
pub struct Answer {
    /// For standard output.
    pub stdout: String,
    /// For standard error.
    pub stderr: String,
    /// Exit code.
    pub code: u8,
}

/// An answer, or everything that is wrong with the input.
pub type Reply = Result<Answer, Problems>;

impl Answer {
    /// An answer that is all fine.
    pub fn text(stdout: String) -> Self {
        Answer {
            stdout,
            ..Answer::default()
        }
    }

    /// One JSON object and nothing else.
    pub fn json(value: &impl serde::Serialize) -> Result<Self, Problems> {
        json_text(value).map(Answer::text)
    }
}

/// A value as indented JSON with a line end.
///
/// # Errors
/// Never for the values of this program; a map with keys that are no text would be one.
pub fn json_text(value: &impl serde::Serialize) -> Result<String, Problems> {
    let text = serde_json::to_string_pretty(value);
    text.map(|text| text + "\n")
        .map_err(|e| problem("--json", &e.to_string(), "").into())
}

/// A problem of an option or argument without more places than its name.
pub fn problem(option: &str, message: &str, hint: &str) -> Problem {
    Problem::invalid(message)
        .in_file(option)
        .key(option)
        .hint(hint)
}

/// Prints an answer or the problems and gives the exit code.
pub fn finish(reply: Reply, colour: Colour) -> ExitCode {
    let answer = reply.unwrap_or_else(|problems| Answer {
        stderr: render(&problems, colour.stderr().is_on()),
        code: BAD_INPUT,
        ..Answer::default()
    });
    let mut code = answer.code;
    if let Err(error) = write(&mut io::stdout().lock(), &answer.stdout) {
        let hint = "free some space, or send the output elsewhere";
        let unwritten = problem("standard output", &format!("cannot write: {error}"), hint);
        complain(&render(&[unwritten], colour.stderr().is_on()));
        code = BAD_INPUT;
    }
    complain(&answer.stderr);
    ExitCode::from(code)
}

fn complain(text: &str) {
    // Where standard error is gone as well there is nobody left to tell.
    drop(write(&mut io::stderr().lock(), text));
}

/// Writes a text; a reader that has seen enough (`| head`) is no error.
fn write(out: &mut impl Write, text: &str) -> io::Result<()> {
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => other,
    }
}
