//! The rendered scenes: built-in ones and files.

use super::corner;
use super::errors::Truth;
use anyhow::{Context, Result, ensure};
use globillum::geom::{Accel, GeomError};
use globillum::glam::DVec3;
use globillum::integrator::{Model, PinholeCamera, RenderError, Scene};
use globillum::io::WarningKind;
use globillum::material::Rgb;
use globillum_cli::{AccelKind, view, warn};
use globillum_testkit::cornell;
use globillum_testkit::scenes::{self, stare};
use std::path::Path;

/// A scene with a camera.
pub(crate) struct Subject {
    pub(crate) name: String,
    pub(crate) model: Model,
    pub(crate) camera: PinholeCamera,
    known: Known,
}

/// The closed form of a scene's picture.
enum Known {
    /// There is none: pictures are compared with long runs.
    Nothing,
    /// All pixels have this radiance.
    Radiance(f64),
    /// The picture, as a function of the number of pixels along its side.
    Picture(fn(u32) -> Truth),
}

impl Subject {
    /// The built-in scene of this name; `None` if there is none.
    pub(crate) fn built_in(name: &str) -> Result<Option<Self>> {
        let p = DVec3::new;
        let (model, camera, known) = match name {
            "furnace" => {
                let camera = stare(p(0.1, 0.2, 0.3), p(0.35, -0.2, 1.0));
                (scenes::furnace(0.5, 1.0, DVec3::ZERO), camera, Known::Radiance(2.0))
            }
            "corner" => {
                let camera = corner::camera();
                (scenes::light_over_floor(), camera, Known::Picture(corner::picture))
            }
            "kaleidoscope" => {
                let camera = stare(p(0.4, 0.45, 0.4), p(0.3, 0.0, 0.6));
                (scenes::kaleidoscope(0.5, 0.8), camera, Known::Radiance(0.5 / 0.6))
            }
            "cornell" => in_box(cornell::with_blocks(false)?)?,
            "cornell-mirror" => in_box(cornell::with_blocks(true)?)?,
            "cornell-statue" => in_box(cornell::with_mesh(&cornell::knot(100_000), false)?)?,
            "cornell-statues" => {
                let knot = cornell::knot(100_000);
                in_box(cornell::with_two(&knot, &knot)?)?
            }
            "cornell-million" => in_box(cornell::with_mesh(&cornell::pine_cone(1_000_000), false)?)?,
            "cornell-hall" => {
                let model =
                    cornell::hall_with_statues(&[cornell::knot(125_000), cornell::pine_cone(125_000)])?;
                (model, cornell::hall_camera()?, Known::Nothing)
            }
            _ => return Ok(None),
        };
        Ok(Some(Self { name: name.to_owned(), model, camera, known }))
    }

    /// A scene from a file.
    pub(crate) fn load(path: &Path, camera: Option<PinholeCamera>, environment: Rgb) -> Result<Self> {
        let mut loaded = globillum::io::load(path)?;
        loaded.model.set_environment(environment)?;
        let camera = match camera.or(loaded.cameras.first().copied()) {
            Some(camera) => camera,
            None => view::of_all(&loaded.model.bounds(), view::Up::Y, 1.0)
                .with_context(|| format!("{}: no camera shows the whole scene", path.display()))?,
        };
        let has_light = !loaded.model.delta_lights().is_empty()
            || loaded.model.materials().iter().any(|material| !material.emission.is_black());
        ensure!(
            has_light || !environment.is_black(),
            "{}: the scene has no light; add one with --environment",
            path.display()
        );
        let matters = |kind: &WarningKind| !matches!(kind, WarningKind::NoLight);
        loaded.report.warnings.iter().filter(|warning| matters(&warning.kind)).for_each(warn);
        // The name goes into file names and Markdown.
        let stem = path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy();
        let name = stem.chars().map(|c| if c.is_alphanumeric() { c } else { '-' }).collect();
        Ok(Self { name, model: loaded.model, camera, known: Known::Nothing })
    }

    /// The scene, built with `accel`.
    pub(crate) fn scene(&self, accel: AccelKind) -> Result<Scene<Box<dyn Accel>>> {
        build(self.model.clone(), accel)
    }

    /// The scene without its environment, built with `accel`.
    pub(crate) fn without_environment(&self, accel: AccelKind) -> Result<Scene<Box<dyn Accel>>> {
        let mut model = self.model.clone();
        model.set_environment(Rgb::BLACK)?;
        build(model, accel)
    }

    /// The closed form of a picture with `side` pixels along each side, if there is one.
    pub(crate) fn closed_form(&self, side: u32) -> Option<Truth> {
        match self.known {
            Known::Nothing => None,
            Known::Radiance(radiance) => {
                Some(Truth::exact(vec![Rgb::splat(radiance); side as usize * side as usize]))
            }
            Known::Picture(of_side) => Some(of_side(side)),
        }
    }
}

fn in_box(model: Model) -> Result<(Model, PinholeCamera, Known), RenderError> {
    Ok((model, cornell::camera()?, Known::Nothing))
}

fn build(model: Model, accel: AccelKind) -> Result<Scene<Box<dyn Accel>>> {
    let build = |triangles: &_| -> Result<Box<dyn Accel>, GeomError> { accel.build(triangles) };
    Ok(Scene::build(model, build)?)
}
