/// How far a render has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Progress {
    /// Samples taken so far, all pixels together.
    pub samples_done: u64,
    /// Samples asked for, all pixels together.
    pub samples_total: u64,
}

/// Watches a render, and may stop it. Methods are called from worker threads, often: they should
/// return at once.
pub trait Monitor: Sync {
    /// Called after each tile.
    fn progress(&self, _progress: Progress) {}

    /// Asked before each bounce of each tile; `true` ends the render with what is whole so far.
    fn cancelled(&self) -> bool {
        false
    }
}

/// Watches nothing.
impl Monitor for () {}
