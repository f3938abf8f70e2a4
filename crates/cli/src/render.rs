//! Renders a scene file: `cargo run --example render -- SCENE.glb`.

use crate::{RenderOptions, view};
use anyhow::{Context, Result};
use globillum::integrator::Camera;
use globillum::io::Limits;
use globillum::material::Rgb;
use std::path::PathBuf;

/// Renders a scene file.
#[derive(clap::Args, Debug)]
pub struct Options {
    /// What to render
    #[arg(value_name = "SCENE.{obj,gltf,glb}")]
    scene: PathBuf,
    /// Where the camera stands, what it looks at, which way is up and how many degrees it sees
    /// from bottom to top; by default the file's own camera, else a view of the whole scene
    #[arg(long, value_name = "X,Y,Z/X,Y,Z[/X,Y,Z[/FOV]]", allow_hyphen_values = true, value_parser = view::parse_camera)]
    camera: Option<Camera>,
    /// Radiance that arrives from all around: one number, or one for each of red, green and blue
    #[arg(long, value_name = "R,G,B", allow_hyphen_values = true, default_value = "0", value_parser = view::parse_colour)]
    environment: Rgb,
    /// Refuse a scene of more triangles, a mesh counted as often as it is placed; by default more
    /// than 2^29, or than 2^25 and one for each byte of its files
    #[arg(long, value_name = "N")]
    max_triangles: Option<u64>,
    #[command(flatten)]
    render: RenderOptions,
}

/// Does what `options` ask for.
///
/// # Errors
/// What a user has to know, with the file it concerns.
pub fn run(options: &Options) -> Result<()> {
    let job = options.render.prepare("render.png")?;
    let mut limits = Limits::default();
    if let Some(triangles) = options.max_triangles {
        (limits.triangles, limits.instanced) = (triangles, triangles);
    }
    let loaded = crate::load(&options.scene, limits)?;
    let camera = match options.camera.or(loaded.cameras.first().copied()) {
        Some(camera) => camera,
        None => view::of_all(&loaded.model, options.render.aspect())
            .with_context(|| format!("{}: can not be seen whole", options.scene.display()))?,
    };
    job.run(loaded.model, &camera, options.environment)
}
