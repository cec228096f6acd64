//! How far a study is: a bar on a terminal, a line now and then elsewhere, nothing with --quiet. Always on standard error.

use std::io::{IsTerminal, Write};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

/// Between two lines where there is no terminal.
const EVERY: Duration = Duration::from_secs(10);

/// Set by Ctrl-C. A request to end (SIGTERM) ends the process at once, as a kill does: whole parts stay, and --resume goes on.
static STOP: AtomicBool = AtomicBool::new(false);
/// Exit code of a process that ends by Ctrl-C, as shells have it.
pub const INTERRUPTED: u8 = 130;

/// Looks after a study that runs.
pub struct Progress {
    how: How,
    done: AtomicU64,
    runs: u64,
}

enum How {
    Nothing,
    Bar(ProgressBar),
    Lines(Mutex<Lines>),
}

struct Lines {
    begun: Instant,
    last: Instant,
}

impl Progress {
    /// For so many runs.
    pub fn new(runs: u64, quiet: bool) -> Self {
        let how = if quiet {
            How::Nothing
        } else if std::io::stderr().is_terminal() {
            let bar = ProgressBar::with_draw_target(Some(runs), ProgressDrawTarget::stderr());
            bar.set_style(style());
            bar.enable_steady_tick(Duration::from_millis(200));
            How::Bar(bar)
        } else {
            let now = Instant::now();
            How::Lines(Mutex::new(Lines {
                begun: now,
                last: now,
            }))
        };
        Progress {
            how,
            done: AtomicU64::new(0),
            runs,
        }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        if let How::Bar(bar) = &self.how {
            bar.finish_and_clear();
        }
    }

    fn line(&self, lines: &Mutex<Lines>, done: u64) {
        // Whoever comes while another prints has nothing to add.
        let Ok(mut lines) = lines.try_lock() else {
            return;
        };
        if lines.last.elapsed() < EVERY {
            return;
        }
        lines.last = Instant::now();
        let rate = done as f64 / lines.begun.elapsed().as_secs_f64();
        let left = (self.runs.saturating_sub(done)) as f64 / rate;
        let text = format!(
            "cvtcycle: {done} of {} runs, {rate:.0} runs/s, {left:.0} s left\n",
            self.runs
        );
        // Where standard error is gone there is nobody to tell.
        drop(std::io::stderr().write_all(text.as_bytes()));
    }
}

fn style() -> ProgressStyle {
    let style = ProgressStyle::with_template(
        "{bar:30} {percent}%  {human_pos} of {human_len} runs  {rate}  {eta} left",
    );
    let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
    style.with_key(
        "rate",
        |state: &ProgressState, out: &mut dyn std::fmt::Write| {
            // Writing into a bar's text cannot fail.
            let _ = write!(out, "{:.0} runs/s", state.per_sec());
        },
    )
}

impl cvtcycle::study::Progress for Progress {
    fn advance(&self, runs: u64) {
        let done = self.done.fetch_add(runs, Ordering::Relaxed) + runs;
        match &self.how {
            How::Nothing => {}
            How::Bar(bar) => bar.inc(runs),
            How::Lines(lines) => self.line(lines, done),
        }
    }

    fn stopped(&self) -> bool {
        stop_asked()
    }
}

/// Whether somebody asked to stop.
pub fn stop_asked() -> bool {
    STOP.load(Ordering::Relaxed)
}

/// Listens for Ctrl-C: the first stops the study at the next run, the second ends the process.
pub fn listen() {
    // Only a second handler of this process could fail; the study then ends with the process, which loses nothing either.
    drop(ctrlc::set_handler(|| {
        if STOP.swap(true, Ordering::Relaxed) {
            std::process::exit(i32::from(INTERRUPTED));
        }
    }));
}
