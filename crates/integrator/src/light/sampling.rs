use super::area_light::{AreaLight, AreaProb};
use super::delta::DeltaLightSample;
use super::lights::{Light, Lights};
use super::receiver::Receiver;
use crate::Interaction;
use glam::DVec3;
use globillum_geom::{PdfSolidAngle, Ray, SphericalTriangle, SurfacePoint, Triangle, Triangles};
use globillum_material::Rgb;

/// The distribution of light samples on a triangle. It changes the variance, not the mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum LightSampling {
    /// Uniform by area: cheaper, and as good for small or distant triangles.
    Area,
    /// Uniform by solid angle as seen from the receiver where [`SphericalTriangle::new`] allows it, for the triangle or the
    /// part of one that is chosen, and by area elsewhere.
    #[default]
    SolidAngle,
}

/// Samples lights and points on them for one receiver, a surface point with its side, and evaluates the density of such a
/// sample: what a direct illumination estimator needs. [`Scene::light_sampler`](crate::Scene::light_sampler) returns one.
///
/// Densities are per steradian at the receiver, over all lights together. They ignore visibility. A delta
/// light has no density but a probability of being chosen.
///
/// A direct illumination estimator by next event estimation, on a floor of albedo 1/2 under a square light:
///
/// ```
/// use glam::{DVec3, Vec3};
/// use globillum_geom::{Accel, Frame, Ray, Triangle, WideBvh};
/// use globillum_integrator::{LightSampling, Model, Scene, Stream};
/// use globillum_material::{Material, Rgb};
///
/// fn radiance(scene: &Scene<WideBvh>, ray: &Ray, numbers: Stream) -> Rgb {
///     let Some(hit) = scene.accel().intersect(ray) else { return scene.environment() };
///     let at = scene.interaction(ray, &hit);
///     let lights = scene.light_sampler(LightSampling::SolidAngle, at.point.position, at.facing_normal());
///     let Some(light) = lights.sample(numbers.uniform(0), numbers.uniform_pair(1)) else {
///         return at.emitted();
///     };
///     let is_hidden = |shadow_ray| scene.accel().occluded(&shadow_ray);
///     if light.shadow_ray(&at.point).is_none_or(is_hidden) {
///         return at.emitted();
///     }
///     let frame = Frame::around(at.point.normal);
///     let (wo, wi) = (frame.to_local(at.wo), frame.to_local(light.direction()));
///     at.emitted() + at.material.bsdf.eval(wo, wi) * light.irradiance() * wi.z.abs()
/// }
///
/// let mut model = Model::default();
/// let square = |y: f32| [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, z)| Vec3::new(x, y, z));
/// let [a, b, c, d] = square(0.0);
/// model.add(Material::lambert(Rgb::splat(0.5))?, Triangle::quad(a, d, c, b));
/// let [a, b, c, d] = square(1.0);
/// model.add(Material::light(Rgb::WHITE)?, Triangle::quad(a, b, c, d));
/// let scene = Scene::build(model, WideBvh::build)?;
/// let eye = DVec3::new(0.1, 0.5, 0.2);
/// let ray = Ray::new(eye, -eye); // toward the middle of the floor
/// let sum: f64 = (0..10_000).map(|i| radiance(&scene, &ray, Stream::new(0, 0, i)).g).sum();
/// // Albedo times the form factor of a square seen from below its middle.
/// assert!((sum / 10_000.0 - 0.277_063).abs() < 0.003, "{sum}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct LightSampler<'a> {
    pub(crate) lights: &'a Lights,
    pub(crate) triangles: &'a Triangles,
    pub(crate) sampling: LightSampling,
    pub(crate) receiver: Receiver,
}

/// A light sampled by [`LightSampler::sample`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightSample {
    /// A point on a triangle that emits.
    Area(AreaLightSample),
    /// A delta light.
    Delta(DeltaLightSample),
}

/// A point on a triangle that emits, sampled by [`LightSampler::sample`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct AreaLightSample {
    /// The point.
    pub point: SurfacePoint,
    /// Unit direction from the receiver, world frame.
    pub direction: DVec3,
    /// Radiance emitted toward the receiver; not black.
    pub radiance: Rgb,
    /// Density of the direction per steradian, including the choice of the light; positive.
    pub pdf: PdfSolidAngle,
}

impl LightSample {
    /// Unit direction from the receiver, world frame.
    #[inline(always)]
    pub fn direction(&self) -> DVec3 {
        match self {
            Self::Area(light) => light.direction,
            Self::Delta(light) => light.direction,
        }
    }

    /// The ray to the light from the receiver, on the surface at `from`: the sample counts if it is not
    /// occluded. It ends at the light, or nowhere if that is infinitely far away.
    ///
    /// `None` if the light lies in the plane of the surface up to rounding, or the surface in that of the light.
    #[inline(always)]
    pub fn shadow_ray(&self, from: &SurfacePoint) -> Option<Ray> {
        match self {
            Self::Area(light) => from.segment_to(&light.point),
            Self::Delta(DeltaLightSample { position: Some(position), .. }) => {
                from.segment_to_position(*position)
            }
            Self::Delta(DeltaLightSample { position: None, direction, .. }) => {
                Some(from.spawn_ray(*direction))
            }
        }
    }

    /// The irradiance on a plane perpendicular to the direction, as this sample estimates it if the light is
    /// visible: radiance over density, or that of a delta light over the probability of choosing it.
    #[inline(always)]
    pub fn irradiance(&self) -> Rgb {
        let (incident, probability) = self.quotient();
        incident / probability
    }

