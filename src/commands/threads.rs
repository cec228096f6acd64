//! The threads that compute: the first one of the process, and those that the system starts.

use std::io;
use std::panic::resume_unwind;
use std::sync::{OnceLock, mpsc};
use std::thread;

use cvtcycle::config::Problem;

use crate::args::count;
use crate::args::groups::MOST_THREADS;
use crate::args::problems::problem;
use crate::print::warn;

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
    let wanted = wanted(given);
    // The library gives up if one thread cannot be started. So they are started first, and wait for what it has them do.
    let (mut waiting, mut refused) = (Vec::new(), None);
    for _ in 1..*wanted.as_ref().unwrap_or(&1) {
        match waiting_thread() {
            Ok(sender) => waiting.push(sender),
            Err(error) => {
                refused = Some(format!("cannot start threads: {error}"));
                break;
            }
        }
    }
    // Also after a problem: the library would else begin threads of its own, as many as the variable says.
    let threads = waiting.len() + 1;
    let started = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .use_current_thread()
        .spawn_handler(|thread| {
            let sender = waiting.pop().ok_or(io::ErrorKind::NotFound)?;
            let sent = sender.send(thread);
            sent.map_err(|_| io::ErrorKind::BrokenPipe.into())
        })
        .build();
    match started {
        // No thread but this one has been here.
        Ok(started) => drop(THREADS.set(started)),
        Err(error) => refused = Some(format!("cannot start threads: {error}")),
    }
    wanted?;
    match refused {
        Some(message) if given.is_some() => Err(problem("--threads", &message, "give fewer")),
        Some(message) => {
            warn(&match threads {
                1 => format!("{message}; one thread computes"),
                _ => format!("{message}; {threads} threads compute"),
            });
            Ok(())
        }
        None => Ok(()),
    }
}

/// Works out two things at once, one of them on a thread of its own: a run is over before the threads of [`begin`] would pay. One after the other
/// where a process has one thread, or the system starts no other.
pub fn at_once<A: Send, B>(other: impl Fn() -> A + Sync, own: impl FnOnce() -> B) -> (A, B) {
    if wanted(None).is_ok_and(|threads| threads < 2) {
        return (other(), own());
    }
    thread::scope(|scope| {
        let started = thread::Builder::new().spawn_scoped(scope, &other);
        let own = own();
        let other = match started {
            Ok(thread) => thread.join().unwrap_or_else(|panic| resume_unwind(panic)),
            Err(_) => other(),
        };
        (other, own)
    })
}

fn wanted(given: Option<u64>) -> Result<u64, Problem> {
    match (given, std::env::var(VARIABLE)) {
        (Some(threads), _) => Ok(threads),
        (None, Ok(text)) if !text.is_empty() => count(VARIABLE, &text, 1..=MOST_THREADS),
        (None, _) => {
            let cores = thread::available_parallelism();
            Ok(cores.map_or(1, |cores| (cores.get() as u64).min(MOST_THREADS)))
        }
    }
}

/// A thread that waits for what it is to do.
fn waiting_thread() -> io::Result<mpsc::Sender<rayon::ThreadBuilder>> {
    let (sender, receiver) = mpsc::channel::<rayon::ThreadBuilder>();
    let wait = move || {
        if let Ok(thread) = receiver.recv() {
            thread.run();
        }
    };
    thread::Builder::new().spawn(wait).map(|_| sender)
}
