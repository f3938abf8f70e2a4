//! Path guiding: diffuse vertices scatter by what training paths found (after Müller, Gross and Novák 2017), or look where
//! photons came from.

mod directions;
mod learning;
mod photon_guide;
mod vertex_tree;

pub(crate) use directions::{Directions, bin_of};
pub(crate) use photon_guide::{Photon, PhotonGuide};
pub(crate) use vertex_tree::{GuideVertex, guide_vertex};

use vertex_tree::VertexTree;

/// Distributions of directions, for cells of path vertices that are near to each other.
#[derive(Debug)]
pub(crate) struct Guide {
    tree: VertexTree,
    cells: Vec<Directions>,
}

/// A cell of a guide.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GuideCell<'a> {
    pub(crate) index: u32,
    pub(crate) directions: &'a Directions,
}

/// A vertex of a training path, from which the path went on in a direction sampled by the cosine.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GuideRecord {
    pub(crate) vertex: GuideVertex,
    /// The [bin](bin_of) of the direction.
    pub(crate) bin: u8,
    /// The radiance that the path found up to its next record: what scattering in this direction has to find. Light that
    /// next event estimation at the vertex finds is left out, by its weight.
    pub(crate) radiance: f64,
    /// The index of the next record of the path, and the factor from radiance there to radiance here.
    pub(crate) next: Option<(u32, f64)>,
}

impl Guide {
    /// The indices of the cells of vertices.
    #[inline(always)]
    pub(crate) fn cells<const N: usize>(&self, vertices: &[GuideVertex; N]) -> [u32; N] {
        self.tree.cells(vertices).map(|cell| cell as u32)
    }

    /// The cell of an index.
    #[inline(always)]
    pub(crate) fn cell(&self, index: u32) -> GuideCell<'_> {
        GuideCell { index, directions: &self.cells[index as usize] }
    }
}
