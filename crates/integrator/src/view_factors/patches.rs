use super::FactorError;
use globillum_geom::Triangles;

/// A division of triangles into patches, numbered from 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Patches {
    /// The patch of each triangle.
    ids: Vec<u32>,
    count: usize,
}

impl Patches {
    /// `count` patches, or as many as `ids` name if these are more: the patch of each triangle, in the order of these.
    pub fn new(count: u32, ids: Vec<u32>) -> Self {
        let named = ids.iter().max().map_or(0, |&last| last as usize + 1);
        Self { ids, count: named.max(count as usize) }
    }

    /// Each of `count` triangles as a patch of its own.
    pub fn of_triangles(count: u32) -> Self {
        Self { ids: (0..count).collect(), count: count as usize }
    }

    /// The number of patches.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there is no patch.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The patch of each triangle.
    pub fn ids(&self) -> &[u32] {
        &self.ids
    }

    /// The area of the triangles of each patch, in squared units of length.
    ///
    /// # Errors
    /// [`FactorError::Patches`] if the patches are not those of these triangles, [`FactorError::EmptyPatch`] for a
    /// patch without area.
    pub fn areas(&self, triangles: &Triangles) -> Result<Vec<f64>, FactorError> {
        let (patched, triangle_count) = (self.ids.len(), triangles.len());
        if patched != triangle_count {
            return Err(FactorError::Patches { patched, triangles: triangle_count });
        }
        // Of more patches than triangles one is empty: no more than the first ones need be looked at.
        let mut areas = vec![0.0; self.count.min(patched + 1)];
        for &triangle in triangles.live() {
            if let Some(area) = areas.get_mut(self.ids[triangle as usize] as usize) {
                *area += triangles.get(triangle).area();
            }
        }
        match areas.iter().position(|&area| area == 0.0) {
            Some(patch) => Err(FactorError::EmptyPatch { patch: patch as u32 }),
            None => Ok(areas),
        }
    }
}
