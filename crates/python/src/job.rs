//! Work without the lock of the interpreter: on threads of this process, stopped by Ctrl-C.

use std::mem::forget;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;
use std::{process, thread};

use cvtcycle::output::progress::Progress;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::errors::bad;

/// Maximum number of threads.
const MAX_THREADS: usize = 1024;
/// Interval at which signals are checked.
const SIGNAL_INTERVAL: Duration = Duration::from_millis(50);

/// Flag that stops the work.
#[derive(Clone, Debug, Default)]
pub struct Stop(Arc<AtomicBool>);

impl Progress for Stop {
    fn advance(&self, _: u64) {}

    fn stopped(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Effect of Ctrl-C on work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interrupted {
    /// The work polls [`Stop`]; the call returns after it has stopped.
    Stops,
    /// The work cannot be stopped: the call returns at once, and the result is dropped later.
    Detaches,
}

/// Runs work on a separate thread, with a pool of `threads` for its parallel parts (one per core by default), and checks Python's
/// signals meanwhile.
/// # Errors
/// The exception of a signal, or of threads that cannot start. A panic of the work continues in the caller.
pub fn job<T: Send + 'static>(
    py: Python<'_>,
    threads: Option<usize>,
    how: Interrupted,
    work: impl FnOnce(&Stop) -> T + Send + 'static,
) -> PyResult<T> {
    let pool = pool(threads)?;
    let stop = Stop::default();
    let (send, receive) = channel();
    let own = stop.clone();
    let run = move || {
        // The receiver is gone after an interruption.
        drop(send.send(pool.install(|| work(&own))));
    };
    let worker = thread::Builder::new().name("cvtcycle".into()).spawn(run);
    let worker =
        worker.map_err(|error| PyOSError::new_err(format!("cannot start a thread: {error}")))?;
    let mut worker = Some(worker);
    py.detach(move || {
        loop {
            match receive.recv_timeout(SIGNAL_INTERVAL) {
                Ok(done) => return Ok(done),
                Err(RecvTimeoutError::Disconnected) => {
                    if let Some(Err(panic)) = worker.take().map(JoinHandle::join) {
                        resume_unwind(panic);
                    }
                    unreachable!("a thread that ends sends its result")
                }
                Err(RecvTimeoutError::Timeout) => {}
            }
            if let Err(signal) = Python::attach(|py| py.check_signals()) {
                stop.0.store(true, Ordering::Relaxed);
                if how == Interrupted::Stops {
                    drop(receive.recv());
                }
                return Err(signal);
            }
        }
    })
}

/// Pools of this process by number of threads. A forked child has none of its parent's threads and makes its own pools.
static POOLS: Mutex<(u32, Pools)> = Mutex::new((0, Vec::new()));

/// Pools with their number of threads.
type Pools = Vec<(usize, Arc<ThreadPool>)>;

fn pool(threads: Option<usize>) -> PyResult<Arc<ThreadPool>> {
    let cores = || thread::available_parallelism().map_or(1, usize::from);
    let threads = threads.unwrap_or_else(|| cores().min(MAX_THREADS));
    if !(1..=MAX_THREADS).contains(&threads) {
        let allowed = format!("1 to {MAX_THREADS}");
        let message = format!("{threads} threads are out of range");
        return Err(bad("threads", &threads.to_string(), &allowed, &message));
    }
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    let (owner, list) = &mut *pools;
    if *owner != process::id() {
        *owner = process::id();
        // Leaks them, since their threads exist in the parent only and cannot be joined.
        forget(std::mem::take(list));
    }
    if let Some((_, pool)) = list.iter().find(|(n, _)| *n == threads) {
        return Ok(Arc::clone(pool));
    }
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    let pool =
        pool.map_err(|error| PyOSError::new_err(format!("cannot start threads: {error}")))?;
    let pool = Arc::new(pool);
    list.push((threads, Arc::clone(&pool)));
    Ok(pool)
}
