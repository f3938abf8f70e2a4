//! A Monte Carlo path tracer over wavefronts of rays.
//!
//! A [`Model`] holds triangles with materials, and delta lights. [`Scene::build`] turns it into a [`Scene`] with an
//! accelerator and [`Lights`]. [`render`] traces paths from a [`PinholeCamera`] through the scene, one tile of
//! the picture at a time, with random numbers from a [`Sampler`]. A [`Film`] sums their radiance and
//! estimates its own error; a [`Stop`] ends the render when that is small enough. Radiance has the unit of the lights'.
//!
//! [`Render`] also renders single passes, crops and strips, and continues a [`Picture`]. [`IrradiancePoints`] measure without
//! a camera, [`FirstHits`] see surfaces without light, and [`view_factors`] need no materials.
//!
//! Scene, camera and [`Settings`] determine every bit of a picture. The number of threads, the accelerator
//! and the instruction set do not change it.
//!
//! ```
//! use glam::{DVec3, Vec3};
//! use globillum_geom::{KdTree, Triangle};
//! use globillum_integrator::{Model, PinholeCamera, Scene, Settings, render};
//! use globillum_material::{Material, Rgb};
//!
//! let mut model = Model::default();
//! let [a, b, c] = [Vec3::new(-9.0, -9.0, -1.0), Vec3::new(9.0, -9.0, -1.0), Vec3::new(0.0, 9.0, -1.0)];
//! model.add(Material::light(Rgb::new(1.0, 0.5, 0.25))?, [Triangle::new(a, b, c)]);
//! let scene = Scene::build(model, KdTree::build)?;
//! let camera = PinholeCamera::look_at(DVec3::ZERO, -DVec3::Z, DVec3::Y, 40.0_f64.to_radians())?;
//! let picture = render(&scene, &camera, &Settings::new(8, 8, 4))?;
//! assert_eq!(picture.film.mean(3, 3), Rgb::new(1.0, 0.5, 0.25));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bytes;
mod caught;
mod checked_accel;
mod comparison;
mod error;
mod film;
mod first_hits;
mod guide;
mod hash;
mod light;
mod param;
mod path;
mod pixel_rect;
mod run;
mod sampler;
mod scene;
mod sensor;
mod settings;
pub mod view_factors;
mod worker_threads;

pub use comparison::{ChiSquare, Comparison, Verdict};
pub use error::{CheckpointError, DeltaLightError, MergeError, PointError, RenderError};
#[cfg(any(test, feature = "fuzz"))]
pub use film::check_checkpoint;
pub use film::{
    CheckpointHeader, CheckpointReader, CheckpointStrip, CheckpointWriter, Ending, ErrorEstimate, Estimates,
    Film, Merge, Picture, PixelSums,
};
pub use first_hits::{FirstHit, FirstHits};
/// The crate of the vectors that this crate takes and returns, in its version.
pub use glam;
pub use light::{
    AreaLightSample, DeltaLight, DeltaLightSample, LightSample, LightSampler, LightSampling, Lights,
};
pub use path::{Counters, Replay, Vertex, replay, replay_samples};
pub use run::{Monitor, PixelGoal, Progress, Render, Stop, render};
pub use sampler::{Sampler, Stream};
pub use scene::{Interaction, MaterialId, Model, Scene};
pub use sensor::{
    ElementSample, IrradiancePoints, OrthographicCamera, PathStart, PinholeCamera, Reading, Sensor,
    SphericalCamera,
};
pub use settings::{
    Estimator, Guiding, MirrorSampling, PathReuse, PixelFilter, Roulette, Settings, Supersampling,
};
