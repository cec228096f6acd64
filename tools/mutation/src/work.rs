//! Work shared among threads.

use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Mutex, MutexGuard};

/// Calls `work(worker, index)` for every index below `count` on some threads, in order; stops at the first error.
///
/// # Errors
/// The first error of the work.
pub fn share(
    jobs: usize,
    count: usize,
    work: impl Fn(usize, usize) -> Result<(), String> + Sync,
) -> Result<(), String> {
    let next = AtomicUsize::new(0);
    let error = Mutex::new(None);
    std::thread::scope(|scope| {
        for worker in 0..jobs {
            let (next, error, work) = (&next, &error, &work);
            scope.spawn(move || {
                loop {
                    let index = next.fetch_add(1, Relaxed);
                    if index >= count || lock(error).is_some() {
                        return;
                    }
                    if let Err(problem) = work(worker, index) {
                        *lock(error) = Some(problem);
                    }
                }
            });
        }
    });
    let problem = lock(&error).take();
    problem.map_or(Ok(()), Err)
}

/// A lock that somebody who panicked leaves usable.
pub fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner)
}
