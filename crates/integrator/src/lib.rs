//! How light adds up: Monte-Carlo path tracing over wavefronts of rays.
//!
//! In the order the data flows: a [`Model`] (triangles with materials) becomes a [`Scene`] with
//! an accelerator and its [`Lights`]; a [`Camera`] sends rays; [`render`] traces paths tile by
//! tile, wavefront by wavefront, with random numbers from a [`Sampler`]; a [`Film`] sums what they carry and
//! tells its own error; a [`Stop`] says when that is enough.
//!
//! A picture is decided by scene, camera and [`Settings`]: its bits do not depend on the number
//! of threads, on the accelerator, or on the scene's unit of length.
//!
//! ```
//! use glam::{DVec3, Vec3};
//! use globillum_geom::{KdOptions, KdTree, Triangle};
//! use globillum_integrator::{Camera, Model, Scene, Settings, render};
//! use globillum_material::{Material, Rgb};
//!
//! let mut model = Model::default();
//! let [a, b, c] = [Vec3::new(-9.0, -9.0, -1.0), Vec3::new(9.0, -9.0, -1.0), Vec3::new(0.0, 9.0, -1.0)];
//! model.add(Material::light(Rgb::new(1.0, 0.5, 0.25))?, [Triangle::new(a, b, c)]);
//! let scene = Scene::build(model, |triangles| KdTree::build(triangles, &KdOptions::default()))?;
//! let camera = Camera::look_at(DVec3::ZERO, -DVec3::Z, DVec3::Y, 40.0_f64.to_radians())?;
//! let picture = render(&scene, &camera, &Settings::new(8, 8, 4), &())?;
//! assert_eq!(picture.film.mean(3, 3), Rgb::new(1.0, 0.5, 0.25));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod caught;
mod error;
mod film;
mod hash;
mod light;
mod path;
mod run;
mod sampler;
mod scene;
mod settings;

pub use error::{CheckpointError, RenderError};
#[cfg(any(test, feature = "fuzz"))]
pub use film::check_checkpoint;
pub use film::{Ending, Film, ImageError, Picture};
pub use light::{LightSample, LightSampler, LightSampling, Lights};
pub use path::{Counters, Replay, Vertex, replay};
pub use run::{Monitor, PixelGoal, Progress, Render, Stop, render};
pub use sampler::{Sampler, Stream};
pub use scene::{Camera, Interaction, MaterialId, Model, Scene};
pub use settings::{Estimator, MirrorSampling, PathReuse, PixelFilter, Roulette, Settings};
