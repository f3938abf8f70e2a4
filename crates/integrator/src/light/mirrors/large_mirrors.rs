use super::facet::Facet;
use super::light_bounds::LightBounds;
use super::mirror_tree::{Choice, Leaf, MirrorBounds, MirrorTree, Viewpoint};
use super::triangle_map::TriangleMap;
use crate::light::child_weights::{WIDTH, child_of};
use crate::light::receiver::Receiver;
use glam::DVec3;
use globillum_geom::{Aabb, Triangles};

/// Facets in which lights are sampled by the image method.
///
/// A point `x` sees in a facet, a plane mirror, what its image `x'`, on the other side of the plane, sees through the
/// facet's triangles. Reflection is an isometry: the density of a direction at `x'` is that of the reflected direction
/// at `x`.
#[derive(Clone, Debug)]
pub(crate) struct LargeMirrors {
    tree: MirrorTree,
    facets: Vec<Facet>,
    /// The facet of each triangle.
    facet_of: TriangleMap,
    /// Around all area lights.
    lights: LightBounds,
}

/// A facet, chosen for a receiver.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChosenFacet<'a> {
    pub(crate) facet: &'a Facet,
    /// The index of the facet.
    pub(crate) index: u32,
    /// The probability of the choice, above zero.
    pub(crate) prob: f64,
}

impl LargeMirrors {
    /// Of one or more `facets`.
    pub(super) fn new(
        triangles: &Triangles,
        facets: &[Facet],
        bodies: Vec<Aabb>,
        lights: LightBounds,
    ) -> Self {
        let bounds = |facet: &Facet| MirrorBounds {
            bounds: Aabb::around(facet.triangles.iter().flat_map(|&index| triangles.get(index).vertices)),
            normal: facet.normal,
            area: facet.area(triangles),
            body: facet.body,
        };
        let bounds: Vec<_> = facets.iter().map(bounds).collect();
        let (tree, order) = MirrorTree::new(triangles, &bounds, bodies);
        let facets: Vec<_> = order.iter().map(|&facet| facets[facet as usize].clone()).collect();
        let of_facet =
            |(place, facet): (u32, &Facet)| facet.triangles.clone().into_iter().map(move |t| (t, place));
        let facet_of = TriangleMap::new((0..).zip(&facets).flat_map(of_facet));
        Self { tree, facets, facet_of, lights }
    }

    /// The index of the facet that triangle `index` belongs to.
    pub(crate) fn facet_of(&self, index: u32) -> Option<u32> {
        self.facet_of.get(index)
    }

    /// Chooses a facet that may show a light to the receiver, by a number in `[0, 1)` that `draw` returns; `None` if there is
    /// none.
    #[inline(never)]
    pub(crate) fn choose(
        &self,
        triangles: &Triangles,
        receiver: Receiver,
        draw: impl Fn() -> f64,
    ) -> Option<ChosenFacet<'_>> {
        let importance = |leaf: &Leaf<'_>| self.importance(triangles, receiver.position, leaf);
        let root = self.tree.root(&self.viewpoint(receiver), f64::INFINITY, importance)?;
        let [choice] = self.tree.choose::<_, 1, 1>(&[Some(root)], [draw()]);
        let Choice { place: index, prob, .. } = choice?;
        Some(ChosenFacet { facet: &self.facets[index as usize], index, prob })
    }

    /// What [`LargeMirrors::choose`] returns if it chooses this facet; `None` if it never does.
    #[inline(never)]
    pub(crate) fn chosen(
        &self,
        triangles: &Triangles,
        receiver: Receiver,
        index: u32,
    ) -> Option<ChosenFacet<'_>> {
        let importance = |leaf: &Leaf<'_>| self.importance(triangles, receiver.position, leaf);
        let root = self.tree.root(&self.viewpoint(receiver), f64::INFINITY, importance)?;
        let prob = self.tree.prob(&root, index)?;
        Some(ChosenFacet { facet: &self.facets[index as usize], index, prob })
    }

    /// The importance of the facets of a leaf, by lane: 0 for those that show no light to `from`.
    fn importance(&self, triangles: &Triangles, from: DVec3, leaf: &Leaf<'_>) -> [f64; WIDTH] {
        let mut importance = leaf.node.importance(leaf.query);
        for (lane, importance) in
            importance.iter_mut().enumerate().filter(|(_, importance)| **importance > 0.0)
        {
            let facet = &self.facets[leaf.node.first as usize + child_of(lane)];
            let is_outside = facet.body.is_some_and(|body| self.tree.is_outside(body, from));
            if !facet.may_show(triangles, &self.lights, from, is_outside) {
                *importance = 0.0;
            }
        }
        importance
    }

    fn viewpoint(&self, receiver: Receiver) -> Viewpoint {
        Viewpoint { receiver, lights: self.lights }
    }
}
