//! Physically based global illumination: a path tracer for triangle meshes, whose renders are repeatable to the bit
//! and state their own error. This crate re-exports the crates of the library as modules.
//!
//! A floor under a square light:
//!
//! ```
//! use globillum::geom::{Triangle, WideBvh};
//! use globillum::glam::{DVec3, Vec3};
//! use globillum::integrator::{Model, PinholeCamera, Scene, Settings, render};
//! use globillum::material::{Material, Rgb};
//!
//! fn main() -> Result<(), Box<dyn std::error::Error>> {
//!     let p = Vec3::new;
//!     let mut model = Model::default();
//!     let floor = Triangle::quad(p(-1.0, 0.0, 1.0), p(1.0, 0.0, 1.0), p(1.0, 0.0, -1.0), p(-1.0, 0.0, -1.0));
//!     model.add(Material::lambert(Rgb::new(0.7, 0.6, 0.5))?, floor);
//!     // A light emits from its front, the side from which its vertices run counter-clockwise.
//!     let light = Triangle::quad(p(-0.2, 1.0, -0.2), p(0.2, 1.0, -0.2), p(0.2, 1.0, 0.2), p(-0.2, 1.0, 0.2));
//!     model.add(Material::light(Rgb::splat(10.0))?, light);
//!
//!     let scene = Scene::build(model, WideBvh::build)?;
//!     // From a point toward another, the direction that is up, and the vertical field of view in radians.
//!     let camera = PinholeCamera::look_at(DVec3::new(0.0, 0.5, 3.0), DVec3::ZERO, DVec3::Y, 0.7)?;
//!     let picture = render(&scene, &camera, &Settings::new(32, 32, 16))?;
//!     assert_eq!(picture.film.to_srgb8().len(), 3 * 32 * 32); // red, green, blue of each pixel
//!     println!("relative RMSE: {:.1} %", 100.0 * picture.film.error().relative_rmse);
//!     Ok(())
//! }
//! ```
//!
//! | module | content |
//! |---|---|
//! | [`geom`] | triangles, rays, and accelerators that intersect rays with triangles |
//! | [`material`] | materials: BSDFs, emission, linear colour |
//! | [`integrator`] | models, scenes, cameras and other sensors, rendering, and pictures with their errors |
//! | [`io`] | reads OBJ with MTL and glTF 2.0, writes PNG and OpenEXR |
#![cfg_attr(
    feature = "scenes",
    doc = "| [`scenes`] | built-in scenes: the Cornell box and what stands in it |"
)]
//! | [`glam`] | vectors, in the version that all modules take |
//!
//! Features: `gltf`, `obj`, `images` and `scenes`, on by default; `shapes`, on with `scenes`, the module `geom::shapes` of
//! boxes, spheres and tori; `conformance`, the suite that checks accelerators of your own.

pub use glam;
#[doc(inline)]
pub use globillum_geom as geom;
#[doc(inline)]
pub use globillum_integrator as integrator;
#[doc(inline)]
pub use globillum_io as io;
#[doc(inline)]
pub use globillum_material as material;
#[cfg(feature = "scenes")]
#[doc(inline)]
pub use globillum_scenes as scenes;

/// Compiles the programs of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
