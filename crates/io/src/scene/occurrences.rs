use crate::scene::loading::Loading;
use crate::{Place, WarningKind};

/// The number of occurrences of something that a loader skips, and the place of the first.
#[derive(Default)]
pub(crate) struct Occurrences(Option<(Place, usize)>);

impl Occurrences {
    /// Adds `more` occurrences at `place`.
    pub(crate) fn add(&mut self, place: Place, more: usize) {
        if more > 0 {
            self.0.get_or_insert((place, 0)).1 += more;
        }
    }

    /// Adds a warning at the first place, if there is one.
    pub(crate) fn warn(&self, loading: &mut Loading<'_>, kind: impl FnOnce(usize) -> WarningKind) {
        if let Some((place, count)) = self.0 {
            loading.warn(place, kind(count));
        }
    }
}
