/// The progress of a loader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct LoadProgress {
    /// Finished work: bytes of OBJ, or triangles of glTF.
    pub done: u64,
    /// All work, in the same unit.
    pub total: u64,
}

/// Observes a loader and may stop it. The methods are called often and should return at once.
pub trait LoadMonitor {
    /// Called at regular intervals of work.
    fn progress(&self, _progress: LoadProgress) {}

    /// Called after [`progress`](LoadMonitor::progress); `true` ends loading with
    /// [`IoError::Cancelled`](crate::IoError::Cancelled).
    fn cancelled(&self) -> bool {
        false
    }
}

/// Ignores progress and never cancels.
impl LoadMonitor for () {}
