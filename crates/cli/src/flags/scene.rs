use crate::interrupt::Interrupt;
use crate::load::Warnings;
use crate::{console, load, parse, view};
use anyhow::Result;
use globillum::integrator::{Model, PinholeCamera};
use globillum::io::{Limits, Loaded, Loader, WarningKind};
use globillum::material::Rgb;
use std::path::PathBuf;

/// A scene file, and what is added to it.
#[derive(clap::Args, Clone, Debug)]
#[command(next_help_heading = "Scene")]
pub(crate) struct SceneFlags {
    /// Scene file: Wavefront OBJ with MTL, or glTF 2.0
    #[arg(value_name = "SCENE.{obj,gltf,glb}")]
    pub(crate) scene: PathBuf,
    /// Radiance of the environment from all directions: a number, or one each for red, green and blue
    /// [default: 0, or 1 in a scene without lights]
    ///
    /// Each is 0 or from 1e-50 to 1e50. 0 is no environment: a scene without lights is then black.
    #[arg(long, value_name = "R,G,B")]
    #[arg(allow_hyphen_values = true, value_parser = view::parse_colour)]
    environment: Option<Rgb>,
    /// Lumens for a watt: divides intensities and irradiances of the delta lights of a glTF file
    ///
    /// glTF states them in candela and lux, emissive materials in watts. Blender's exporter multiplies by 683;
    /// 1 is right for a file that it wrote with the lighting mode Unitless.
    #[arg(long, value_name = "N", default_value_t = 683.0)]
    #[arg(value_parser = parse::positive, allow_negative_numbers = true)]
    lumens_per_watt: f64,
    /// Refuse scenes of more triangles, where a mesh counts each time it is placed [default: 2^29]
    ///
    /// By default also more than 2^25 and one for each byte of the scene's files are refused.
    #[arg(long, value_name = "N", value_parser = parse::integer(0..=u64::MAX))]
    #[arg(allow_negative_numbers = true)]
    max_triangles: Option<u64>,
}

/// What a scene file holds.
pub(crate) struct LoadedScene {
    /// The file.
    pub(crate) name: String,
    /// In the environment asked for, or a black one.
    pub(crate) model: Model,
    pub(crate) cameras: Vec<PinholeCamera>,
    /// Of each camera, if the file says one.
    pub(crate) aspect_ratios: Vec<Option<f64>>,
    /// The files that it was read from.
    pub(crate) files: Vec<PathBuf>,
    /// The environment asked for.
    pub(crate) environment: Option<Rgb>,
    /// Whether nothing in the file shines.
    is_dark: bool,
}

impl SceneFlags {
    /// Loads the scene.
    pub(crate) fn load(&self, warnings: Warnings, interrupt: &Interrupt) -> Result<LoadedScene> {
        let mut limits = Limits::default();
        if let Some(triangles) = self.max_triangles {
            (limits.triangles, limits.instanced) = (triangles, triangles);
        }
        let loader = Loader::new().limits(limits).luminous_efficacy(self.lumens_per_watt);
        let loaded = load::load(&self.scene, loader, warnings, interrupt)?;
        let name = self.scene.display().to_string();
        let Loaded { mut model, cameras, aspect_ratios, files, report, .. } = loaded;
        model.set_environment(self.environment.unwrap_or(Rgb::BLACK))?;
        let is_dark = report.warnings.iter().any(|warning| warning.kind == WarningKind::NoLight);
        Ok(LoadedScene { name, model, cameras, aspect_ratios, files, environment: self.environment, is_dark })
    }
}

impl LoadedScene {
    /// Adds a white environment if nothing in the file shines and none was asked for. Warns of it, and of darkness.
    pub(crate) fn light_if_dark(&mut self) -> Result<()> {
        let name = &self.name;
        match self.environment {
            None if self.is_dark => {
                console::warn(format_args!(
                    "{name}: scene has no lights: a white environment of radiance 1 is added \
                     (--environment R,G,B sets it; 0 is none)"
                ));
                self.model.set_environment(Rgb::WHITE)?;
            }
            Some(Rgb::BLACK) if self.is_dark => {
                console::warn(format_args!(
                    "{name}: scene has no lights and no environment: the picture is black"
                ));
            }
            _ => {}
        }
        Ok(())
    }
}
