use super::job::View;
use super::state::Path;
use super::vertex::{Choice, Shaded};
use crate::light::{Image, LightSampler};
use crate::{Estimator, Interaction, MirrorSampling};
use glam::DVec3;
use globillum_geom::{Hit, PdfSolidAngle, Ray, SurfacePoint};
use globillum_material::{Bsdf, Density, Rgb};

/// Light that a mirror throws, if the ray toward the mirror meets nothing before it, and the light is to
/// be seen from there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Thrown {
    /// Which of the plane mirrors.
    pub(super) plane: usize,
    /// The point on the light.
    pub(super) light: SurfacePoint,
    /// What arrives at the path's start by a perfect mirror.
    pub(super) radiance: Rgb,
}

impl<A> View<'_, A> {
    /// What the surface emits along the path, by the share that scattering has in finding it.
    #[inline(always)]
    pub(super) fn emitted(&self, path: &Path, hit: &Hit, at: &Interaction<'_>) -> Rgb {
        let emission = &at.material.emission;
        let emitted = emission.toward(at.point.normal.dot(at.wo));
        if emitted.is_black() {
            return emitted;
        }
        let Choice { density, from, from_prob, .. } = path.choice;
        let by_light_sample =
            || self.lights_from(from).pdf(hit.triangle, &at.point, emission).chosen_with(from_prob);
        emitted * self.settings.estimator.weight_of_emission(density, by_light_sample)
    }

    /// How points on lights are chosen where `from` is shaded.
    fn lights_from(&self, from: DVec3) -> LightSampler<'_> {
        self.scene.light_sampler(self.settings.light_sampling, from)
    }

    fn samples_lights(&self, bsdf: &Bsdf) -> bool {
        self.settings.estimator.samples_lights() && !bsdf.is_delta()
    }

    /// Whether lights are looked for in plane mirrors at all.
    fn samples_mirrors(&self) -> bool {
        self.settings.mirror_sampling == MirrorSampling::Planes && !self.scene.mirrors().is_empty()
    }

    /// A point on a light, as the ray that must be free and the light that then arrives at the
    /// path's start.
    #[inline(always)]
    pub(super) fn next_event(&self, path: &Path, shaded: &Shaded<'_>) -> Option<(Ray, Rgb)> {
        let Shaded { at, numbers, .. } = shaded;
        if !self.samples_lights(&at.material.bsdf) {
            return None;
        }
        let light = self.lights_from(at.point.position).sample(numbers.light, numbers.point)?;
        let radiance = self.scattered(path, shaded, light.direction, light.radiance, light.pdf)?;
        Some((at.point.segment_to(&light.point)?, radiance))
    }

    /// A point on a light as a plane mirror shows it, as the ray that must meet the mirror first and
    /// what comes of it then.
    pub(super) fn next_event_in_mirror(&self, path: &Path, shaded: &Shaded<'_>) -> Option<(Ray, Thrown)> {
        let Shaded { at, bounce, .. } = shaded;
        // Two bounces: off this surface, and off the mirror.
        let within_limit = self.settings.max_bounces.is_none_or(|max| *bounce + 1 < max);
        if !self.samples_mirrors() || !within_limit || !self.samples_lights(&at.material.bsdf) {
            return None;
        }
        let position = at.point.position;
        let image = self.scene.mirrors().choose(position, || path.numbers.mirror(*bounce))?;
        let Image { mirror, plane, choice_prob, .. } = image;
        let (choice, u) = path.numbers.light_in_mirror(*bounce);
        let light = self.lights_from(image.position).sample(choice, u)?;
        if !mirror.same_side(position, light.point.position) {
            return None;
        }
        let direction = mirror.reflect(light.direction);
        let pdf = light.pdf.chosen_with(choice_prob);
        let radiance = self.scattered(path, shaded, direction, light.radiance, pdf)?;
        let ray = at.point.spawn(direction);
        mirror.is_met_by(&ray).then_some((ray, Thrown { plane, light: light.point, radiance }))
    }

    /// What a light sample, of density `pdf`, brings to the path's start by its share: `radiance`
    /// from the unit vector `direction`, scattered here. `None` if that is nothing.
    #[inline(always)]
    fn scattered(
        &self,
        path: &Path,
        Shaded { at, frame, wo, .. }: &Shaded<'_>,
        direction: DVec3,
        radiance: Rgb,
        pdf: PdfSolidAngle,
    ) -> Option<Rgb> {
        let wi = frame.to_local(direction);
        let scattered = at.material.bsdf.pdf(*wo, wi);
        let share = self.settings.estimator.weight_of_light(pdf, scattered);
        let value = at.material.bsdf.eval(*wo, wi) * radiance;
        let radiance = path.throughput * value * (wi.z.abs() * share / pdf.0);
        (!radiance.is_black()).then_some(radiance)
    }

    /// The segment from the mirror to the light, which must be free too, and the light that then
    /// arrives at the path's start; `None` if what the ray met is not the mirror.
    pub(super) fn reflected(&self, thrown: &Thrown, met: Option<Hit>) -> Option<(Ray, Rgb)> {
        let hit = met.filter(|hit| self.scene.mirrors().plane_of(hit.triangle) == Some(thrown.plane))?;
        let Bsdf::Mirror(reflectance) = self.scene.material(hit.triangle).bsdf else { return None };
        let radiance = thrown.radiance * reflectance.rgb();
        if radiance.is_black() {
            return None;
        }
        let point = self.scene.triangles().surface_point(hit.triangle, hit.u, hit.v);
        Some((point.segment_to(&thrown.light)?, radiance))
    }

    /// `choice` after the path met an ideal mirror, triangle `index`.
    pub(super) fn passed_mirror(&self, choice: Choice, index: u32) -> Choice {
        match self.image_of(choice, index) {
            Some(image) => {
                Choice { from: image.position, from_prob: image.choice_prob, in_mirror: true, ..choice }
            }
            None => Choice { density: Density::Delta, ..choice },
        }
    }

    /// Where a light sample in the mirror of triangle `index` would have been taken; `None` if none
    /// could have been.
    fn image_of(&self, choice: Choice, index: u32) -> Option<Image<'_>> {
        let once = choice.density != Density::Delta && !choice.in_mirror;
        if !once || !self.samples_mirrors() || self.settings.estimator == Estimator::Bsdf {
            return None;
        }
        let mirrors = self.scene.mirrors();
        mirrors.image_in(mirrors.plane_of(index)?, choice.from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampler::BounceNumbers;
    use crate::{Camera, Model, Scene, Settings};
    use globillum_geom::conformance::shapes::quad;
    use globillum_geom::{Accel, KdOptions, KdTree};
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
        Scene::build(&model, |triangles| KdTree::build(triangles, &KdOptions::default())).unwrap()
    }

    /// A camera, the ray through the middle of its picture, and what that ray meets: the floor.
    fn looking_down(scene: &Scene<KdTree>) -> (Camera, Ray, Shaded<'_>) {
        let camera = Camera::look_at(DVec3::new(0.3, 0.5, 0.4), DVec3::ZERO, DVec3::Y, 1.0).unwrap();
        let down = camera.ray(0.0, 0.0, 1.0);
        let at = scene.interaction(&down, &scene.accel().intersect(&down).unwrap());
        (camera, down, Shaded::new(at, 0, BounceNumbers::default()))
    }

    /// Scatters `path` at what `ray` meets, and returns where it goes on.
    fn step(view: &View<'_, KdTree>, path: &mut Path, ray: &Ray, bounce: u32) -> Ray {
        let hit = view.scene.accel().intersect(ray).unwrap();
        path.scatter(
            view,
            &hit,
            &Shaded::new(view.scene.interaction(ray, &hit), bounce, BounceNumbers::default()),
        )
        .unwrap()
    }

    /// The share of what `ray` meets that is added to the path.
    fn share_of_emission(view: &View<'_, KdTree>, path: &Path, ray: &Ray) -> f64 {
        let hit = view.scene.accel().intersect(ray).unwrap();
        view.emitted(path, &hit, &view.scene.interaction(ray, &hit)).g / LIGHT.g
    }

    /// What is sampled in a mirror, and the path that scatters in the same direction, are shares of
    /// one whole; after two mirrors a path is alone.
    #[test]
    fn the_shares_of_the_two_ways_through_a_mirror_add_up_to_one() {
        let scene = between_mirrors();
        let (camera, down, shaded) = looking_down(&scene);
        let at = shaded.at;
        let settings = [Estimator::Bsdf, Estimator::Light, Estimator::Mis]
            .map(|estimator| Settings { estimator, ..Settings::new(1, 1, 1024) });
        let views = settings.each_ref().map(|settings| View { scene: &scene, camera: &camera, settings });
        let mut compared = 0;
        for sample in 0..1024 {
            let numbers = settings[0].sampler.numbers(1, 0, sample, &settings[0].pass_of(sample));
            let path = Path::from_camera(0, numbers, down.origin);
            let [none, light, mis] = views.each_ref().map(|view| view.next_event_in_mirror(&path, &shaded));
            assert!(none.is_none());
            let (Some((ray, light)), Some((_, mis))) = (light, mis) else { continue };
            let wi = shaded.frame.to_local(ray.direction);
            let density = Density::SolidAngle(at.material.bsdf.pdf(shaded.wo, wi));
            let shares = views.each_ref().map(|view| {
                let mut path = path;
                path.choice = Choice::at_surface(density, at.point.position);
                let reflected = step(view, &mut path, &ray, 1);
                share_of_emission(view, &path, &reflected)
            });
            assert_eq!(shares[..2], [1.0, 0.0]);
            // By `Light` the sample has all of it.
            let whole = shares[2] + mis.radiance.g / light.radiance.g;
            assert!((whole - 1.0).abs() < 1e-12, "{shares:?}, {whole}");
            compared += 1;
        }
        assert!(compared > 300, "{compared}");
        for view in &views {
            let numbers = settings[0].sampler.numbers(1, 0, 0, &(0..16));
            let mut path = Path::from_camera(0, numbers, down.origin);
            path.choice = Choice::at_surface(Density::SolidAngle(PdfSolidAngle(0.1)), at.point.position);
            // The middle of the light's image in the first mirror's image in the second.
            let toward = DVec3::new(6.0, 1.0, 0.0) - at.point.position;
            let once = step(view, &mut path, &at.point.spawn(toward.normalize()), 1);
            let twice = step(view, &mut path, &once, 2);
            assert_eq!(share_of_emission(view, &path, &twice), 1.0);
        }
    }

    /// The light is two bounces away, of which one is allowed.
    #[test]
    fn a_limit_on_bounces_counts_the_mirror() {
        let scene = between_mirrors();
        let (camera, down, shaded) = looking_down(&scene);
        let found = |max_bounces| {
            let settings = Settings { max_bounces, ..Settings::new(1, 1, 64) };
            let view = View { scene: &scene, camera: &camera, settings: &settings };
            let sampled = (0..64).filter(|&sample| {
                let numbers = settings.sampler.numbers(1, 0, sample, &settings.pass_of(sample));
                view.next_event_in_mirror(&Path::from_camera(0, numbers, down.origin), &shaded).is_some()
            });
            sampled.count()
        };
        assert_eq!(found(Some(1)), 0);
        assert!(found(Some(2)) > 0 && found(Some(2)) == found(None));
    }
}
