use super::facet::{mirror_image, reflection};
use super::light_clusters::{Cluster, LightClusters};
use super::mirror_tree::{
    CellView, Choice, KnownImportances, Leaf, MirrorBounds, MirrorImportance, MirrorOctree, MirrorTree, Root,
    TriangleLeaf, Viewpoint,
};
use super::triangle_map::TriangleMap;
use crate::light::receiver::Receiver;
use crate::light::triangle_part::TrianglePart;
use glam::DVec3;
use globillum_geom::{Aabb, PdfArea, PdfSolidAngle, SurfacePoint, Triangle, Triangles};

/// Mirror triangles that look smaller than the lights which they show. A point on such a triangle is sampled, and the ray
/// that is reflected there must hit a light.
#[derive(Clone, Debug)]
pub(crate) struct SmallMirrors {
    tree: MirrorTree,
    /// The leaves of the tree.
    leaves: Vec<TriangleLeaf>,
    /// One for each cluster of lights; none if all choices are descents in the tree.
    octrees: Vec<MirrorOctree>,
    /// By their place in the tree.
    mirrors: Vec<SmallMirror>,
    /// The places of the parts of each triangle, one after the other.
    places: Vec<u32>,
    /// Where those of each triangle begin.
    first_places: TriangleMap,
    clusters: LightClusters,
}

/// A mirror triangle or a part of one.
#[derive(Clone, Copy, Debug)]
pub(super) struct SmallMirror {
    pub(super) triangle: u32,
    pub(super) part: TrianglePart,
}

/// A small mirror that was chosen to show a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ChosenMirror {
    cluster: u32,
    /// For lights of the cluster.
    choice: Choice,
}

/// A point on a mirror triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MirrorPoint {
    pub(crate) triangle: u32,
    pub(crate) point: SurfacePoint,
    /// Unit direction from the receiver.
    pub(crate) direction: DVec3,
    /// The density per steradian of all directions sampled at the vertex, for a light of the cluster, if mirrors were chosen
    /// of one candidate each.
    pub(crate) pdf: PdfSolidAngle,
    /// What is found counts this many times `1 / pdf`: in the mean, once.
    pub(crate) weight: f64,
    /// The cluster whose lights count.
    pub(crate) cluster: u32,
}

impl SmallMirrors {
    /// The expected number of samples of a vertex per unit of the tree's importance: about a solid angle, in steradians, of
    /// mirrors that may show lights. The settings limit the number of samples.
    const ATTEMPTS: f64 = 480.0;

    /// The number of leaves of the tree of which one is chosen by its mirrors.
    const CANDIDATES: usize = 4;

    /// Builds the tree of one or more mirrors with their bounds. The parts of a triangle follow each other.
    pub(super) fn new(
        triangles: &Triangles,
        mirrors: &[(SmallMirror, MirrorBounds)],
        bodies: Vec<Aabb>,
        clusters: LightClusters,
    ) -> Self {
        let bounds: Vec<_> = mirrors.iter().map(|(_, bounds)| *bounds).collect();
        let (tree, order) = MirrorTree::new(triangles, &bounds, bodies);
        let mut places = vec![0; mirrors.len()];
        (0..).zip(&order).for_each(|(place, &mirror)| places[mirror as usize] = place);
        let first_parts = (0..).zip(mirrors).filter(|(_, (mirror, _))| mirror.part.number() == 0);
        let first_places = TriangleMap::new(first_parts.map(|(first, (mirror, _))| (mirror.triangle, first)));
        let leaves = tree.triangle_leaves(|place| {
            let (SmallMirror { triangle, part }, bounds) = mirrors[order[place as usize] as usize];
            (bounds, part.vertices(triangles.get(triangle)))
        });
        let mirrors = order.iter().map(|&mirror| mirrors[mirror as usize].0).collect();
        let octree = |cluster| MirrorOctree::new(&tree, triangles, clusters.get(cluster).bounds, &leaves);
        let octrees = if MirrorOctree::pays(leaves.len(), clusters.len()) { clusters.len() } else { 0 };
        let octrees = (0..octrees as u32).map(octree).collect();
        Self { tree, leaves, octrees, mirrors, places, first_places, clusters }
    }

    /// The place of the mirror with this position on the triangle `index`; `None` if the triangle has none.
    fn place_at(&self, triangle: &Triangle, index: u32, position: DVec3) -> Option<u32> {
        let first = self.first_places.get(index)?;
        let part = self.mirrors[self.places[first as usize] as usize].part;
        Some(self.places[(first + part.number_at(triangle, position)) as usize])
    }

    /// The cluster of the light triangle `index`.
    pub(crate) fn cluster_of(&self, index: u32) -> Option<u32> {
        self.clusters.of_light(index)
    }

