//! How a long step tells its caller how far it is, without printing anything itself.

/// Receives progress. All methods do nothing by default; `&()` is the silent one.
pub trait Progress: Sync {
    /// A step starts; `total` is its amount of work in the step's own unit, 0 if unknown.
    fn start(&self, _step: &'static str, _total: u64) {}
    /// So much more of the running step's work is done.
    fn advance(&self, _amount: u64) {}
    /// The running step is over.
    fn finish(&self) {}
}

impl Progress for () {}

/// Runs a step that tells no progress of its own.
pub fn step<T>(progress: &dyn Progress, name: &'static str, work: impl FnOnce() -> T) -> T {
    progress.start(name, 0);
    let result = work();
    progress.finish();
    result
}
