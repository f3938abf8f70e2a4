use super::facet::{mirror_image, reflection};
use super::light_clusters::{Cluster, LightClusters};
use super::mirror_tree::{FacetBounds, MirrorTree, Root, Viewpoint};
use super::triangle_map::TriangleMap;
use super::viewpoints::viewpoints;
use crate::light::receiver::Receiver;
use glam::DVec3;
use globillum_geom::{Aabb, PdfArea, PdfSolidAngle, SurfacePoint, Triangle, Triangles};

/// Mirror triangles that look smaller than the lights which they show. A point on such a triangle is sampled, and the ray
/// that is reflected there must hit a light.
#[derive(Clone, Debug)]
pub(crate) struct SmallMirrors {
    tree: MirrorTree,
    /// By their place in the tree.
    triangles: Vec<u32>,
    /// The place of each triangle.
    places: TriangleMap,
    clusters: LightClusters,
}

/// A mirror triangle that was chosen to show a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ChosenMirror {
    cluster: u32,
    place: u32,
    /// The probability of the choice, for lights of the cluster.
    prob: f64,
}

/// A point on a mirror triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MirrorPoint {
    pub(crate) triangle: u32,
    pub(crate) point: SurfacePoint,
    /// Unit direction from the receiver.
    pub(crate) direction: DVec3,
    /// The density per steradian of all directions sampled at the vertex, for a light of the cluster.
    pub(crate) pdf: PdfSolidAngle,
    /// The cluster whose lights count.
    pub(crate) cluster: u32,
}

impl SmallMirrors {
    /// The expected number of samples of a vertex per unit of the tree's importance. The importance approximates the solid
    /// angle, in steradians, of the triangles that show lights. The settings limit the number of samples.
    const ATTEMPTS: f64 = 480.0;

    /// Builds the tree of one or more mirror triangles with their bounds.
    pub(super) fn new(
        triangles: &Triangles,
        mirrors: &[(u32, FacetBounds)],
        bodies: Vec<Aabb>,
        clusters: LightClusters,
    ) -> Self {
        let bounds: Vec<_> = mirrors.iter().map(|(_, bounds)| *bounds).collect();
        let (tree, order) = MirrorTree::new(triangles, &bounds, bodies);
        let in_order: Vec<_> = order.iter().map(|&mirror| mirrors[mirror as usize].0).collect();
        let mut mirrors = in_order.clone();
        mirrors.sort_unstable();
        let places = TriangleMap::new(in_order.iter().copied().zip(0..));
        let tree = tree.calibrated(&viewpoints(triangles, &mirrors, &clusters));
        Self { tree, triangles: in_order, places, clusters }
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
        let (mut clusters, mut roots, mut rests) = ([0; N], [const { None }; N], us);
        for i in 0..N {
            // The choice of a cluster leaves a number for that of a mirror.
            (clusters[i], rests[i]) = self.clusters.choose(us[i]);
            let is_like_last = i > 0 && (receivers[i], clusters[i]) == (receivers[i - 1], clusters[i - 1]);
            roots[i] =
                if is_like_last { roots[i - 1] } else { self.root(receivers[i], attempts, clusters[i]) };
        }
        let chosen = self.tree.choose(&roots, rests, |_| true);
        std::array::from_fn(|i| {
            chosen[i].map(|(place, prob)| ChosenMirror { cluster: clusters[i], place, prob })
        })
    }

    /// The root of the tree, as the receiver sees it for a sample of this cluster.
    fn root(&self, receiver: Receiver, attempts: f64, cluster: u32) -> Option<Root> {
        let lights = self.clusters.get(cluster).bounds;
        self.tree.root(&Viewpoint { receiver, lights }, attempts, |_| true)
    }

    /// A point on a mirror chosen for one of `count` samples of the receiver, by `point` in `[0, 1)^2`. `None` if it shows no
    /// light of the cluster.
    #[inline(never)]
    pub(crate) fn sample(
        &self,
        triangles: &Triangles,
        receiver: Receiver,
        count: u32,
        ChosenMirror { cluster, place, prob }: ChosenMirror,
        point: [f64; 2],
    ) -> Option<MirrorPoint> {
        let Cluster { bounds, prob: cluster_prob } = self.clusters.get(cluster);
        let (triangle, from) = (self.triangles[place as usize], receiver.position);
        let (u, v) = Triangle::sample_uniform(point);
        let point = triangles.surface_point(triangle, u, v);
        let direction = (point.position - from).try_normalize()?;
        let reflected = reflection(direction, point.normal);
        if !bounds.may_be_hit_by(point.position, reflected) {
            return None;
        }
        let pdf = pdf(triangles.get(triangle), from, direction)?;
        let pdf = pdf.chosen_with(cluster_prob * prob).of_samples(count);
        (pdf.0 > 0.0).then_some(MirrorPoint { triangle, point, direction, pdf, cluster })
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
        let place = self.places.get(index)?;
        let cluster = self.clusters.of_light(light.triangle)?;
        let root = self.root(receiver, Self::ATTEMPTS / f64::from(count), cluster)?;
        let prob = self.tree.prob(&root, place, |_| true)?;
        let (triangle, from) = (triangles.get(index), receiver.position);
        let (normal, height) = plane(triangle, from);
        let image = mirror_image(from, normal, height);
        // At the image, the direction has the same angle with the plane.
        let pdf = pdf(triangle, from, (light.position - image).try_normalize()?)?;
        let pdf = pdf.chosen_with(self.clusters.get(cluster).prob * prob).of_samples(count);
        (pdf.0 > 0.0).then_some(pdf)
    }
}

/// The normal of the triangle, and the signed distance of `from` from its plane.
fn plane(triangle: &Triangle, from: DVec3) -> (DVec3, f64) {
    let normal = triangle.normal();
    (normal, normal.dot(from - triangle.vertices[0].as_dvec3()))
}

/// The density per steradian of the unit `direction` toward a point of the triangle, uniform by area.
fn pdf(triangle: &Triangle, from: DVec3, direction: DVec3) -> Option<PdfSolidAngle> {
    let (normal, height) = plane(triangle, from);
    let cos = normal.dot(direction).abs();
    let distance = height / cos;
    PdfArea(1.0 / triangle.area()).to_solid_angle(distance * distance, cos)
}

#[cfg(test)]
impl SmallMirrors {
    /// The triangle chosen to show the cluster of `light`, with its probability.
    pub(super) fn choice(&self, receiver: Receiver, light: u32, attempts: f64, u: f64) -> Option<(u32, f64)> {
        let root = self.root(receiver, attempts, self.clusters.of_light(light)?)?;
        let [chosen] = self.tree.choose(&[Some(root)], [u], |_| true);
        chosen.map(|(place, prob)| (self.triangles[place as usize], prob))
    }

    /// The probability of this choice of triangle `index`.
    pub(super) fn choice_prob(
        &self,
        receiver: Receiver,
        index: u32,
        light: u32,
        attempts: f64,
    ) -> Option<f64> {
        let root = self.root(receiver, attempts, self.clusters.of_light(light)?)?;
        self.tree.prob(&root, self.places.get(index)?, |_| true)
    }
}
