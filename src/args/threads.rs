//! The threads that compute: the first one of the process, and those that the system starts.

use std::io;
use std::sync::{OnceLock, mpsc};
use std::thread;

use cvtcycle::config::Problem;

use super::count;
use super::problems::problem;
use crate::print::warn;

/// Most threads.
pub const MOST: u64 = 1024;
/// Their number, where no option gives one.
const VARIABLE: &str = "RAYON_NUM_THREADS";

/// The threads of this process, from the first call of [`begin`] on.
static THREADS: OnceLock<rayon::ThreadPool> = OnceLock::new();

/// Begins the threads for all that is computed in parallel from here on: so many as `--threads` gives, else as the variable says, else one
/// for each core. Where none were asked for and the system starts fewer, there is a warning, and those compute.
///
/// # Errors
/// The variable is no number of threads, or the system starts fewer than `--threads` gives.
pub fn begin(given: Option<u64>) -> Result<(), Problem> {
    if THREADS.get().is_some() {
        return Ok(());
    }
    let wanted = match (given, std::env::var(VARIABLE)) {
        (Some(threads), _) => threads,
        (None, Ok(text)) if !text.is_empty() => count(VARIABLE, &text, 1..=MOST)?,
        (None, _) => thread::available_parallelism().map_or(1, |n| (n.get() as u64).min(MOST)),
    };
    // The library gives up if one thread cannot be started. So they are started first, and wait for what it has them do.
    let (mut waiting, mut refused) = (Vec::new(), None);
    for _ in 1..wanted {
        let (sender, receiver) = mpsc::channel::<rayon::ThreadBuilder>();
        let wait = move || {
            if let Ok(thread) = receiver.recv() {
                thread.run();
            }
        };
        match thread::Builder::new().spawn(wait) {
            Ok(_) => waiting.push(sender),
            Err(error) => {
                refused = Some(error);
                break;
            }
        }
    }
    let threads = waiting.len() + 1;
    if let Some(error) = refused {
        let message = format!("cannot start threads: {error}");
        if given.is_some() {
            return Err(problem("--threads", &message, "give fewer"));
        }
        warn(&match threads {
            1 => format!("{message}; one thread computes"),
            _ => format!("{message}; {threads} threads compute"),
        });
    }
    let started = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .use_current_thread()
        .spawn_handler(|thread| {
            let sender = waiting.pop().ok_or(io::ErrorKind::NotFound)?;
            let sent = sender.send(thread);
            sent.map_err(|_| io::ErrorKind::BrokenPipe.into())
        })
        .build();
    let started = started.map_err(|error| {
        let message = format!("cannot start threads: {error}");
        problem("--threads", &message, "give fewer")
    })?;
    // No thread but this one has been here.
    drop(THREADS.set(started));
    Ok(())
}
