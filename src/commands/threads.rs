//! Thread pool of the process: as many threads as requested, or as the system can start.

use std::io;
use std::panic::resume_unwind;
use std::sync::{OnceLock, mpsc};
use std::thread;

use cvtcycle::config::Problem;

use crate::args::count;
use crate::args::groups::MAX_THREADS;
use crate::args::problems::problem;
use crate::print::warn;

/// Environment variable for the number of threads.
const VARIABLE: &str = "RAYON_NUM_THREADS";

/// Thread pool, from the first call of [`begin`] on.
static THREADS: OnceLock<rayon::ThreadPool> = OnceLock::new();

/// Starts the thread pool for all parallel work: `--threads`, else the environment variable, else one thread per
/// core. If a default number of threads cannot be started, it warns and uses those that started.
/// # Errors
/// Invalid environment variable, or fewer threads than `--threads` requires.
pub fn begin(given: Option<u64>) -> Result<(), Problem> {
    if THREADS.get().is_some() {
        return Ok(());
    }
    let wanted = wanted(given);
    // rayon gives up after one thread that cannot be started. Therefore starts plain threads first, which wait for their work.
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
    // Builds the pool even after a problem, since rayon would start its own threads as the variable says.
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
        // First call in this process.
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

/// Computes two values in parallel, one of them on a plain thread: a run ends before starting the pool of [`begin`] would
/// pay off. Sequential with one thread, or if no thread can be started.
pub fn in_parallel<A: Send, B>(other: impl Fn() -> A + Sync, own: impl FnOnce() -> B) -> (A, B) {
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
        (None, Ok(text)) if !text.is_empty() => count(VARIABLE, &text, 1..=MAX_THREADS),
        (None, _) => {
            let cores = thread::available_parallelism();
            Ok(cores.map_or(1, |cores| (cores.get() as u64).min(MAX_THREADS)))
        }
    }
}

/// Starts a thread that waits for its work.
fn waiting_thread() -> io::Result<mpsc::Sender<rayon::ThreadBuilder>> {
    let (sender, receiver) = mpsc::channel::<rayon::ThreadBuilder>();
    let wait = move || {
        if let Ok(thread) = receiver.recv() {
            thread.run();
        }
    };
    thread::Builder::new().spawn(wait).map(|_| sender)
}
