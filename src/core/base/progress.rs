//! How a long step reports its progress to the caller. It prints nothing itself.

/// Receives progress. All methods do nothing by default; `&()` ignores all progress.
pub trait Progress: Sync {
    /// A step starts; `total` is its amount of work in the step's own unit, 0 if unknown.
    fn start(&self, _step: &'static str, _total: u64) {}
    /// The running step has done this much more work.
    fn advance(&self, _amount: u64) {}
    /// The running step is over.
    fn finish(&self) {}
}

impl Progress for () {}

/// Runs a step that reports no progress of its own.
pub fn step<T>(progress: &dyn Progress, name: &'static str, work: impl FnOnce() -> T) -> T {
    progress.start(name, 0);
    let result = work();
    progress.finish();
    result
}
