use crate::exit::{CODES, SIGNALS};
use crate::file_conflicts::Uses;
use crate::flags::{LoadedScene, RenderFlags, SceneFlags};
use crate::interrupt::Interrupt;
use crate::job::Job;
use crate::subject::Subject;
use crate::view::{self, CameraType, Up, View, sun};
use anyhow::{Result, anyhow};

const LONG_ABOUT: &str = "\
Renders a scene file, Wavefront OBJ or glTF 2.0, and prints samples, rays, time and error.

What the file says and the renderer has not, such as textures, is left out with a warning on standard error. \
The first warning of each kind is shown, with the number of such warnings; --verbose shows all.

A file without cameras is framed automatically. A file in which nothing shines is rendered in a white \
environment of radiance 1, in which surfaces of albedo 1 cannot be seen; --sun shows them.";

const EXAMPLES: &str = "\
Examples:
  Render the file's own view to render.png:
      globillum render SCENE.glb
  Choose camera, radiance of the sky and picture size, and brighten the PNG by one stop:
      globillum render SCENE.obj --camera 3,2,5/0,1,0 --environment 0.5,0.6,0.8 \\
          --width 1280 --height 720 --exposure 1 --out sky.png --out sky.exr
  A scan with z up, in the light of a sun and a grey sky:
      globillum render BUST.obj --up z --sun
  Render to 1 % error, but no longer than ten minutes, and be able to continue later:
      globillum render SCENE.glb --error 0.01 --seconds 600 --checkpoint scene.part --resume
  A panorama from the middle of a room, and a plan, 8 m high, of what lies below height 2:
      globillum render ROOM.glb --camera-type 360 --camera 0,1.6,0/0,1.6,-1 --width 1024
      globillum render ROOM.glb --camera-type orthographic --camera 0,2,0/0,0,0/0,0,-1/8
  A part of a large picture, to see how it comes out:
      globillum render SCENE.glb --width 3840 --height 2160 --crop 1600,900,320,180
  Look at the figures with another program:
      globillum render SCENE.glb --stats - | jq .relative_rmse";

/// Renders a scene file
#[derive(clap::Args, Debug)]
#[command(long_about = format!("{LONG_ABOUT}\n\n{SIGNALS}"), after_long_help = format!("{CODES}\n\n{EXAMPLES}"))]
pub(crate) struct Options {
    #[command(flatten)]
    scene: SceneFlags,
    /// Camera: where it stands / what it looks at / up / vertical field of view in degrees
    ///
    /// Positions are in the scene's units, at most 1e60 in magnitude; up is as --up says and the field of view 40 degrees
    /// if not given. Without this flag the file's first camera is used. A file without cameras is framed automatically: its
    /// bounding box fills the picture, seen from the front and a little from the right, and from above the more, the
    /// flatter it is. A closed room with light inside is seen from inside. The camera in use is printed in the notation of
    /// this flag.
    #[arg(long, value_name = "X,Y,Z/X,Y,Z[/X,Y,Z[/FOV]]", help_heading = "Scene")]
    #[arg(allow_hyphen_values = true)]
    camera: Option<String>,
    /// Type of the camera
    ///
    /// The fourth part of --camera is the height of the picture in the scene's units for `orthographic`, at most 1e60, and
    /// is not there for `360`. Without --camera, `orthographic` looks as the file's or the automatic camera does and shows as
    /// much of the middle of the scene; `360` looks level in the same direction.
    #[arg(long, value_enum, help_heading = "Scene", default_value_t = CameraType::Pinhole)]
    camera_type: CameraType,
    /// Axis that points upward, for automatic cameras and for --camera without an up vector
    ///
    /// glTF files have y up. OBJ files do not say: z is right for many that look as if they lay on their backs.
    #[arg(long, value_enum, help_heading = "Scene", default_value_t = Up::Y)]
    up: Up,
    /// Adds a sun behind the viewer's left shoulder, and a grey sky of radiance 0.3
    ///
    /// It shows the shape of what has no light of its own: a white surface that faces the sun has a radiance of 1.
    /// --environment sets another sky.
    #[arg(long, help_heading = "Scene")]
    sun: bool,
    #[command(flatten)]
    pub(crate) flags: RenderFlags,
}

pub(crate) fn run(options: &Options) -> Result<()> {
    options.camera()?;
    let inputs = Uses::default().read("the scene", [&options.scene.scene]);
    let job = Job::prepare(&options.flags, "render.png", inputs)?;
    let subject = options.subject(&job.interrupt)?;
    job.run(subject)
}

impl Options {
    /// Loads the scene.
    pub(crate) fn subject(&self, interrupt: &Interrupt) -> Result<Subject> {
        let camera = self.camera()?;
        let mut loaded = self.scene.load(self.flags.warnings(), interrupt)?;
        if let (None, CameraType::Pinhole, Some(&Some(ratio))) =
            (&camera, self.camera_type, loaded.aspect_ratios.first())
        {
            self.flags.picture.warn_of_aspect(ratio);
        }
        let own = loaded.cameras.first().map(|&camera| View::Own(camera, self.camera_type, self.up));
        let view = camera.or(own).unwrap_or(View::Automatic(self.camera_type, self.up));
        if self.sun {
            sun::add(&mut loaded.model, &view, self.up)?;
            loaded.model.set_environment(loaded.environment.unwrap_or(sun::SKY))?;
        } else {
            loaded.light_if_dark()?;
        }
        let LoadedScene { name, model, files, .. } = loaded;
        Ok(Subject { name, model, view, files })
    }

    fn camera(&self) -> Result<Option<View>> {
        let Some(text) = &self.camera else { return Ok(None) };
        let camera = view::parse_any_camera(text, self.up, self.camera_type);
        let camera = camera.map_err(|reason| anyhow!("--camera {text}: {reason}"))?;
        Ok(Some(View::Given(camera)))
    }
}
