use crate::checked_accel;
use crate::light::{AreaLightSample, LargeMirrors, LightSample};
use crate::path::path_state::Path;
use crate::path::path_vertex::PathVertex;
use crate::path::radiance_sums::{Contribution, Target};
use crate::path::render_context::RenderContext;
use crate::sampler::MirrorSize;
use globillum_geom::{Hit, Ray, SurfacePoint};
use globillum_material::{Bsdf, Rgb};

/// Light samples by way of large mirrors: points on lights, sampled from the image of the receiver (image method).
/// Its buffers are reused.
#[derive(Debug, Default)]
pub(in crate::path) struct LargeMirrorRays {
    samples: Vec<Sample>,
    /// The ray of each sample, which must hit the mirror.
    rays: Vec<Ray>,
    hits: Vec<Option<Hit>>,
}

/// A point on a light as a mirror shows it.
#[derive(Clone, Copy, Debug)]
struct Sample {
    target: Target,
    /// The contribution if the mirror reflects all light.
    radiance: Rgb,
    /// The index of the facet.
    facet: u32,
    light: SurfacePoint,
}

impl LargeMirrorRays {
    pub(in crate::path) fn clear(&mut self) {
        self.samples.clear();
        self.rays.clear();
    }

    /// The number of rays to mirrors.
    pub(in crate::path) fn len(&self) -> usize {
        self.rays.len()
    }

    /// Samples a light for a diffuse vertex of a path.
    pub(in crate::path) fn sample(
        &mut self,
        context: &RenderContext<'_>,
        path: &Path,
        vertex: &PathVertex<'_>,
    ) {
        let Some(mirrors) = context.large_mirrors() else { return };
        let Some(LightInMirror { facet, light, seen }) = light_in_mirror(mirrors, context, path, vertex)
        else {
            return;
        };
        let Some(radiance) = context.light_contribution(path, vertex, &LightSample::Area(seen)) else {
            return;
        };
        self.rays.push(vertex.at.point.spawn_ray(seen.direction));
        self.samples.push(Sample { target: path.target, radiance, facet, light });
    }

    /// Turns each sample whose ray hits its mirror into a contribution and its shadow ray.
    pub(in crate::path) fn trace(
        &mut self,
        context: &RenderContext<'_>,
        shadow_rays: &mut Vec<Ray>,
        contributions: &mut Vec<Contribution>,
    ) {
        let Some(mirrors) = context.large_mirrors() else { return };
        checked_accel::intersect(context.scene.accel(), &self.rays, &mut self.hits);
        for (sample, hit) in self.samples.iter().zip(&self.hits) {
            let Some(hit) = hit.filter(|hit| mirrors.facet_of(hit.triangle) == Some(sample.facet)) else {
                continue;
            };
            let Bsdf::Mirror(reflectance) = context.scene.material(hit.triangle).bsdf else { continue };
            let radiance = sample.radiance * reflectance.rgb();
            let point = context.scene.triangles().surface_point(hit.triangle, hit.u, hit.v);
            if let Some(ray) = point.segment_to(&sample.light).filter(|_| !radiance.is_black()) {
                shadow_rays.push(ray);
                contributions.push(Contribution { target: sample.target, radiance });
            }
        }
    }
}

/// A sampled point on a light, as a mirror shows it to a vertex.
struct LightInMirror {
    /// The index of the facet that shows it.
    facet: u32,
    /// Where it is.
    light: SurfacePoint,
    /// The sample, in the direction in which the vertex sees it.
    seen: AreaLightSample,
}

/// Samples a point on a light by way of a mirror; `None` if that cannot show it.
fn light_in_mirror(
    mirrors: &LargeMirrors,
    context: &RenderContext<'_>,
    path: &Path,
    vertex: &PathVertex<'_>,
) -> Option<LightInMirror> {
    let PathVertex { at, bounce, .. } = vertex;
    let (triangles, receiver) = (context.scene.triangles(), vertex.at.receiver());
    let sample_prob = context.large_mirror_prob(vertex.is_first);
    // What the decision to sample leaves of its number chooses the mirror.
    let rest = || path.numbers.mirror(MirrorSize::Large, *bounce) / sample_prob;
    if sample_prob < 1.0 && rest() >= 1.0 {
        return None;
    }
    let chosen = mirrors.choose(triangles, receiver, rest)?;
    let facet = chosen.facet;
    let drawn = vertex.large_mirror_numbers;
    let (u_light, u_point) =
        drawn.unwrap_or_else(|| path.numbers.light_in_mirror(MirrorSize::Large, *bounce));
    let light = match context.light_sampler_in_mirror(facet.image_of(receiver)).sample(u_light, u_point)? {
        LightSample::Area(light) => light,
        LightSample::Delta(_) => return None,
    };
    if !facet.same_side(receiver.position, light.point.position) {
        return None;
    }
    let direction = facet.reflect(light.direction);
    let pdf = light.pdf.chosen_with(chosen.prob * sample_prob);
    let is_hit = facet.may_be_hit_by(triangles, &at.point.spawn_ray(direction));
    is_hit.then_some(LightInMirror {
        facet: chosen.index,
        light: light.point,
        seen: AreaLightSample { direction, pdf, ..light },
    })
}
