use crate::flags::RenderFlags;
use crate::job::{Job, Subject};
use crate::{load, parse, view};
use anyhow::{Context, Result};
use globillum::integrator::Camera;
use globillum::io::Limits;
use globillum::material::Rgb;
use std::path::PathBuf;

const LONG_ABOUT: &str = "\
Renders a scene file, Wavefront OBJ or glTF 2.0, and prints samples, rays, time and error.

What the file says and the renderer has not, such as textures, is left out with a warning on standard error.

Ctrl-C (SIGINT) and SIGTERM end the render after the passes that are complete: picture, figures and \
checkpoint are written, and the exit code is 130 or 143. If no pass is complete, no file is written. A \
second signal ends the program at once.";

const EXAMPLES: &str = "\
Examples:
  Render the file's own view to render.png:
      globillum render SCENE.glb
  Choose camera, radiance of the sky and picture size, and brighten the PNG by one stop:
      globillum render SCENE.obj --camera 3,2,5/0,1,0 --environment 0.5,0.6,0.8 \\
          --width 1280 --height 720 --exposure 1 --out sky.png --out sky.exr
  Render to 1 % error, but no longer than ten minutes, and be able to continue later:
      globillum render SCENE.glb --error 0.01 --seconds 600 --checkpoint scene.part --resume
  Look at the figures with another program:
      globillum render SCENE.glb --stats - | jq .relative_rmse";

/// Renders a scene file
#[derive(clap::Args, Debug)]
#[command(long_about = LONG_ABOUT, after_long_help = EXAMPLES)]
pub(crate) struct Options {
    /// Scene file: Wavefront OBJ with MTL, or glTF 2.0
    #[arg(value_name = "SCENE.{obj,gltf,glb}", help_heading = "Scene")]
    scene: PathBuf,
    /// Camera: where it stands / what it looks at / up / vertical field of view in degrees
    ///
    /// Positions are in the scene's units; up is 0,1,0 and the field of view 40 degrees if not given. Without
    /// this flag the file's own first camera is used, or else one that sees the whole scene.
    #[arg(long, value_name = "X,Y,Z/X,Y,Z[/X,Y,Z[/FOV]]", help_heading = "Scene")]
    #[arg(allow_hyphen_values = true, value_parser = view::parse_camera)]
    camera: Option<Camera>,
    /// Radiance of the environment from all directions: a number, or one each for red, green and blue
    #[arg(long, value_name = "R,G,B", help_heading = "Scene", default_value = "0")]
    #[arg(allow_hyphen_values = true, value_parser = view::parse_colour)]
    environment: Rgb,
    /// Refuse scenes of more triangles, where a mesh counts each time it is placed [default: 2^29]
    ///
    /// By default also more than 2^25 and one for each byte of the scene's files are refused.
    #[arg(long, value_name = "N", help_heading = "Scene", value_parser = parse::integer(0..=u64::MAX))]
    #[arg(allow_negative_numbers = true)]
    max_triangles: Option<u64>,
    #[command(flatten)]
    flags: RenderFlags,
}

pub(crate) fn run(options: &Options) -> Result<()> {
    let job = Job::prepare(&options.flags, "render.png")?;
    let mut limits = Limits::default();
    if let Some(triangles) = options.max_triangles {
        (limits.triangles, limits.instanced) = (triangles, triangles);
    }
    let loaded = load::load(&options.scene, limits, &job.interrupt)?;
    let name = options.scene.display().to_string();
    let camera = match options.camera.or(loaded.cameras.first().copied()) {
        Some(camera) => camera,
        None => view::of_all(&loaded.model, options.flags.picture.aspect())
            .with_context(|| format!("{name}: cannot be seen whole"))?,
    };
    job.run(Subject { name, model: loaded.model, camera, environment: options.environment })
}
