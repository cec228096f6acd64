//! Progress of long computations: studies and fits report it and may be stopped.

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
