use crate::checked_accel;
use crate::light::{AreaLightSample, ChosenMirror, LightSample, MirrorPoint, SmallMirrors};
use crate::path::emission_rays::reflected_ray;
use crate::path::path_state::Path;
use crate::path::path_vertex::{PathVertex, PriorChoice};
use crate::path::radiance_sums::{Contribution, Target};
use crate::path::render_context::RenderContext;
use crate::sampler::{MirrorSize, Numbers};
use globillum_geom::{Hit, Ray};
use globillum_material::{Bsdf, Rgb};

/// Light samples by way of small mirrors: points on mirror triangles that may show a light. Its buffers are reused.
#[derive(Debug, Default)]
pub(in crate::path) struct SmallMirrorRays {
    samples: Vec<Sample>,
    /// The ray of each sample, which must hit the mirror.
    rays: Vec<Ray>,
    /// The samples whose rays did, and the rays that leave the mirror.
    reflected: Vec<Sample>,
    reflected_rays: Vec<Ray>,
    hits: Vec<Option<Hit>>,
    /// What the samples contribute that have found a light.
    pub(in crate::path) found: Vec<Contribution>,
}

/// A point on a mirror triangle.
#[derive(Clone, Copy, Debug)]
struct Sample {
    target: Target,
    /// The contribution for each unit of the light's radiance; at first as if the mirror reflected all light.
    radiance: Rgb,
    /// The index of the mirror triangle.
    triangle: u32,
    /// The index of the cluster whose lights count.
    cluster: u32,
}

impl SmallMirrorRays {
    pub(in crate::path) fn clear(&mut self) {
        self.samples.clear();
        self.rays.clear();
        self.reflected.clear();
        self.reflected_rays.clear();
        self.found.clear();
    }

    /// The number of rays, to mirrors and from mirrors.
    pub(in crate::path) fn len(&self) -> usize {
        self.rays.len() + self.reflected_rays.len()
    }

    /// Samples points on mirrors for a diffuse vertex of a path.
    pub(in crate::path) fn sample(
        &mut self,
        context: &RenderContext<'_>,
        path: &Path,
        vertex: &PathVertex<'_>,
    ) {
        let Some(mirrors) = context.small_mirrors() else { return };
        let count = context.small_mirror_samples(vertex.is_first);
        let mut add = |chosen: ChosenMirror, point: [f64; 2]| {
            let (triangles, receiver) = (context.scene.triangles(), vertex.at.receiver());
            let Some(sample) = mirrors.sample(triangles, receiver, count, chosen, point) else { return };
            let MirrorPoint { triangle, point, direction, pdf, weight, cluster } = sample;
            let seen = LightSample::Area(AreaLightSample { point, direction, radiance: Rgb::WHITE, pdf });
            let Some(radiance) = context.light_contribution(path, vertex, &seen) else { return };
            self.rays.push(vertex.at.point.spawn_ray(direction));
            let radiance = weight * radiance;
            self.samples.push(Sample { target: path.target, radiance, triangle, cluster });
        };
        match (vertex.small_mirror, count) {
            (PriorChoice::Made(chosen), _) => {
                let point = || path.numbers.light_in_mirror(MirrorSize::Small, vertex.bounce).1;
                chosen.into_iter().for_each(|chosen| add(chosen, point()));
            }
            (PriorChoice::Open, 1) => choose::<1>(context, mirrors, path, vertex, count, add),
            (PriorChoice::Open, 2) => choose::<2>(context, mirrors, path, vertex, count, add),
            // A power of two.
            (PriorChoice::Open, _) => choose::<4>(context, mirrors, path, vertex, count, add),
        }
    }

    /// Follows the rays of the samples by way of their mirrors, and keeps what they find of lights.
    pub(in crate::path) fn trace(&mut self, context: &RenderContext<'_>) {
        let Some(mirrors) = context.small_mirrors() else { return };
        let (scene, accel) = (context.scene, context.scene.accel());
        checked_accel::intersect(accel, &self.rays, &mut self.hits);
        for (sample, (ray, hit)) in self.samples.iter().zip(self.rays.iter().zip(&self.hits)) {
            let Some(hit) = hit.filter(|hit| hit.triangle == sample.triangle) else { continue };
            let Bsdf::Mirror(reflectance) = scene.material(hit.triangle).bsdf else { continue };
            let radiance = sample.radiance * reflectance.rgb();
            if !radiance.is_black() {
                let point = scene.triangles().surface_point(hit.triangle, hit.u, hit.v);
                self.reflected_rays.push(reflected_ray(&point, ray.direction));
                self.reflected.push(Sample { radiance, ..*sample });
            }
        }
        checked_accel::intersect(accel, &self.reflected_rays, &mut self.hits);
        for (sample, (ray, hit)) in self.reflected.iter().zip(self.reflected_rays.iter().zip(&self.hits)) {
            let Some(hit) = hit else { continue };
            let emitted = scene.interaction(ray, hit).emitted();
            if !emitted.is_black() && mirrors.cluster_of(hit.triangle) == Some(sample.cluster) {
                let radiance = sample.radiance * emitted;
                self.found.push(Contribution { target: sample.target, radiance });
            }
        }
    }
}

/// Chooses `N` at a time of the small mirrors for `count` samples of a vertex, and calls `add` with each and two numbers for
/// a point on it. `N` divides `count`.
fn choose<const N: usize>(
    context: &RenderContext<'_>,
    mirrors: &SmallMirrors,
    path: &Path,
    vertex: &PathVertex<'_>,
    count: u32,
    mut add: impl FnMut(ChosenMirror, [f64; 2]),
) {
    let (size, bounce) = (MirrorSize::Small, vertex.bounce);
    for first in (0..count).step_by(N) {
        let parts: [_; N] = path.numbers.parts(first, count);
        let us = context.simd.run(
            #[inline(always)]
            || Numbers::mirrors(&parts, size, bounce),
        );
        let chosen = mirrors.choose([vertex.at.receiver(); N], count, us);
        if chosen.iter().all(Option::is_none) {
            continue;
        }
        let points = context.simd.run(
            #[inline(always)]
            || Numbers::lights_in_mirrors(&parts, size, bounce),
        );
        for (chosen, (_, point)) in chosen.into_iter().zip(points) {
            if let Some(chosen) = chosen {
                add(chosen, point);
            }
        }
    }
}
