use crate::exit::{CODES, SIGNALS};
use crate::file_conflicts::Uses;
use crate::flags::RenderFlags;
use crate::interrupt::Interrupt;
use crate::job::Job;
use crate::subject::Subject;
use crate::view::{CameraType, Up, View};
use crate::{load, parse};
use anyhow::{Result, ensure};
use globillum::geom::Triangle;
use globillum::integrator::{Model, PinholeCamera};
use globillum::io::Loader;
use globillum::scenes::cornell;
use std::path::{Path, PathBuf};

const LONG_ABOUT: &str = "\
Renders a built-in scene, and prints samples, rays, time and error.

Scenes:
  0  the Cornell box with two blocks
  1  the box with a knot, 100,000 triangles
  2  the box with a diffuse and a mirror knot under two lights, 200,000 triangles
  3  the box with a pine cone, 1,000,000 triangles
  4  a hall of statues with a mirror wall and 7,680 light triangles, 1,000,000 triangles";

const EXAMPLES: &str = "\
Examples:
  Render the box with two blocks at 64 samples per pixel to cornell.png:
      globillum cornell
  The tall block as a mirror, with 1024 samples per pixel, as OpenEXR:
      globillum cornell --specular --spp 1024 --out mirror.exr
  A hall of statues, wide, for a minute:
      globillum cornell --scene 4 --width 960 --height 540 --seconds 60
  A mesh of your own in the box:
      globillum cornell --mesh bunny.obj
  Half of the passes here, half elsewhere, then one picture of both:
      globillum cornell --spp 256 --passes 0..8 --checkpoint a.part
      globillum cornell --spp 256 --passes 8..16 --checkpoint b.part
      globillum merge a.part b.part --out cornell.png";

/// Renders a built-in scene: the Cornell box, or a hall of statues
#[derive(clap::Args, Debug)]
#[command(long_about = format!("{LONG_ABOUT}\n\n{SIGNALS}"), after_long_help = format!("{CODES}\n\n{EXAMPLES}"))]
pub(crate) struct Options {
    /// Number of the scene, from 0 to 4
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = parse::integer(0_u32..=4))]
    #[arg(help_heading = "Scene", allow_negative_numbers = true)]
    scene: u32,
    /// Put this mesh into the scene instead of blocks or statues; twice for two different ones in scenes 2 and 4
    #[arg(long, value_name = "FILE.{obj,gltf,glb}", help_heading = "Scene")]
    mesh: Vec<PathBuf>,
    /// Make the tall block, the statue or the mesh of scenes 0, 1 and 3 an ideal mirror
    #[arg(long, help_heading = "Scene")]
    specular: bool,
    /// About how many triangles all statues of scenes 1 to 4 have together; not with --mesh
    #[arg(long, value_name = "N", help_heading = "Scene", value_parser = parse::integer(100..=u32::MAX))]
    #[arg(allow_negative_numbers = true)]
    triangles: Option<u32>,
    #[command(flatten)]
    pub(crate) flags: RenderFlags,
}

/// Makes a mesh of about this number of triangles.
type Sculpture = fn(usize) -> Vec<Triangle>;

/// What stands in the hall, row by row.
const HALL: [Sculpture; 8] = [
    cornell::knot,
    cornell::pine_cone,
    cornell::pine_cone,
    cornell::knot,
    cornell::knot,
    cornell::pine_cone,
    cornell::pine_cone,
    cornell::knot,
];

pub(crate) fn run(options: &Options) -> Result<()> {
    let inputs = Uses::default().read("--mesh", &options.mesh);
    let job = Job::prepare(&options.flags, "cornell.png", inputs)?;
    let subject = options.subject(&job.interrupt)?;
    job.run(subject)
}

impl Options {
    /// Makes the scene.
    pub(crate) fn subject(&self, interrupt: &Interrupt) -> Result<Subject> {
        let mut files = Vec::new();
        let (model, camera) = self.scene(interrupt, &mut files)?;
        let name = format!("cornell {}", self.scene);
        let view = View::Own(camera, CameraType::Pinhole, Up::Y);
        Ok(Subject { name, model, view, files })
    }

    /// The scene and its camera. Adds the files of its meshes to `files`.
    fn scene(&self, interrupt: &Interrupt, files: &mut Vec<PathBuf>) -> Result<(Model, PinholeCamera)> {
        self.check()?;
        let mesh = |path: &PathBuf| self.mesh(path, interrupt, files);
        let meshes = self.mesh.iter().map(mesh).collect::<Result<Vec<_>>>()?;
        let model = match self.scene {
            0 if meshes.is_empty() => cornell::with_blocks(self.specular)?,
            0 | 1 => cornell::with_mesh(&self.statues(meshes, [cornell::knot], 100_000)[0], self.specular)?,
            2 => {
                let statues = self.statues(meshes, [cornell::knot; 2], 200_000);
                cornell::with_two(&statues[0], statues.last().unwrap_or(&statues[0]))?
            }
            3 => {
                let statues = self.statues(meshes, [cornell::pine_cone], 1_000_000);
                cornell::with_mesh(&statues[0], self.specular)?
            }
            _ => {
                let statues = self.statues(meshes, HALL, 1_000_000);
                return Ok((cornell::hall_with_statues(&statues)?, cornell::hall_camera()?));
            }
        };
        Ok((model, cornell::camera()?))
    }

    /// Refuses flags that the scene has no use for.
    fn check(&self) -> Result<()> {
        let (scene, most) = (self.scene, if matches!(self.scene, 2 | 4) { 2 } else { 1 });
        ensure!(self.mesh.len() <= most, "--mesh: scene {scene} takes at most {most}");
        if self.triangles.is_some() {
            ensure!(scene > 0, "--triangles: scene 0 has no statues");
            ensure!(self.mesh.is_empty(), "--triangles: a mesh of --mesh has its own number");
        }
        ensure!(
            !self.specular || matches!(scene, 0 | 1 | 3),
            "--specular: scene {scene} has mirrors of its own"
        );
        Ok(())
    }

    fn mesh(&self, path: &Path, interrupt: &Interrupt, files: &mut Vec<PathBuf>) -> Result<Vec<Triangle>> {
        let loaded = load::load(path, Loader::new(), self.flags.warnings(), interrupt)?;
        files.extend(loaded.files);
        let mesh = loaded.model.triangles().to_vec();
        ensure!(cornell::has_extent(&mesh), "{}: all vertices are the same point", path.display());
        Ok(mesh)
    }

    /// The meshes from files; else sculptures of `triangles` together, if no other number is asked for.
    fn statues<const N: usize>(
        &self,
        meshes: Vec<Vec<Triangle>>,
        sculptures: [Sculpture; N],
        triangles: u32,
    ) -> Vec<Vec<Triangle>> {
        let of_each = self.triangles.unwrap_or(triangles) as usize / N;
        if meshes.is_empty() { sculptures.map(|sculpture| sculpture(of_each)).into() } else { meshes }
    }
}
