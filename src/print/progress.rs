//! Progress of a long computation on standard error: a bar on a terminal; elsewhere a line after one second if the
//! work is long, then every ten seconds; nothing with --quiet.

use std::io::{IsTerminal, Write};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use cvtcycle::output;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use super::Ending;

/// Interval of lines if standard error is not a terminal.
const INTERVAL: Duration = Duration::from_secs(10);
/// Delay of the first line, which estimates the time left.
const FIRST: Duration = Duration::from_secs(1);
/// Minimum time left for that line, s.
const WORTH_A_LINE_S: f64 = 4.0;

/// Set by Ctrl-C. SIGTERM ends the process at once like a kill; finished parts of a study remain.
static STOP: AtomicBool = AtomicBool::new(false);

/// Counts finished work and displays it.
pub struct Progress {
    display: Display,
    done: AtomicU64,
    begun: Instant,
    unit: &'static str,
    /// Total, if known.
    total: Option<u64>,
}

enum Display {
    None,
    Bar(ProgressBar),
    /// Time of the last line.
    Lines(Mutex<Option<Instant>>),
}

impl Progress {
    /// Counts a known number of units of work, such as runs of a study.
    pub fn counted(unit: &'static str, total: u64, quiet: bool) -> Self {
        let bar = format!(
            "{{bar:30}} {{percent}}%  {{human_pos}} of {{human_len}} {unit}  {{rate}} {unit}/s  {{eta}} left"
        );
        Progress::new(unit, Some(total), &bar, quiet)
    }

    /// Counts evaluations of a search of unknown length.
    pub fn evaluations(quiet: bool) -> Self {
        let bar = "{spinner} {human_pos} evaluations  {elapsed}  Ctrl-C keeps the best so far";
        Progress::new("evaluations", None, bar, quiet)
    }

    fn new(unit: &'static str, total: Option<u64>, template: &str, quiet: bool) -> Self {
        let display = if quiet {
            Display::None
        } else if std::io::stderr().is_terminal() {
            let bar = ProgressBar::with_draw_target(total, ProgressDrawTarget::stderr());
            bar.set_style(style(template));
            // indicatif's ticker aborts the process if its thread cannot start, so a test thread is started first.
            if thread::Builder::new().spawn(|| ()).is_ok() {
                bar.enable_steady_tick(Duration::from_millis(200));
            }
            Display::Bar(bar)
        } else {
            Display::Lines(Mutex::new(None))
        };
        Progress {
            display,
            done: AtomicU64::new(0),
            begun: Instant::now(),
            unit,
            total,
        }
    }

    /// Removes the bar.
    pub fn finish(&self) {
        if let Display::Bar(bar) = &self.display {
            bar.finish_and_clear();
        }
    }

    fn show(&self, count: u64, done: u64) {
        match &self.display {
            Display::None => {}
            Display::Bar(bar) => bar.inc(count),
            Display::Lines(last) => {
                // Skips the update while another thread prints; the count is included in its line or in the next.
                let Ok(mut last) = last.try_lock() else {
                    return;
                };
                let waited = last.unwrap_or(self.begun).elapsed();
                let is_first = last.is_none() && waited >= FIRST;
                if waited >= INTERVAL || (is_first && self.left_s(done) >= Some(WORTH_A_LINE_S)) {
                    *last = Some(Instant::now());
                    // A failing standard error leaves no stream for a message.
                    drop(std::io::stderr().write_all(self.line(done).as_bytes()));
                }
            }
        }
    }

    /// Time left at the current rate, s. None if the total is unknown.
    fn left_s(&self, done: u64) -> Option<f64> {
        let rate = done as f64 / self.begun.elapsed().as_secs_f64();
        self.total
            .map(|total| total.saturating_sub(done) as f64 / rate)
    }

    fn line(&self, done: u64) -> String {
        let (unit, seconds) = (self.unit, self.begun.elapsed().as_secs_f64());
        let (Some(total), Some(left)) = (self.total, self.left_s(done)) else {
            return format!("cvtcycle: {done} {unit}, {seconds:.0} s\n");
        };
        let rate = done as f64 / seconds;
        format!("cvtcycle: {done} of {total} {unit}, {rate:.0} {unit}/s, {left:.0} s left\n")
    }
}

fn style(template: &str) -> ProgressStyle {
    let style = ProgressStyle::with_template(template);
    let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
    style.with_key(
        "rate",
        |state: &ProgressState, out: &mut dyn std::fmt::Write| {
            // Writing to a string is infallible.
            let _ = write!(out, "{:.0}", state.per_sec());
        },
    )
}

impl output::progress::Progress for Progress {
    fn advance(&self, count: u64) {
        let done = self.done.fetch_add(count, Ordering::Relaxed) + count;
        self.show(count, done);
    }

    fn stopped(&self) -> bool {
        STOP.load(Ordering::Relaxed)
    }
}

/// Handles Ctrl-C: the first stops the computation at its next step, the second ends the process.
pub fn handle_interrupts() {
    // Fails only if the process already has a handler.
    drop(ctrlc::set_handler(|| {
        if STOP.swap(true, Ordering::Relaxed) {
            std::process::exit(i32::from(Ending::Interrupted.code()));
        }
    }));
}
