//! What a picture shows.

use crate::accel::AccelKind;
use crate::flags::RenderFlags;
use crate::interrupt::Interrupt;
use crate::view::{AnyCamera, CameraBy, View};
use anyhow::{Context, Result};
use globillum::geom::Accel;
use globillum::integrator::{Model, Scene};
use std::path::PathBuf;
use std::time::Instant;

/// What a picture shows.
pub(crate) struct Subject {
    /// What the figures call it.
    pub(crate) name: String,
    pub(crate) model: Model,
    pub(crate) view: View,
    /// The files that it was read from.
    pub(crate) files: Vec<PathBuf>,
}

impl Subject {
    /// Builds its scene, and finds the camera.
    pub(crate) fn build(self, flags: &RenderFlags, interrupt: &Interrupt) -> Result<BuiltSubject> {
        let Self { name, model, view, .. } = self;
        let (scene, build_seconds) = build(model, flags.speed.accel)?;
        interrupt.check()?;
        let (camera, camera_by) = view
            .camera(&scene, flags.picture.aspect(), &|| interrupt.is_asked())
            .with_context(|| format!("{name}: cannot be seen whole"))?;
        interrupt.check()?;
        Ok(BuiltSubject { name, scene, build_seconds, camera, camera_by })
    }
}

/// A subject whose accelerator is built.
pub(crate) struct BuiltSubject {
    pub(crate) name: String,
    pub(crate) scene: BuiltScene,
    pub(crate) build_seconds: f64,
    pub(crate) camera: AnyCamera,
    pub(crate) camera_by: CameraBy,
}

/// A scene with any accelerator.
pub(crate) type BuiltScene = Scene<Box<dyn Accel>>;

/// Builds a scene, and returns the seconds that it took.
pub(crate) fn build(model: Model, accel: AccelKind) -> Result<(BuiltScene, f64)> {
    let start = Instant::now();
    let scene = Scene::build(model, |triangles| accel.build(triangles))?;
    Ok((scene, start.elapsed().as_secs_f64()))
}
