//! Rays that find the emission of lights, directly and by way of mirrors.

use super::render_context::RenderContext;
use crate::checked_accel;
use crate::light::reflection;
use crate::{Interaction, PathStart, Scene};
use glam::DVec3;
use globillum_geom::{Accel, Hit, Ray, SurfacePoint};
use globillum_material::{Bsdf, Material, Rgb};

/// Rays that find emission only.
#[derive(Debug, Default)]
pub(super) struct EmissionRays {
    rays: Vec<Ray>,
    /// The tag of each ray, by which its owner knows it, and the throughput along it.
    states: Vec<(u32, Rgb)>,
    hits: Vec<Option<Hit>>,
}

/// What a ray has found.
#[derive(Clone, Copy, Debug)]
pub(super) struct FoundEmission<'a> {
    /// The tag of the ray.
    pub(super) tag: u32,
    /// The radiance times the throughput.
    pub(super) radiance: Rgb,
    /// How many mirrors the ray has followed.
    pub(super) mirrors: u32,
    /// Where it was found.
    pub(super) at: &'a Interaction<'a>,
}

/// The ray that leaves a mirror after one in `direction`, of any length, has met it.
pub(super) fn reflected_ray(mirror: &SurfacePoint, direction: DVec3) -> Ray {
    mirror.spawn_ray(reflection(direction, mirror.normal))
}

impl EmissionRays {
    /// The number of rays to be traced.
    pub(super) fn len(&self) -> usize {
        self.rays.len()
    }

    pub(super) fn push(&mut self, ray: Ray, tag: u32, throughput: Rgb) {
        self.rays.push(ray);
        self.states.push((tag, throughput));
    }

    /// Adds the ray of a sensor that begins at `start`, if it is traceable.
    #[inline(always)]
    pub(super) fn push_start(&mut self, start: PathStart, tag: u32) {
        // The path of the sample tells of a ray that is not traceable.
        if let PathStart::Ray(ray) = start
            && start.is_valid()
        {
            self.push(ray, tag, Rgb::WHITE);
        }
    }

    /// Traces all rays, by way of up to `max_mirrors` mirrors. Calls `add` with each emission that a ray finds, and
    /// `reflect` with the tag of each ray that a mirror reflects and its new direction. Returns how many rays were traced;
    /// none are left.
    pub(super) fn trace(
        &mut self,
        context: &RenderContext<'_>,
        max_mirrors: u32,
        mut add: impl FnMut(FoundEmission<'_>),
        mut reflect: impl FnMut(u32, DVec3),
    ) -> u64 {
        let scene = context.scene;
        let mut traced = 0;
        for mirrors in 0..=max_mirrors {
            if self.rays.is_empty() {
                break;
            }
            traced += self.rays.len() as u64;
            checked_accel::intersect(scene.accel(), &self.rays, &mut self.hits);
            let mut kept = 0;
            for i in 0..self.rays.len() {
                let next = self.follow(scene, i, mirrors, &mut add);
                let Some((ray, throughput)) = next.filter(|_| mirrors < max_mirrors) else {
                    continue;
                };
                let tag = self.states[i].0;
                reflect(tag, ray.direction);
                (self.rays[kept], self.states[kept]) = (ray, (tag, throughput));
                kept += 1;
            }
            self.rays.truncate(kept);
            self.states.truncate(kept);
        }
        traced
    }

    /// Calls `add` with the emission that ray `i` has hit after this number of mirrors. Returns the ray that a mirror
    /// reflects there, and the throughput along it.
    fn follow(
        &self,
        scene: &Scene<dyn Accel + '_>,
        i: usize,
        mirrors: u32,
        add: &mut impl FnMut(FoundEmission<'_>),
    ) -> Option<(Ray, Rgb)> {
        let (ray, (tag, throughput), hit) = (&self.rays[i], self.states[i], self.hits[i].as_ref()?);
        let Material { bsdf, emission, .. } = *scene.material(hit.triangle);
        if bsdf.is_diffuse() && emission.is_black() {
            return None;
        }
        let at = scene.interaction(ray, hit);
        let mut found = |radiance| add(FoundEmission { tag, radiance, mirrors, at: &at });
        if !at.point.position.is_finite() {
            // As for the path of a sample: no ray can leave it.
            found(Rgb::splat(f64::NAN));
            return None;
        }
        let emitted = at.emitted();
        if !emitted.is_black() {
            found(throughput * emitted);
        }
        let Bsdf::Mirror(reflectance) = bsdf else { return None };
        let throughput = throughput * reflectance.rgb();
        let is_reflected = at.point.normal.dot(at.wo) != 0.0 && !throughput.is_black();
        is_reflected.then(|| (reflected_ray(&at.point, -at.wo), throughput))
    }
}
