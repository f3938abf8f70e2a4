/// Counts what a search does. The no-op `()` compiles to nothing.
pub trait Probe {
    /// An inner node of a tree, or a grid cell, was visited.
    #[inline]
    fn visit(&mut self) {}
    /// A leaf of a tree, or a grid cell that holds triangles, was opened.
    #[inline]
    fn open(&mut self) {}
    /// A triangle was decided.
    #[inline]
    fn test(&mut self) {}
}

impl Probe for () {}

/// Totals over any number of searches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Inner nodes or cells visited.
    pub visits: u64,
    /// Leaves or occupied cells opened.
    pub opened: u64,
    /// Triangles decided, repetitions included.
    pub tests: u64,
}

impl Probe for Counts {
    fn visit(&mut self) {
        self.visits += 1;
    }
    fn open(&mut self) {
        self.opened += 1;
    }
    fn test(&mut self) {
        self.tests += 1;
    }
}
