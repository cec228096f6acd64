//! Output too long to be held in memory, written as it comes.

use std::io::{self, BufWriter, Write};

use cvtcycle::config::Problems;

use crate::print::problem;

/// Writes to standard output through `f`; a reader that has seen enough (`| head`) is no error.
///
/// # Errors
/// A problem of standard output with the words of the operating system.
pub fn to_stdout(f: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Problems> {
    let mut out = BufWriter::new(io::stdout().lock());
    match f(&mut out).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            let hint = "free some space, or send the output elsewhere";
            Err(problem("standard output", &format!("cannot write: {error}"), hint).into())
        }
        _ => Ok(()),
    }
}
