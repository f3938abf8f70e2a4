/// A number for each of some triangles.
#[derive(Clone, Debug)]
pub(super) struct TriangleMap(Vec<(u32, u32)>);

impl TriangleMap {
    /// Of triangle indices, each once, with their numbers.
    pub(super) fn new(numbers: impl IntoIterator<Item = (u32, u32)>) -> Self {
        let mut sorted: Vec<_> = numbers.into_iter().collect();
        sorted.sort_unstable();
        Self(sorted)
    }

    /// The number of the triangle `index`; `None` if it has none.
    pub(super) fn get(&self, index: u32) -> Option<u32> {
        let i = self.0.binary_search_by_key(&index, |&(triangle, _)| triangle).ok()?;
        Some(self.0[i].1)
    }
}
