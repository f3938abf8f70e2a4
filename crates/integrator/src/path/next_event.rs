use super::path_state::Path;
use super::render_context::RenderContext;
use super::shading_point::{MisContext, ShadingPoint};
use crate::Interaction;
use crate::light::{AreaLightSample, Image, LightSample, LightSampler};
use glam::DVec3;
use globillum_geom::{Hit, Ray, SurfacePoint};
use globillum_material::{Bsdf, Density, Rgb};

/// A light sample by way of a plane mirror. It counts if its ray hits the mirror first and the segment from
/// there to the light is not occluded.
#[derive(Clone, Copy, Debug)]
pub(super) struct MirrorSample {
    /// The index of the mirror.
    pub(super) plane: usize,
    /// The point on the light.
    pub(super) light: SurfacePoint,
    /// The contribution to the sample if the mirror reflects all light.
    pub(super) radiance: Rgb,
}

impl<A> RenderContext<'_, A> {
    /// The radiance that the surface emits along the path, times its multiple importance sampling weight.
    #[inline(always)]
    pub(super) fn emitted(&self, path: &Path, hit: &Hit, at: &Interaction<'_>) -> Rgb {
        let emitted = at.emitted();
        if emitted.is_black() {
            return emitted;
        }
        let MisContext { density, from, from_prob, .. } = path.mis;
        let by_light_sample = || self.light_sampler(from).pdf(hit, at).chosen_with(from_prob);
        emitted * self.settings.estimator.weight_of_emission(density, by_light_sample)
    }

    fn light_sampler(&self, from: DVec3) -> LightSampler<'_> {
        self.scene.light_sampler(self.settings.light_sampling, from)
    }

    /// Samples a light: the shadow ray, and the contribution if it is not occluded.
    #[inline(always)]
    pub(super) fn next_event(&self, path: &Path, vertex: &ShadingPoint<'_>) -> Option<(Ray, Rgb)> {
        let ShadingPoint { at, numbers, .. } = vertex;
        if !self.samples_lights || at.material.bsdf.is_delta() {
            return None;
        }
        let light = self.light_sampler(at.point.position).sample(numbers.light, numbers.point)?;
        let radiance = self.scattered(path, vertex, &light)?;
        Some((light.shadow_ray(&at.point)?, radiance))
    }

    /// Samples a point on an area light as a plane mirror shows it, with the ray that must hit the mirror.
    pub(super) fn next_event_in_mirror(
        &self,
        path: &Path,
        vertex: &ShadingPoint<'_>,
    ) -> Option<(Ray, MirrorSample)> {
        let ShadingPoint { at, bounce, .. } = vertex;
        let mirrors = self.mirrors?;
        // Two bounces: at this vertex, and at the mirror.
        let within_limit = self.settings.max_bounces.is_none_or(|max| *bounce + 1 < max);
        if !within_limit || at.material.bsdf.is_delta() {
            return None;
        }
        let position = at.point.position;
        let image = mirrors.choose(position, || path.numbers.mirror(*bounce))?;
        let Image { mirror, plane, choice_prob, .. } = image;
        let (choice, u) = path.numbers.light_in_mirror(*bounce);
        let light = match self.light_sampler(image.position).sample(choice, u)? {
            LightSample::Area(light) => light,
            LightSample::Delta(_) => return None,
        };
        if !mirror.same_side(position, light.point.position) {
            return None;
        }
        let direction = mirror.reflect(light.direction);
        let pdf = light.pdf.chosen_with(choice_prob);
        let reflected = LightSample::Area(AreaLightSample { direction, pdf, ..light });
        let radiance = self.scattered(path, vertex, &reflected)?;
        let ray = at.point.spawn(direction);
        mirror.is_hit_by(&ray).then_some((ray, MirrorSample { plane, light: light.point, radiance }))
    }

    /// The contribution of a light sample: what arrives from it, scattered along the path, times its multiple
    /// importance sampling weight. `None` if that is black.
    #[inline(always)]
    fn scattered(
        &self,
        path: &Path,
        ShadingPoint { at, frame, wo, .. }: &ShadingPoint<'_>,
        light: &LightSample,
    ) -> Option<Rgb> {
        let wi = frame.to_local(light.direction());
        let scattered = at.material.bsdf.pdf(*wo, wi);
        let weight = self.settings.estimator.weight_of_light(light, scattered);
        let (incident, probability) = light.quotient();
        let value = at.material.bsdf.eval(*wo, wi) * incident;
        let radiance = path.throughput * value * (wi.z.abs() * weight / probability);
        (!radiance.is_black()).then_some(radiance)
    }

    /// The shadow ray from the mirror to the light, and the contribution if it is not occluded; `None` if
    /// `hit`, where the ray of the sample ended, is not on the mirror.
    pub(super) fn reflected(&self, sample: &MirrorSample, hit: Option<Hit>) -> Option<(Ray, Rgb)> {
        let mirrors = self.mirrors?;
        let hit = hit.filter(|hit| mirrors.plane_of(hit.triangle) == Some(sample.plane))?;
        let Bsdf::Mirror(reflectance) = self.scene.material(hit.triangle).bsdf else { return None };
        let radiance = sample.radiance * reflectance.rgb();
        if radiance.is_black() {
            return None;
        }
        let point = self.scene.triangles().surface_point(hit.triangle, hit.u, hit.v);
        Some((point.segment_to(&sample.light)?, radiance))
    }

    /// `mis` after the path was reflected by the ideal mirror of triangle `index`.
    pub(super) fn mis_after_mirror(&self, mis: MisContext, index: u32) -> MisContext {
        match self.image_of(mis, index) {
            Some(Image { position, choice_prob, .. }) => {
                MisContext { from: position, from_prob: choice_prob, in_mirror: true, ..mis }
            }
            None => MisContext { density: Density::Delta, ..mis },
        }
    }

    /// The image, in the mirror of triangle `index`, from which a light sample could have been taken.
    fn image_of(&self, mis: MisContext, index: u32) -> Option<Image<'_>> {
        let is_first_mirror = mis.density != Density::Delta && !mis.in_mirror;
        let mirrors = self.mirrors.filter(|_| is_first_mirror)?;
        mirrors.image_in(mirrors.plane_of(index)?, mis.from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampler::BounceNumbers;
    use crate::{Camera, Estimator, Model, Scene, Settings};
    use globillum_geom::conformance::shapes::quad;
    use globillum_geom::{Accel, KdOptions, KdTree, PdfSolidAngle};
    use globillum_material::Material;

    const LIGHT: Rgb = Rgb::splat(3.0);

    /// A floor between two mirrors of reflectance 0.9, under a light.
    fn between_mirrors() -> Scene<KdTree> {
        let p = DVec3::new;
        let mut model = Model::default();
        let floor = quad(p(-1.0, 0.0, 1.0), p(1.0, 0.0, 1.0), p(1.0, 0.0, -1.0), p(-1.0, 0.0, -1.0));
        model.add(Material::lambert(Rgb::splat(0.5)).unwrap(), floor);
        let light = quad(p(-0.5, 1.0, -0.5), p(0.5, 1.0, -0.5), p(0.5, 1.0, 0.5), p(-0.5, 1.0, 0.5));
        model.add(Material::light(LIGHT).unwrap(), light);
        for x in [-1.5, 1.5] {
            let wall = quad(p(x, 0.0, 3.0), p(x, 3.0, 3.0), p(x, 3.0, -3.0), p(x, 0.0, -3.0));
            model.add(Material::mirror(Rgb::splat(0.9)).unwrap(), wall);
        }
        Scene::build(model, |triangles| KdTree::build(triangles, &KdOptions::default())).unwrap()
    }

    /// A camera, the ray through the middle of its picture, and what that ray meets: the floor.
    fn looking_down(scene: &Scene<KdTree>) -> (Camera, Ray, ShadingPoint<'_>) {
        let camera = Camera::look_at(DVec3::new(0.3, 0.5, 0.4), DVec3::ZERO, DVec3::Y, 1.0).unwrap();
        let down = camera.ray(0.0, 0.0, 1.0);
        let at = scene.interaction(&down, &scene.accel().intersect(&down).unwrap());
        (camera, down, ShadingPoint::new(at, 0, BounceNumbers::default()))
    }

    /// Scatters `path` at what `ray` meets, and returns where it goes on.
    fn step(context: &RenderContext<'_, KdTree>, path: &mut Path, ray: &Ray, bounce: u32) -> Ray {
        let hit = context.scene.accel().intersect(ray).unwrap();
        path.scatter(
            context,
            &hit,
            &ShadingPoint::new(context.scene.interaction(ray, &hit), bounce, BounceNumbers::default()),
        )
        .unwrap()
    }

    /// The share of what `ray` meets that is added to the path.
    fn share_of_emission(context: &RenderContext<'_, KdTree>, path: &Path, ray: &Ray) -> f64 {
        let hit = context.scene.accel().intersect(ray).unwrap();
        context.emitted(path, &hit, &context.scene.interaction(ray, &hit)).g / LIGHT.g
    }

    /// What is sampled in a mirror, and the path that scatters in the same direction, are shares of
    /// one whole; after two mirrors a path is alone.
    #[test]
    fn the_shares_of_the_two_ways_through_a_mirror_add_up_to_one() {
        let scene = between_mirrors();
        let (camera, down, vertex) = looking_down(&scene);
        let at = vertex.at;
        let settings = [Estimator::Bsdf, Estimator::Light, Estimator::Mis]
            .map(|estimator| Settings { estimator, ..Settings::new(1, 1, 1024) });
        let contexts = settings.each_ref().map(|settings| RenderContext::new(&scene, &camera, settings));
        let mut compared = 0;
        for sample in 0..1024 {
            let numbers = settings[0].sampler.numbers(1, 0, sample, &settings[0].pass_of(sample));
            let path = Path::from_camera(0, numbers, down.origin);
            let [none, light, mis] =
                contexts.each_ref().map(|context| context.next_event_in_mirror(&path, &vertex));
            assert!(none.is_none());
            let (Some((ray, light)), Some((_, mis))) = (light, mis) else { continue };
            let wi = vertex.frame.to_local(ray.direction);
            let density = Density::SolidAngle(at.material.bsdf.pdf(vertex.wo, wi));
            let shares = contexts.each_ref().map(|context| {
                let mut path = path;
                path.mis = MisContext::new(density, at.point.position);
                let reflected = step(context, &mut path, &ray, 1);
                share_of_emission(context, &path, &reflected)
            });
            assert_eq!(shares[..2], [1.0, 0.0]);
            // By `Light` the sample has all of it.
            let whole = shares[2] + mis.radiance.g / light.radiance.g;
            assert!((whole - 1.0).abs() < 1e-12, "{shares:?}, {whole}");
            compared += 1;
        }
        assert!(compared > 300, "{compared}");
        for context in &contexts {
            let numbers = settings[0].sampler.numbers(1, 0, 0, &(0..16));
            let mut path = Path::from_camera(0, numbers, down.origin);
            path.mis = MisContext::new(Density::SolidAngle(PdfSolidAngle(0.1)), at.point.position);
            // The middle of the light's image in the first mirror's image in the second.
            let toward = DVec3::new(6.0, 1.0, 0.0) - at.point.position;
            let once = step(context, &mut path, &at.point.spawn(toward.normalize()), 1);
            let twice = step(context, &mut path, &once, 2);
            assert_eq!(share_of_emission(context, &path, &twice), 1.0);
        }
    }

    /// The light is two bounces away, of which one is allowed.
    #[test]
    fn a_limit_on_bounces_counts_the_mirror() {
        let scene = between_mirrors();
        let (camera, down, vertex) = looking_down(&scene);
        let found = |max_bounces| {
            let settings = Settings { max_bounces, ..Settings::new(1, 1, 64) };
            let context = RenderContext::new(&scene, &camera, &settings);
            let sampled = (0..64).filter(|&sample| {
                let numbers = settings.sampler.numbers(1, 0, sample, &settings.pass_of(sample));
                context.next_event_in_mirror(&Path::from_camera(0, numbers, down.origin), &vertex).is_some()
            });
            sampled.count()
        };
        assert_eq!(found(Some(1)), 0);
        assert!(found(Some(2)) > 0 && found(Some(2)) == found(None));
    }
}
