//! Progress of a computation of many runs, and its end before it is done.

/// Receives progress from several threads at once.
pub trait Progress: Sync {
    /// Counts finished units of work: runs of a study, evaluations of a fit.
    fn advance(&self, count: u64);

    /// True if the computation is to stop now. What is finished is kept.
    fn stopped(&self) -> bool;
}

/// Ignores progress and never stops.
#[derive(Clone, Copy, Debug)]
pub struct NoProgress;

impl Progress for NoProgress {
    fn advance(&self, _: u64) {}

    fn stopped(&self) -> bool {
        false
    }
}