    /// Chooses for each receiver, by the number of the same index in `[0, 1)`, a cluster of lights and a mirror that may show
    /// part of it. `None` if none is chosen. Each choice is for one of `count` samples of its receiver.
    #[inline(never)]
    pub(crate) fn choose<const N: usize>(
        &self,
        receivers: [Receiver; N],
        count: u32,
        us: [f64; N],
    ) -> [Option<ChosenMirror>; N] {
        let attempts = Self::ATTEMPTS / f64::from(count);
        let (mut clusters, mut rests) = ([0; N], us);
        for i in 0..N {
            // The choice of a cluster leaves a number for that of a mirror.
            (clusters[i], rests[i]) = self.clusters.choose(us[i]);
        }
        let choices = self.choose_in_clusters(receivers, attempts, clusters, rests);
        std::array::from_fn(|i| choices[i].map(|choice| ChosenMirror { cluster: clusters[i], choice }))
    }

    /// Chooses for each receiver a mirror that may show this cluster of lights.
    #[inline(always)]
    fn choose_in_clusters<const N: usize>(
        &self,
        receivers: [Receiver; N],
        attempts: f64,
        clusters: [u32; N],
        us: [f64; N],
    ) -> [Option<Choice>; N] {
        let (mut views, mut choices, mut roots) = ([CellView::Empty; N], [None; N], [const { None }; N]);
        let mut known = KnownImportances::none();
        for i in 0..N {
            let is_like_last = i > 0 && (receivers[i], clusters[i]) == (receivers[i - 1], clusters[i - 1]);
            if is_like_last {
                views[i] = views[i - 1];
            } else {
                views[i] = self.view(receivers[i], clusters[i]);
                known.forget();
            }
            match views[i] {
                CellView::Empty => {}
                CellView::Listed(view) => {
                    choices[i] = self.tree.choose_listed::<{ Self::CANDIDATES }>(
                        &self.leaves,
                        view,
                        &mut known,
                        attempts,
                        us[i],
                    );
                }
                CellView::Unlisted if is_like_last => roots[i] = roots[i - 1],
                CellView::Unlisted => roots[i] = self.root(receivers[i], attempts, clusters[i]),
            }
        }
        if roots.iter().any(Option::is_some) {
            let by_descents = self.tree.choose::<_, N, { Self::CANDIDATES }>(&roots, us);
            for (choice, by_descent) in choices.iter_mut().zip(by_descents) {
                *choice = choice.or(by_descent);
            }
        }
        choices
    }

    /// What the cell of the receiver tells of the mirrors, for a sample of this cluster.
    #[inline(always)]
    fn view(&self, receiver: Receiver, cluster: u32) -> CellView<'_> {
        let octree = self.octrees.get(cluster as usize);
        octree.map_or(CellView::Unlisted, |octree| octree.view(&self.tree, &self.leaves, receiver))
    }

    /// The root of the tree, as the receiver sees it for a sample of this cluster.
    #[inline(always)]
    fn root(
        &self,
        receiver: Receiver,
        attempts: f64,
        cluster: u32,
    ) -> Option<Root<impl MirrorImportance + Copy>> {
        let lights = self.clusters.get(cluster).bounds;
        self.tree.root(
            &Viewpoint { receiver, lights },
            attempts,
            #[inline(always)]
            |leaf: &Leaf<'_>| self.leaves[leaf.number as usize].importance(leaf.query),
        )
    }

    /// The probability of choosing the mirror at `place` for a sample of this cluster; `None` if it is never chosen.
    #[inline(always)]
    fn prob(&self, receiver: Receiver, attempts: f64, cluster: u32, place: u32) -> Option<f64> {
        match self.view(receiver, cluster) {
            CellView::Empty => None,
            CellView::Listed(view) => self.tree.prob_of_listed(&self.leaves, view, attempts, place),
            CellView::Unlisted => self.tree.prob(&self.root(receiver, attempts, cluster)?, place),
        }
    }

    /// A point on a mirror chosen for one of `count` samples of the receiver, by `point` in `[0, 1)^2`. `None` if it shows no
    /// light of the cluster.
    #[inline(never)]
    pub(crate) fn sample(
        &self,
        triangles: &Triangles,
        receiver: Receiver,
        count: u32,
        ChosenMirror { cluster, choice: Choice { place, prob, weight } }: ChosenMirror,
        point: [f64; 2],
    ) -> Option<MirrorPoint> {
        let Cluster { bounds, prob: cluster_prob } = self.clusters.get(cluster);
        let (SmallMirror { triangle, part }, from) = (self.mirrors[place as usize], receiver.position);
        let (u, v) = part.barycentrics_in_triangle(Triangle::sample_uniform(point));
        let point = triangles.surface_point(triangle, u, v);
        let direction = (point.position - from).try_normalize()?;
        let reflected = reflection(direction, point.normal);
        if !bounds.may_be_hit_by(point.position, reflected) {
            return None;
        }
        let whole = triangles.get(triangle);
        let pdf = Plane::of(whole, from).pdf(whole.area() * part.area_share(), direction)?;
        let pdf = pdf.chosen_with(cluster_prob * prob).of_samples(count);
        (pdf.0 > 0.0).then_some(MirrorPoint { triangle, point, direction, pdf, weight, cluster })
    }

    /// The density per steradian of all `count` directions that [`SmallMirrors::sample`] samples, at the one that leads
    /// from the receiver by way of the mirror triangle `index` to the point `light` of a light; `None` if it never samples
    /// that.
    #[inline(never)]
    pub(crate) fn pdf(
        &self,
        triangles: &Triangles,
        receiver: Receiver,
        count: u32,
        index: u32,
        light: &SurfacePoint,
    ) -> Option<PdfSolidAngle> {
        let cluster = self.clusters.of_light(light.triangle)?;
        let (triangle, from) = (triangles.get(index), receiver.position);
        let plane = Plane::of(triangle, from);
        let (position, direction) = plane.reflection_to(light.position, from)?;
        let place = self.place_at(triangle, index, position)?;
        let prob = self.prob(receiver, Self::ATTEMPTS / f64::from(count), cluster, place)?;
        let area = triangle.area() * self.mirrors[place as usize].part.area_share();
        let pdf = plane.pdf(area, direction)?;
        let pdf = pdf.chosen_with(self.clusters.get(cluster).prob * prob).of_samples(count);
        (pdf.0 > 0.0).then_some(pdf)
    }
}

