//! Runs tests in a process of its own, with a limit of time; shares work among threads.

use crate::compile::Program;
use std::os::unix::process::CommandExt as _;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Mutex, MutexGuard};
use std::time::{Duration, Instant};

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// All tests passed.
    Passed,
    /// One failed, or the program died.
    Failed,
    /// It took longer than allowed.
    Late,
}

/// What a run is given.
pub struct Run<'a> {
    /// The test program.
    pub program: &'a Program,
    /// Exact names of its tests.
    pub names: Vec<&'a str>,
    /// Variable of the environment and its value.
    pub env: Option<(&'a str, String)>,
    /// The limit.
    pub limit: Duration,
    /// File for what the tests print.
    pub output: &'a Path,
}

/// Runs, and answers with the end and the time it took.
///
/// # Errors
/// The program cannot be started.
pub fn run(run: &Run) -> Result<(End, Duration), String> {
    let mut command = Command::new(&run.program.path);
    command
        .args(["--exact", "--test-threads=1", "-q"])
        .args(&run.names)
        .current_dir(&run.program.folder);
    command
        .env("CARGO_MANIFEST_DIR", &run.program.folder)
        .env("PROPTEST_MAX_SHRINK_ITERS", "0")
        .env("PROPTEST_FAILURE_PERSISTENCE", "off");
    command
        .env_remove("CVTCYCLE_MUTANT")
        .env("RUST_BACKTRACE", "0")
        .envs(run.env.iter().map(|(k, v)| (k, v)));
    let output =
        std::fs::File::create(run.output).map_err(|e| format!("{}: {e}", run.output.display()))?;
    command
        .stdin(Stdio::null())
        .stdout(output)
        .stderr(Stdio::null())
        .process_group(0);
    let begun = Instant::now();
    let mut child = command
        .spawn()
        .map_err(|e| format!("{}: {e}", run.program.path.display()))?;
    let mut nap = Duration::from_micros(500);
    loop {
        if let Some(status) = child.try_wait().map_err(|e| e.to_string())? {
            return Ok((
                if status.success() {
                    End::Passed
                } else {
                    End::Failed
                },
                begun.elapsed(),
            ));
        }
        if begun.elapsed() > run.limit {
            // The whole group: a test may have started the program itself.
            let _ = Command::new("kill")
                .args(["-9", "--", &format!("-{}", child.id())])
                .status();
            let _ = child.wait();
            return Ok((End::Late, begun.elapsed()));
        }
        std::thread::sleep(nap);
        nap = (nap * 5 / 4).min(Duration::from_millis(20));
    }
}

/// Names of all tests of a program that are not ignored.
///
/// # Errors
/// It cannot be run.
pub fn list(program: &Program) -> Result<Vec<String>, String> {
    let ask = |more: &[&str]| {
        let output = Command::new(&program.path)
            .args(["--list", "--format", "terse"])
            .args(more)
            .current_dir(&program.folder)
            .output();
        let output = output.map_err(|e| format!("{}: {e}", program.path.display()))?;
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        Ok::<_, String>(
            text.lines()
                .filter_map(|l| l.strip_suffix(": test").map(str::to_owned))
                .collect::<Vec<_>>(),
        )
    };
    let ignored = ask(&["--ignored"])?;
    Ok(ask(&[])?
        .into_iter()
        .filter(|t| !ignored.contains(t))
        .collect())
}

/// The first test that a program's output calls failed.
#[must_use]
pub fn first_failed(output: &Path) -> Option<String> {
    let bytes = std::fs::read(output).ok()?;
    let text = String::from_utf8_lossy(&bytes);
    let (_, list) = text.rsplit_once("\nfailures:\n")?;
    Some(list.lines().next()?.trim().to_owned())
}

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
