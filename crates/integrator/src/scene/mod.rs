//! The model, and the scene built from it.

mod interaction;
mod model;

pub use interaction::Interaction;
pub use model::{MaterialId, Model};

use crate::RenderError;
use crate::checked_accel;
use crate::light::{LightSampler, LightSampling, Lights, Mirrors, Receiver};
use glam::DVec3;
use globillum_geom::{Accel, GeomError, Hit, Ray, Triangles};
use globillum_material::{Bsdf, Material, Rgb};
use std::sync::OnceLock;

/// A scene ready for rendering: triangles with materials, an accelerator over them, and lights.
///
/// A reference to it is one to a `Scene<dyn Accel>` too: rendering is compiled once, and not for each accelerator.
#[derive(Debug)]
pub struct Scene<A: ?Sized> {
    triangles: Triangles,
    material_ids: Vec<u32>,
    materials: Vec<Material>,
    lights: Lights,
    mirrors: OnceLock<Mirrors>,
    environment: Rgb,
    accel: A,
}

impl<A: ?Sized> Scene<A> {
    /// The material of triangle `index`.
    pub(crate) fn material(&self, index: u32) -> &Material {
        &self.materials[self.material_index(index) as usize]
    }

    /// The place of the material of triangle `index` in the model.
    pub(crate) fn material_index(&self, index: u32) -> u32 {
        self.material_ids[index as usize]
    }

    /// Whether the model has a mirror material.
    pub(crate) fn has_mirrors(&self) -> bool {
        self.materials.iter().any(|material| material.bsdf.is_delta())
    }

    /// The triangles, in the order of the model.
    pub fn triangles(&self) -> &Triangles {
        &self.triangles
    }

    /// The materials, in the order in which the model's were added; [`FirstHit::material`](crate::FirstHit::material) is
    /// an index into them.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// For each triangle, the index of its material in [`Scene::materials`].
    pub fn material_ids(&self) -> &[u32] {
        &self.material_ids
    }

    /// The lights: triangles that emit, and delta lights.
    pub fn lights(&self) -> &Lights {
        &self.lights
    }

    /// Samples lights and points on them, distributed as `sampling` says, for the receiver `from`.
    ///
    /// `normal` is the unit normal of the surface there, on the side where light counts
    /// ([`Interaction::facing_normal`]). In a light tree, lights in front of it are chosen more often. One behind it has a
    /// probability above zero all the same, but may give no sample.
    pub fn light_sampler(&self, sampling: LightSampling, from: DVec3, normal: DVec3) -> LightSampler<'_> {
        let receiver = Receiver { position: from, normal: normal.as_vec3() };
        LightSampler { lights: &self.lights, triangles: &self.triangles, sampling, receiver }
    }

    /// The constant radiance of the environment ([`Model::set_environment`]).
    pub fn environment(&self) -> Rgb {
        self.environment
    }
}

impl<A: Accel> Scene<A> {
    /// Checks the model's triangles and calls `build` for their accelerator:
    /// [`WideBvh::build`](globillum_geom::WideBvh::build), [`KdTree::build`](globillum_geom::KdTree::build) or another
    /// function of this type. Traces no ray.
    ///
    /// To change materials or lights alone, share the accelerator: build it once over [`Scene::triangles`] or
    /// [`Triangles::new`], keep it in an [`Arc`](std::sync::Arc), and return a clone of that from `build`.
    ///
    /// # Errors
    /// [`RenderError::Geometry`] for invalid triangles and for an error of `build`, [`RenderError::OtherTriangles`] for an
    /// accelerator with other bounds. Other triangles within the same bounds are not noticed, and make a wrong picture.
    pub fn build(
        model: Model,
        build: impl FnOnce(&Triangles) -> Result<A, GeomError>,
    ) -> Result<Self, RenderError> {
        let Model { triangles, material_ids, materials, delta_lights, environment } = model;
        let triangles = Triangles::new(triangles)?;
        let emission = |index: u32| materials[material_ids[index as usize] as usize].emission;
        let lights = Lights::of(&triangles, emission, &delta_lights);
        let accel = build(&triangles)?;
        if !checked_accel::is_over(&accel, &triangles) {
            return Err(RenderError::OtherTriangles);
        }
        Ok(Self { triangles, material_ids, materials, lights, mirrors: OnceLock::new(), environment, accel })
    }
}

impl<A: Accel + ?Sized> Scene<A> {
    /// The mirrors by way of which area lights are sampled. The first call builds a tree over them.
    pub(crate) fn mirrors(&self) -> &Mirrors {
        let is_mirror = |index| matches!(self.material(index).bsdf, Bsdf::Mirror(_));
        self.mirrors.get_or_init(|| Mirrors::of(&self.triangles, is_mirror, &self.lights))
    }

    /// The accelerator.
    pub fn accel(&self) -> &A {
        &self.accel
    }

    /// The point and the material where `ray` has `hit`, a hit of this scene's accelerator.
    ///
    /// # Panics
    /// If the triangle of `hit` is not in this scene.
    #[inline(always)]
    pub fn interaction(&self, ray: &Ray, hit: &Hit) -> Interaction<'_> {
        Interaction {
            point: self.triangles.surface_point(hit.triangle, hit.u, hit.v),
            material: self.material(hit.triangle),
            wo: -unit(ray.direction),
        }
    }
}

/// `v` as a unit vector; its squared length may overflow or underflow.
#[inline(always)]
pub(crate) fn unit(v: DVec3) -> DVec3 {
    let v = v / v.abs().max_element();
    v / v.length()
}
