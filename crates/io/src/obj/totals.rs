use super::source::{Source, Statement};
use crate::Limits;

/// What a file declares, counted before memory is made for it: what grows while it is read takes up
/// to three times as much.
#[derive(Default)]
pub(super) struct Totals {
    pub(super) vertices: usize,
    /// Of all faces, degenerate ones too, up to as many as are allowed.
    pub(super) triangles: usize,
    /// Of the largest polygon, up to as many as are allowed.
    pub(super) corners: usize,
}

impl Totals {
    pub(super) fn of(source: &Source, limits: &Limits) -> Self {
        let mut totals = Self::default();
        source.statements().for_each(|statement| totals.count(&statement));
        let allowed = |count: usize, limit: u64| (count as u64).min(limit) as usize;
        totals.triangles = allowed(totals.triangles, limits.triangles);
        totals.corners = allowed(totals.corners, limits.polygon_corners);
        totals
    }

    fn count(&mut self, statement: &Statement<'_>) {
        match statement.keyword {
            "v" => self.vertices += 1,
            "f" => {
                let corners = statement.words().count();
                self.triangles += corners.saturating_sub(2);
                self.corners = self.corners.max(corners);
            }
            _ => {}
        }
    }
}