    /// The same as one of `count` samples, which share the light between them.
    #[inline(always)]
    pub(crate) fn of_samples(self, count: u32) -> Self {
        match self {
            Self::Area(light) => Self::Area(AreaLightSample { pdf: light.pdf.of_samples(count), ..light }),
            Self::Delta(light) => {
                let choice_prob = light.choice_prob * f64::from(count);
                Self::Delta(DeltaLightSample { choice_prob, ..light })
            }
        }
    }

    /// Dividend and divisor of [`LightSample::irradiance`].
    #[inline(always)]
    pub(crate) fn quotient(&self) -> (Rgb, f64) {
        match self {
            Self::Area(light) => (light.radiance, light.pdf.0),
            Self::Delta(light) => (light.irradiance, light.choice_prob),
        }
    }

    /// The weight of the power heuristic beside BSDF sampling, which samples the direction with density
    /// `scattered`; 1 for a delta light, which BSDF sampling never finds.
    #[inline(always)]
    pub fn power_heuristic(&self, scattered: PdfSolidAngle) -> f64 {
        match self {
            Self::Area(light) => light.pdf.power_heuristic(scattered),
            Self::Delta(_) => 1.0,
        }
    }
}

impl LightSampler<'_> {
    /// Samples a light by `u_light` in `[0, 1)` and a point on it by `u_point` in `[0, 1)^2`; the three numbers are
    /// independent. `None` if there is no light, or it does not emit toward the receiver: the sample then contributes 0. It
    /// may also be `None` where a triangle lies behind the receiver's surface; other samples from behind contribute 0, too.
    #[inline(always)]
    pub fn sample(&self, u_light: f64, u_point: [f64; 2]) -> Option<LightSample> {
        let [light] = self.choose([u_light]);
        self.sample_chosen(&light?, u_point)
    }

    /// Chooses a light by each of `us`, in `[0, 1)`; `None` if there are none.
    #[inline(always)]
    pub(crate) fn choose<const N: usize>(&self, us: [f64; N]) -> [Option<Light<'_>>; N] {
        self.lights.choose(self.receiver, us)
    }

    /// [`LightSampler::sample`] for a light chosen before.
    #[inline(always)]
    pub(crate) fn sample_chosen(&self, light: &Light<'_>, u: [f64; 2]) -> Option<LightSample> {
        match light {
            Light::Area(light, prob) => self.sample_area(light, *prob, u).map(LightSample::Area),
            Light::Delta(light, prob) => light.sample(self.receiver.position, *prob).map(LightSample::Delta),
        }
    }

    #[inline(always)]
    fn sample_area(&self, light: &AreaLight, prob: AreaProb, u: [f64; 2]) -> Option<AreaLightSample> {
        let triangle = self.triangles.get(light.triangle);
        // A tree seldom chooses a light behind the surface.
        if self.lights.tree().is_none() && self.receiver.has_behind(triangle) {
            return None;
        }
        let spherical =
            if light.may_look_large(self.receiver.position) { self.by_solid_angle(light) } else { None };
        let in_light = match &spherical {
            Some(spherical) => spherical.sample(u),
            None => Triangle::sample_uniform(u),
        };
        let (u, v) = light.part.barycentrics_in_triangle(in_light);
        let point = self.triangles.surface_point_with_normal(light.triangle, light.normal, u, v);
        let Line { direction, distance_sq, cos_light } = self.line_to(&point);
        let radiance = light.emission.toward(cos_light);
        if radiance.is_black() {
            return None;
        }
        let pdf = match spherical {
            Some(spherical) => spherical.pdf().chosen_with(prob.prob),
            None => prob.pdf.to_solid_angle(distance_sq, cos_light)?,
        };
        Some(AreaLightSample { point, direction, radiance, pdf })
    }

    /// The density per steradian with which [`LightSampler::sample`] samples the direction to `at`, the
    /// interaction of a ray from the receiver. 0 if the point does not emit toward the receiver or is seen edge-on. Means
    /// nothing for directions behind the receiver's surface.
    ///
    /// Multiple importance sampling needs it for a direction from BSDF sampling with density `p`: the weight is
    /// [`PdfSolidAngle::power_heuristic`].
    #[inline(always)]
    pub fn pdf(&self, at: &Interaction<'_>) -> PdfSolidAngle {
        let (point, none) = (&at.point, PdfSolidAngle(0.0));
        if at.emitted().is_black() {
            return none;
        }
        let Some((light, prob)) = self.lights.light_at(point, self.triangles, self.receiver) else {
            return none;
        };
        match self.by_solid_angle(light) {
            Some(spherical) => spherical.pdf().chosen_with(prob.prob),
            None => {
                let Line { distance_sq, cos_light, .. } = self.line_to(point);
                prob.pdf.to_solid_angle(distance_sq, cos_light).unwrap_or(none)
            }
        }
    }

    /// The spherical triangle if points are sampled by solid angle. Depends on the light and the
    /// receiver only, so that sampling and density agree.
    #[inline(always)]
    fn by_solid_angle(&self, light: &AreaLight) -> Option<SphericalTriangle> {
        match self.sampling {
            LightSampling::Area => None,
            LightSampling::SolidAngle => {
                let vertices = light.part.vertices(self.triangles.get(light.triangle));
                SphericalTriangle::of_vertices(vertices, self.receiver.position)
            }
        }
    }

    #[inline(always)]
    fn line_to(&self, point: &SurfacePoint) -> Line {
        let between = point.position - self.receiver.position;
        let distance_sq = between.length_squared();
        let direction = between / distance_sq.sqrt();
        Line { direction, distance_sq, cos_light: -point.normal.dot(direction) }
    }
}

/// The line from the receiver to a point on a light.
struct Line {
    /// Unit vector toward the light.
    direction: DVec3,
    distance_sq: f64,
    /// Cosine between the light's normal and the direction back.
    cos_light: f64,
}
