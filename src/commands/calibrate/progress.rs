//! How far a fit is: nobody knows how many evaluations it will take, so they are counted. On a terminal all the time, elsewhere now and then,
//! with --quiet never. Always on standard error.

use std::io::{IsTerminal, Write};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::print::progress::stop_asked;

/// Between two lines where there is no terminal.
const EVERY: Duration = Duration::from_secs(10);

/// Looks on while a fit runs.
pub struct Progress {
    how: How,
    done: AtomicU64,
    begun: Instant,
}

enum How {
    Nothing,
    Spinner(ProgressBar),
    /// When the last line was written.
    Lines(Mutex<Instant>),
}

impl Progress {
    /// Begins to count.
    pub fn new(quiet: bool) -> Self {
        let begun = Instant::now();
        let how = if quiet {
            How::Nothing
        } else if std::io::stderr().is_terminal() {
            let spinner = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
            let style = ProgressStyle::with_template(
                "{spinner} {human_pos} evaluations  {elapsed}  Ctrl-C keeps the best so far",
            );
            spinner.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
            spinner.enable_steady_tick(Duration::from_millis(200));
            How::Spinner(spinner)
        } else {
            How::Lines(Mutex::new(begun))
        };
        Progress {
            how,
            done: AtomicU64::new(0),
            begun,
        }
    }

    /// Takes the spinner away.
    pub fn finish(&self) {
        if let How::Spinner(spinner) = &self.how {
            spinner.finish_and_clear();
        }
    }
}

impl cvtcycle::study::Progress for Progress {
    fn advance(&self, count: u64) {
        let done = self.done.fetch_add(count, Ordering::Relaxed) + count;
        match &self.how {
            How::Nothing => {}
            How::Spinner(spinner) => spinner.inc(count),
            How::Lines(last) => {
                // Whoever comes while another prints has nothing to add.
                let Ok(mut last) = last.try_lock() else {
                    return;
                };
                if last.elapsed() >= EVERY {
                    *last = Instant::now();
                    let text = format!(
                        "cvtcycle: {done} evaluations, {:.0} s\n",
                        self.begun.elapsed().as_secs_f64()
                    );
                    // Where standard error is gone there is nobody to tell.
                    drop(std::io::stderr().write_all(text.as_bytes()));
                }
            }
        }
    }

    fn stopped(&self) -> bool {
        stop_asked()
    }
}
