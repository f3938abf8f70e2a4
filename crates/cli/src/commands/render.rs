use crate::exit::CODES;
use crate::flags::RenderFlags;
use crate::interrupt::Interrupt;
use crate::job::{Job, Subject};
use crate::view::{self, CameraBy, Up, View};
use crate::{console, load, parse};
use anyhow::{Result, anyhow};
use globillum::io::{Limits, LoadReport, Loader, WarningKind};
use globillum::material::Rgb;
use std::path::PathBuf;

const LONG_ABOUT: &str = "\
Renders a scene file, Wavefront OBJ or glTF 2.0, and prints samples, rays, time and error.

What the file says and the renderer has not, such as textures, is left out with a warning on standard error. \
The first warning of each kind is shown, with the number of such warnings; --verbose shows all.

A file without cameras is framed automatically. A file in which nothing shines is rendered in a white \
environment of radiance 1.

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
  A scan with z up, in the light of a grey sky:
      globillum render BUST.obj --up z --environment 0.6
  Render to 1 % error, but no longer than ten minutes, and be able to continue later:
      globillum render SCENE.glb --error 0.01 --seconds 600 --checkpoint scene.part --resume
  Look at the figures with another program:
      globillum render SCENE.glb --stats - | jq .relative_rmse";

/// Renders a scene file
#[derive(clap::Args, Debug)]
#[command(long_about = LONG_ABOUT, after_long_help = format!("{CODES}\n\n{EXAMPLES}"))]
pub(crate) struct Options {
    /// Scene file: Wavefront OBJ with MTL, or glTF 2.0
    #[arg(value_name = "SCENE.{obj,gltf,glb}", help_heading = "Scene")]
    scene: PathBuf,
    /// Camera: where it stands / what it looks at / up / vertical field of view in degrees
    ///
    /// Positions are in the scene's units; up is as --up says and the field of view 40 degrees if not given.
    /// Without this flag the file's first camera is used. A file without cameras is framed automatically: its
    /// bounding box fills the picture, seen from the front and a little from the right, and from above the
    /// more, the flatter it is. A closed room with light inside is seen from inside. The camera in use is
    /// printed in the notation of this flag.
    #[arg(long, value_name = "X,Y,Z/X,Y,Z[/X,Y,Z[/FOV]]", help_heading = "Scene")]
    #[arg(allow_hyphen_values = true)]
    camera: Option<String>,
    /// Axis that points upward, for automatic cameras and for --camera without an up vector
    ///
    /// glTF files have y up. OBJ files do not say: z is right for many that look as if they lay on their backs.
    #[arg(long, value_enum, help_heading = "Scene", default_value_t = Up::Y)]
    up: Up,
    /// Radiance of the environment from all directions: a number, or one each for red, green and blue
    /// [default: 0, or 1 in a scene without lights]
    ///
    /// 0 is no environment: a scene without lights is then black.
    #[arg(long, value_name = "R,G,B", help_heading = "Scene")]
    #[arg(allow_hyphen_values = true, value_parser = view::parse_colour)]
    environment: Option<Rgb>,
    /// Lumens for a watt: divides intensities and irradiances of the delta lights of a glTF file
    ///
    /// glTF states them in candela and lux, emissive materials in watts. Blender's exporter multiplies by 683;
    /// 1 is right for a file that it wrote with the lighting mode Unitless.
    #[arg(long, value_name = "N", default_value_t = 683.0, help_heading = "Scene")]
    #[arg(value_parser = parse::positive, allow_negative_numbers = true)]
    lumens_per_watt: f64,
    /// Refuse scenes of more triangles, where a mesh counts each time it is placed [default: 2^29]
    ///
    /// By default also more than 2^25 and one for each byte of the scene's files are refused.
    #[arg(long, value_name = "N", help_heading = "Scene", value_parser = parse::integer(0..=u64::MAX))]
    #[arg(allow_negative_numbers = true)]
    max_triangles: Option<u64>,
    #[command(flatten)]
    pub(crate) flags: RenderFlags,
}

pub(crate) fn run(options: &Options) -> Result<()> {
    options.camera()?;
    let job = Job::prepare(&options.flags, "render.png")?;
    let subject = options.subject(&job.interrupt)?;
    job.run(subject)
}

impl Options {
    /// Loads the scene.
    pub(crate) fn subject(&self, interrupt: &Interrupt) -> Result<Subject> {
        let camera = self.camera()?;
        let mut limits = Limits::default();
        if let Some(triangles) = self.max_triangles {
            (limits.triangles, limits.instanced) = (triangles, triangles);
        }
        let loader = Loader::new().limits(limits).luminous_efficacy(self.lumens_per_watt);
        let loaded = load::load(&self.scene, loader, self.flags.warnings(), interrupt)?;
        let name = self.scene.display().to_string();
        let own = loaded.cameras.first().map(|&camera| View::Fixed(camera, CameraBy::Scene));
        let view = camera.or(own).unwrap_or(View::Automatic(self.up));
        let environment = self.environment(&name, &loaded.report);
        Ok(Subject { name, model: loaded.model, view, environment })
    }

    fn camera(&self) -> Result<Option<View>> {
        let Some(text) = &self.camera else { return Ok(None) };
        let camera =
            view::parse_camera(text, self.up).map_err(|reason| anyhow!("--camera {text}: {reason}"))?;
        Ok(Some(View::Fixed(camera, CameraBy::Flag)))
    }

    /// The environment asked for; else none, or a white one if nothing in the file shines.
    fn environment(&self, name: &str, report: &LoadReport) -> Rgb {
        let is_dark = report.warnings.iter().any(|warning| warning.kind == WarningKind::NoLight);
        match self.environment {
            None if is_dark => {
                console::warn(format_args!(
                    "{name}: scene has no lights: a white environment of radiance 1 is added \
                     (--environment R,G,B sets it; 0 is none)"
                ));
                Rgb::WHITE
            }
            Some(Rgb::BLACK) if is_dark => {
                console::warn(format_args!(
                    "{name}: scene has no lights and no environment: the picture is black"
                ));
                Rgb::BLACK
            }
            asked => asked.unwrap_or(Rgb::BLACK),
        }
    }
}
