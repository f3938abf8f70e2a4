use super::light_clusters::LightClusters;
use super::mirror_tree::{FacetBounds, MirrorTree, Root, Viewpoint};
use super::receiver::Receiver;
use super::viewpoints::viewpoints;
use glam::DVec3;
use globillum_geom::{Aabb, PdfArea, PdfSolidAngle, SurfacePoint, Triangle, Triangles};

/// Mirror triangles that look smaller than the lights which they show: points on them are sampled, as on windows
/// through which lights may be seen.
#[derive(Clone, Debug)]
pub(crate) struct WindowMirrors {
    tree: MirrorTree,
    /// By their place in the tree.
    windows: Vec<u32>,
    /// The triangles in ascending order, each with its place.
    places: Vec<(u32, u32)>,
    clusters: LightClusters,
}

/// A point on a mirror triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WindowSample {
    pub(crate) triangle: u32,
    pub(crate) point: SurfacePoint,
    /// Unit direction from the shading point.
    pub(crate) direction: DVec3,
    /// The density per steradian of all directions sampled at the vertex, for a light of the cluster.
    pub(crate) pdf: PdfSolidAngle,
    /// The cluster whose lights count.
    pub(crate) cluster: u32,
}

impl WindowMirrors {
    /// The samples of a vertex, at most as many as are asked for, over the solid angle, about, of the triangles that show
    /// lights.
    const ATTEMPTS: f64 = 480.0;

    /// Of one or more triangles, each with what the tree is told of it.
    pub(super) fn new(
        triangles: &Triangles,
        windows: &[(u32, FacetBounds)],
        bodies: Vec<Aabb>,
        clusters: LightClusters,
    ) -> Self {
        let bounds: Vec<_> = windows.iter().map(|(_, bounds)| *bounds).collect();
        let (tree, order) = MirrorTree::new(triangles, &bounds, bodies);
        let windows: Vec<_> = order.iter().map(|&window| windows[window as usize].0).collect();
        let mut places: Vec<_> = windows.iter().copied().zip(0..).collect();
        places.sort_unstable();
        let mirrors: Vec<_> = places.iter().map(|&(triangle, _)| triangle).collect();
        let tree = tree.calibrated(&viewpoints(triangles, &mirrors, &clusters));
        Self { tree, windows, places, clusters }
    }

    /// The cluster of the light triangle `index`.
    pub(crate) fn cluster_of(&self, index: u32) -> Option<u32> {
        self.clusters.of_light(index)
    }

    /// Samples up to `count` windows for the receiver.
    pub(crate) fn sampler<'a>(
        &'a self,
        triangles: &'a Triangles,
        receiver: Receiver,
        count: u32,
    ) -> WindowSampler<'a> {
        WindowSampler { mirrors: self, triangles, receiver, count, root: None }
    }

    /// The density per steradian of all `count` directions that [`WindowSampler::sample`] samples, at the one that leads
    /// from the receiver by way of the mirror triangle `index` to `position` on the light triangle `light`; `None` if it never
    /// samples that.
    #[inline(never)]
    pub(crate) fn pdf(
        &self,
        triangles: &Triangles,
        receiver: Receiver,
        count: u32,
        index: u32,
        (light, position): (u32, DVec3),
    ) -> Option<PdfSolidAngle> {
        let place = self.places.binary_search_by_key(&index, |&(triangle, _)| triangle).ok()?;
        let (cluster_prob, lights) = self.clusters.bounds(self.clusters.of_light(light)?);
        let at = Viewpoint { receiver, lights };
        let root = self.tree.root(&at, Self::ATTEMPTS / f64::from(count), |_| true)?;
        let prob = self.tree.prob(&root, self.places[place].1, |_| true)?;
        let (triangle, from) = (triangles.get(index), receiver.position);
        let (normal, height) = plane(triangle, from);
        let image = from - 2.0 * height * normal;
        // At the image, the direction has the same angle with the plane.
        let pdf = pdf(triangle, from, (position - image).try_normalize()?)?;
        let pdf = pdf.chosen_with(cluster_prob * prob).of_samples(count);
        (pdf.0 > 0.0).then_some(pdf)
    }
}

/// Samples the windows that may show lights to one shading point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WindowSampler<'a> {
    mirrors: &'a WindowMirrors,
    triangles: &'a Triangles,
    receiver: Receiver,
    count: u32,
    /// The cluster of lights of the last sample, with what the root of the tree says of it.
    root: Option<(u32, Option<Root>)>,
}

impl WindowSampler<'_> {
    /// Samples a cluster of lights and a mirror triangle that may show part of it, by `window`, which returns a number in
    /// `[0, 1)`, and a point on that, by `point`, which returns one in `[0, 1)^2`. `None` if there is none, or the point
    /// shows no light of the cluster.
    #[inline(never)]
    pub(crate) fn sample(
        &mut self,
        window: impl Fn() -> f64,
        point: impl Fn() -> [f64; 2],
    ) -> Option<WindowSample> {
        let WindowMirrors { tree, windows, clusters, .. } = self.mirrors;
        // The choice of one cluster of several leaves a number for that of a window.
        let (cluster, rest) = match clusters.len() {
            1 => (0, None),
            _ => clusters.choose(window()).map(|(cluster, rest)| (cluster, Some(rest)))?,
        };
        let (cluster_prob, lights) = clusters.bounds(cluster);
        let from = self.receiver.position;
        let at = Viewpoint { receiver: self.receiver, lights };
        let known = self.root.filter(|(of, _)| *of == cluster).map(|(_, root)| root);
        let attempts = WindowMirrors::ATTEMPTS / f64::from(self.count);
        let root = known.unwrap_or_else(|| tree.root(&at, attempts, |_| true));
        self.root = Some((cluster, root));
        let (place, prob) = tree.choose(&root?, || rest.unwrap_or_else(&window), |_| true)?;
        let triangle = windows[place as usize];
        let (u, v) = Triangle::sample_uniform(point());
        let point = self.triangles.surface_point(triangle, u, v);
        let direction = (point.position - from).try_normalize()?;
        let reflected = direction - 2.0 * point.normal.dot(direction) * point.normal;
        if !lights.may_be_hit_by(point.position, reflected) {
            return None;
        }
        let pdf = pdf(self.triangles.get(triangle), from, direction)?;
        let pdf = pdf.chosen_with(cluster_prob * prob).of_samples(self.count);
        (pdf.0 > 0.0).then_some(WindowSample { triangle, point, direction, pdf, cluster })
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
impl WindowMirrors {
    /// The triangle chosen to show the cluster of `light`, with its probability.
    pub(super) fn choose(&self, receiver: Receiver, light: u32, attempts: f64, u: f64) -> Option<(u32, f64)> {
        let (_, lights) = self.clusters.bounds(self.clusters.of_light(light)?);
        let root = self.tree.root(&Viewpoint { receiver, lights }, attempts, |_| true)?;
        let (place, prob) = self.tree.choose(&root, || u, |_| true)?;
        Some((self.windows[place as usize], prob))
    }

    /// The probability of this choice of triangle `index`.
    pub(super) fn choice_prob(
        &self,
        receiver: Receiver,
        index: u32,
        light: u32,
        attempts: f64,
    ) -> Option<f64> {
        let place = self.places.binary_search_by_key(&index, |&(triangle, _)| triangle).ok()?;
        let (_, lights) = self.clusters.bounds(self.clusters.of_light(light)?);
        let root = self.tree.root(&Viewpoint { receiver, lights }, attempts, |_| true)?;
        self.tree.prob(&root, self.places[place].1, |_| true)
    }
}
