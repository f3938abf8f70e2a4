//! Renders the Cornell box: `cargo run --example cornell`.
//!
//! Composes the crates and nothing more: a model from `globillum-testkit` or an OBJ file, an
//! accelerator, a camera, a render, a picture.

use crate::RenderOptions;
use anyhow::{Result, ensure};
use globillum::geom::Triangle;
use globillum::integrator::{Camera, Model};
use globillum::material::Rgb;
use globillum::scenes::cornell;
use std::path::{Path, PathBuf};

/// Renders the Cornell box.
#[derive(clap::Args, Debug)]
pub struct Options {
    /// Which scene: 0 is the box with two blocks, 1 with a knot, 2 with a diffuse and a mirror knot
    /// under two lights, 3 with a pine cone of a million triangles; 4 is a hall of statues
    #[arg(long, default_value_t = 0)]
    scene: u32,
    /// Stand this mesh in the box instead of the blocks or the statue; twice for two statues
    #[arg(long, value_name = "FILE.{obj,gltf,glb}")]
    mesh: Vec<PathBuf>,
    /// Make the tall block, or the mesh, an ideal mirror
    #[arg(long)]
    specular: bool,
    /// About how many triangles all statues have together
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(100..))]
    triangles: Option<u32>,
    #[command(flatten)]
    render: RenderOptions,
}

/// Makes a mesh of about so many triangles.
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

/// Does what `options` ask for.
///
/// # Errors
/// What a user has to know, with the file it concerns.
pub fn run(options: &Options) -> Result<()> {
    let job = options.render.prepare("cornell.png")?;
    let (model, camera) = options.scene()?;
    job.run(&model, &camera, Rgb::BLACK)
}

impl Options {
    fn scene(&self) -> Result<(Model, Camera)> {
        ensure!(self.mesh.len() <= 2, "--mesh: at most two");
        let meshes = self.mesh.iter().map(|path| mesh(path)).collect::<Result<Vec<_>>>()?;
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
            4 => {
                let statues = self.statues(meshes, HALL, 1_000_000);
                return Ok((cornell::hall_with_statues(&statues)?, cornell::hall_camera()?));
            }
            scene => anyhow::bail!("--scene {scene}: there are only scenes 0 to 4"),
        };
        Ok((model, cornell::camera()?))
    }

    /// The meshes from files; else sculptures of so many triangles together, if no other number is
    /// asked for.
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

fn mesh(path: &Path) -> Result<Vec<Triangle>> {
    let mesh = crate::load_mesh(path)?;
    ensure!(cornell::has_extent(&mesh), "{}: all vertices are the same point", path.display());
    Ok(mesh)
}
