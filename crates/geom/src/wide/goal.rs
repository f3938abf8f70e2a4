//! What a search is after.

use crate::Ray;
use crate::search::{Any, Closest, Search};

/// A search that knows what to do with a hit that is certain before it is decided.
pub(super) trait Goal: Search + Copy {
    /// Whether any certain hit is the answer.
    const ANY: bool;

    /// The search before it begins.
    fn begin(ray: &Ray) -> Self;

    /// The search with its answer, if any hit is one.
    #[must_use]
    fn sure(self) -> Self;
}

impl Goal for Closest {
    const ANY: bool = false;

    #[inline(always)]
    fn begin(ray: &Ray) -> Self {
        Self::new(ray)
    }

    #[inline(always)]
    fn sure(self) -> Self {
        self
    }
}

impl Goal for Any {
    const ANY: bool = true;

    #[inline(always)]
    fn begin(ray: &Ray) -> Self {
        Self::new(ray)
    }

    #[inline(always)]
    fn sure(self) -> Self {
        self.found_one()
    }
}
