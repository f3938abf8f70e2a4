use super::next_event::{MirrorSample, Reflected};
use super::path_state::{Contribution, Target};
use super::render_context::RenderContext;
use globillum_geom::{Hit, Ray};

/// The rays of light samples by way of mirrors: to the mirror, and from there to the light. Its buffers are reused.
#[derive(Debug, Default)]
pub(super) struct MirrorRays {
    /// The samples, with the sums that they are for.
    samples: Vec<(Target, MirrorSample)>,
    /// The ray of each sample, which must hit the mirror.
    rays: Vec<Ray>,
    hits: Vec<Option<Hit>>,
    /// The rays from mirrors whose hits may be on lights, with the cluster of lights that counts, and with what each
    /// unit of their radiance adds.
    reflected: Vec<(Contribution, u32)>,
    reflected_rays: Vec<Ray>,
}

impl MirrorRays {
    pub(super) fn clear(&mut self) {
        self.samples.clear();
        self.rays.clear();
        self.reflected.clear();
        self.reflected_rays.clear();
    }

    #[inline(always)]
    pub(super) fn push(&mut self, ray: Ray, target: Target, sample: MirrorSample) {
        self.rays.push(ray);
        self.samples.push((target, sample));
    }

    /// The number of rays, to mirrors and from mirrors, but for shadow rays.
    pub(super) fn len(&self) -> usize {
        self.rays.len() + self.reflected_rays.len()
    }

    /// Turns each sample whose ray hits its mirror into a contribution. Those of shadow rays come first; the others have
    /// reached their light.
    pub(super) fn trace(
        &mut self,
        context: &RenderContext<'_>,
        shadow_rays: &mut Vec<Ray>,
        contributions: &mut Vec<Contribution>,
    ) {
        if self.samples.is_empty() {
            return;
        }
        context.scene.accel().intersect_batch(&self.rays, &mut self.hits);
        let rays = self.rays.iter().zip(&self.hits);
        for (&(target, ref sample), (ray, &hit)) in self.samples.iter().zip(rays) {
            let Some((next, radiance)) = context.reflected(sample, ray, hit) else { continue };
            let contribution = Contribution { target, radiance };
            match next {
                Reflected::ShadowRay(ray) => {
                    shadow_rays.push(ray);
                    contributions.push(contribution);
                }
                Reflected::Ray(ray, cluster) => {
                    self.reflected_rays.push(ray);
                    self.reflected.push((contribution, cluster));
                }
            }
        }
        context.scene.accel().intersect_batch(&self.reflected_rays, &mut self.hits);
        let rays = self.reflected_rays.iter().zip(&self.hits);
        for (&(Contribution { target, radiance }, cluster), (ray, hit)) in self.reflected.iter().zip(rays) {
            let Some(hit) = hit else { continue };
            let shown = context.shown(ray, hit, cluster);
            if !shown.is_black() {
                contributions.push(Contribution { target, radiance: radiance * shown });
            }
        }
    }
}