/// The plane of a triangle, as it is seen from a receiver.
struct Plane {
    normal: DVec3,
    /// The signed distance of the receiver.
    height: f64,
}

impl Plane {
    fn of(triangle: &Triangle, from: DVec3) -> Self {
        let normal = triangle.normal();
        Self { normal, height: normal.dot(from - triangle.vertices[0].as_dvec3()) }
    }

    /// Where the plane reflects the receiver, at `from`, to the position `to`, and the unit direction from the receiver's
    /// image, which has the same angle with the plane as that from the receiver.
    fn reflection_to(&self, to: DVec3, from: DVec3) -> Option<(DVec3, DVec3)> {
        let image = mirror_image(from, self.normal, self.height);
        let direction = (to - image).try_normalize()?;
        Some((image + self.distance_along(direction) * direction, direction))
    }

    /// The distance from the receiver to the plane along the unit `direction`.
    fn distance_along(&self, direction: DVec3) -> f64 {
        (self.height / self.normal.dot(direction)).abs()
    }

    /// The density per steradian of the unit `direction` toward a point that is uniform on this area of the plane.
    fn pdf(&self, area: f64, direction: DVec3) -> Option<PdfSolidAngle> {
        let (cos, distance) = (self.normal.dot(direction).abs(), self.distance_along(direction));
        PdfArea(1.0 / area).to_solid_angle(distance * distance, cos)
    }
}

#[cfg(test)]
impl SmallMirrors {
    /// The same mirrors, chosen by descents in the tree.
    pub(super) fn without_cells(self) -> Self {
        assert!(!self.octrees.is_empty());
        Self { octrees: Vec::new(), ..self }
    }

    /// For each leaf of which one has an importance to the receiver, whether it is in the list of its cell.
    pub(super) fn listed_leaves(&self, receiver: Receiver, light: u32) -> Vec<bool> {
        let octree = &self.octrees[self.clusters.of_light(light).expect("it emits") as usize];
        octree.leaves_with_importance(&self.tree, &self.leaves, receiver)
    }

    /// The place of the mirror chosen to show the cluster of `light`, with its probability.
    pub(super) fn choice(&self, receiver: Receiver, light: u32, attempts: f64, u: f64) -> Option<Choice> {
        self.choose_in_clusters([receiver], attempts, [self.clusters.of_light(light)?], [u])[0]
    }

    /// The probability of this choice of the mirror at `place`.
    pub(super) fn choice_prob(
        &self,
        receiver: Receiver,
        place: u32,
        light: u32,
        attempts: f64,
    ) -> Option<f64> {
        self.prob(receiver, attempts, self.clusters.of_light(light)?, place)
    }

    /// The probability of the choice of the mirror on the triangle `index` that reflects the receiver to the position `to` of
    /// `light`.
    pub(super) fn prob_to_reflect(
        &self,
        triangles: &Triangles,
        receiver: Receiver,
        index: u32,
        (light, to): (u32, DVec3),
    ) -> Option<f64> {
        let triangle = triangles.get(index);
        let (position, _) = Plane::of(triangle, receiver.position).reflection_to(to, receiver.position)?;
        let place = self.place_at(triangle, index, position)?;
        let Aabb { min, max } = self.mirrors[place as usize].part.bounds(triangle);
        let margin = 1e-6 * triangles.bounds().extent();
        assert!(
            position.cmpge(min.as_dvec3() - margin).all() && position.cmple(max.as_dvec3() + margin).all()
        );
        self.choice_prob(receiver, place, light, f64::INFINITY)
    }

    pub(super) fn len(&self) -> usize {
        self.mirrors.len()
    }
}
