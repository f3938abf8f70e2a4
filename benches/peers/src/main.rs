//! Traces the same rays with this library's accelerators and with other libraries. See README.md.

mod apartment;
mod bvh;
mod embree;
mod furniture;
mod markdown;
mod measure;
mod obvhs;
mod ours;
mod parry;
mod peer;
mod procedural;
mod rays;
mod report;
mod scenes;

use anyhow::{Context, Result, ensure};
use clap::Parser;
use embree::Embree;
use globillum::geom::{KdTree, SimdLevel};
use indicatif::{ProgressBar, ProgressStyle};
use measure::measure;
use peer::Entry;
use rays::{Kind, RaySet};
use report::{Machine, MeshReport, Report, Row, SetReport};
use scenes::{Indexed, Light, Scene, View};
use std::path::PathBuf;
use std::process::Command;

/// Traces the same rays with this library's accelerators and with other libraries.
#[derive(Parser)]
#[command(version)]
struct Options {
    /// An OBJ file, or "room", "kitchen", "living-room", "terrain" or "statue"; may be given several times
    #[arg(long = "mesh", value_name = "MESH")]
    meshes: Vec<String>,
    /// Where the camera is in each OBJ file, which then is an interior
    #[arg(long, value_name = "X,Y,Z", requires_all = ["at", "light"], value_parser = numbers::<3>, allow_hyphen_values = true)]
    eye: Option<[f64; 3]>,
    /// A point in the middle of the picture
    #[arg(long, value_name = "X,Y,Z", requires = "eye", value_parser = numbers::<3>, allow_hyphen_values = true)]
    at: Option<[f64; 3]>,
    /// The camera's full angle of view
    #[arg(long, value_name = "DEGREES", requires = "eye", default_value_t = 60.0)]
    fov: f64,
    /// A rectangular light that faces down: its center, width along x and depth along z
    #[arg(long, alias = "lamp", value_name = "X,Y,Z,WIDTH,DEPTH", requires = "eye", value_parser = numbers::<5>, allow_hyphen_values = true)]
    light: Option<[f64; 5]>,
    /// The instructions that the wide BVH and Embree may use
    #[arg(long, value_enum, default_value_t = Isa::Best)]
    isa: Isa,
    /// Camera rays, rounded up to a square of whole tiles
    #[arg(long, default_value_t = 512 * 512, value_parser = clap::value_parser!(u32).range(1..=1 << 26))]
    rays: u32,
    /// Timed rounds; the best is reported
    #[arg(long, default_value_t = 7, value_parser = clap::value_parser!(u32).range(1..))]
    repeats: u32,
    /// Only structures whose name contains this; may be given several times
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,
    /// Also write all figures to this file
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// Instruction sets.
#[derive(Clone, Copy, clap::ValueEnum)]
enum Isa {
    /// All that the machine has
    Best,
    /// AVX2, without AVX-512
    Avx2,
}

impl Isa {
    fn level(self) -> SimdLevel {
        match self {
            Self::Best => SimdLevel::Avx512,
            Self::Avx2 => SimdLevel::Avx2,
        }
    }
}

/// Numbers between commas.
fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let parse = |x: &str| x.trim().parse().ok().filter(|x: &f64| x.is_finite());
    let numbers: Option<Vec<f64>> = text.split(',').map(parse).collect();
    let numbers = numbers.and_then(|numbers| numbers.try_into().ok());
    numbers.ok_or_else(|| format!("{N} numbers with commas between them are expected"))
}

impl Options {
    fn covers(&self, structure: &str) -> bool {
        self.only.is_empty() || self.only.iter().any(|name| structure.contains(name))
    }

    /// The scene of that name, with the camera and the light of the options if it is a file.
    fn scene(&self, name: &str) -> Result<Scene> {
        let scene = Scene::load(name).with_context(|| format!("mesh {name}"))?;
        let (Some(eye), Some(at), Some([x, y, z, width, depth])) = (self.eye, self.at, self.light) else {
            return Ok(scene);
        };
        if scenes::PROCEDURAL.contains(&name) {
            return Ok(scene);
        }
        let view = View::of_angle(eye.into(), at.into(), self.fov);
        Ok(scene.seen_from(view, Light::facing_down([x, y, z].into(), [width, depth])))
    }
}

fn main() -> Result<()> {
    let options = Options::parse();
    let names = if options.meshes.is_empty() { scenes::defaults() } else { options.meshes.clone() };
    let embree = Embree::from_env(options.isa.level())?;
    let progress = progress_bar();
    let measured = names.iter().map(|name| measure_mesh(name, embree.as_ref(), &options, &progress));
    let meshes = measured.collect::<Result<Vec<_>>>()?;
    progress.finish_and_clear();
    let report = Report {
        machine: machine(embree.as_ref()),
        kinds: Kind::ALL,
        ratios: report::ratios(&meshes),
        meshes,
    };
    markdown::write(&mut std::io::stdout().lock(), &report)?;
    if let Some(file) = &options.json {
        let json = serde_json::to_string_pretty(&report)? + "\n";
        std::fs::write(file, json).with_context(|| format!("{} cannot be written", file.display()))?;
    }
    Ok(())
}

fn measure_mesh(
    name: &str,
    embree: Option<&Embree>,
    options: &Options,
    progress: &ProgressBar,
) -> Result<MeshReport> {
    progress.set_message(format!("{name}: build"));
    let scene = options.scene(name)?;
    let mut entries = build(&scene, embree, options.isa.level())?;
    entries.retain(|entry| options.covers(entry.structure));
    ensure!(!entries.is_empty(), "--only names no structure");
    let tree = KdTree::build(&scene.triangles)?;
    let rays = rays::generate(&scene, &tree, options.rays);
    ensure!(
        rays.iter().all(|rays| !rays.is_empty()),
        "mesh {name}: no ray of some kind; the camera or the light does not see the mesh"
    );
    let sets = if scene.is_interior { rays::wavefronts(&scene, &tree, options.rays) } else { Vec::new() };
    let count = (rays.len() + sets.len()) as u64;
    progress.inc_length(count * u64::from(options.repeats) * entries.len() as u64);
    let measured = |set: &RaySet| {
        progress.set_message(format!("{}: {}", scene.name, set.name));
        measure(&entries, set, options.repeats as usize, || progress.inc(1))
    };
    let outcomes = rays.each_ref().map(measured);
    let of_sets: Vec<_> = sets.iter().filter(|set| !set.is_empty()).map(measured).collect();
    let row = |(i, entry)| {
        let wavefronts = of_sets.iter().map(|outcomes| outcomes[i]).collect();
        Row::new(entry, [0, 1, 2].map(|kind| outcomes[kind][i]), wavefronts)
    };
    Ok(MeshReport {
        mesh: scene.name.clone(),
        triangles: scene.triangles.len(),
        rays: rays.each_ref().map(|rays| rays.len()),
        wavefronts: sets.iter().filter(|set| !set.is_empty()).map(SetReport::of).collect(),
        rows: entries.iter().enumerate().map(row).collect(),
    })
}

/// Every structure over the scene's mesh, this library's first.
fn build(scene: &Scene, embree: Option<&Embree>, level: SimdLevel) -> Result<Vec<Entry>> {
    let indexed = Indexed::new(&scene.triangles);
    let mut entries = ours::build(&scene.triangles, level)?;
    entries.extend(obvhs::build(&scene.triangles));
    entries.push(bvh::build(&scene.triangles));
    entries.push(parry::build(&indexed)?);
    if let Some(embree) = embree {
        entries.extend(embree.build(&indexed)?);
    }
    Ok(entries)
}

fn progress_bar() -> ProgressBar {
    let style = ProgressStyle::with_template("{msg:20} {wide_bar} {percent}%, {elapsed} elapsed");
    let bar = ProgressBar::new(0);
    style.map_or_else(|_| bar.clone(), |style| bar.clone().with_style(style))
}

fn machine(embree: Option<&Embree>) -> Machine {
    let options: Vec<_> = std::env::args().skip(1).collect();
    let separator = if options.is_empty() { "" } else { " -- " };
    Machine {
        cpu: cpu_model().unwrap_or_else(|| "unknown processor".to_owned()),
        rustc: output_of("rustc", "--version"),
        rustflags: std::env::var("RUSTFLAGS").unwrap_or_default(),
        embree: embree.map_or_else(|| "absent".to_owned(), |embree| embree.version.clone()),
        date: output_of("date", "+%F"),
        command: format!("cargo run --release -p globillum-peers{separator}{}", options.join(" ")),
    }
}

/// The processor's model name; `None` where it is unknown.
fn cpu_model() -> Option<String> {
    let info = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = info.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

/// The output of a program, or `unknown`.
fn output_of(program: &str, argument: &str) -> String {
    let output = Command::new(program).arg(argument).output().ok();
    let text = output.and_then(|output| String::from_utf8(output.stdout).ok());
    text.map_or_else(|| format!("{program} unknown"), |text| text.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use measure::Differences;

    #[test]
    fn numbers_are_read_or_refused() {
        assert_eq!(numbers::<3>("1, -2.5,3e1"), Ok([1.0, -2.5, 30.0]));
        for text in ["1,2", "1,2,3,4", "1,2,x", "", "1,2,inf"] {
            assert!(numbers::<3>(text).is_err(), "{text}");
        }
    }

    /// Includes Embree if `EMBREE_LIB` is set.
    #[test]
    fn all_peers_agree_except_for_rays_through_edges() {
        let scene = Scene::load("room").expect("it is procedural");
        let level = SimdLevel::Avx512;
        let embree = Embree::from_env(level).expect("EMBREE_LIB names Embree or is unset");
        let entries = build(&scene, embree.as_ref(), level).expect("the mesh is good");
        let tree = KdTree::build(&scene.triangles).expect("the mesh is good");
        let kinds = rays::generate(&scene, &tree, 4096);
        for rays in kinds.iter().chain(&rays::wavefronts(&scene, &tree, 4096)) {
            let outcomes = measure(&entries, rays, 1, || {});
            for (Entry { structure, mode, .. }, outcome) in entries.iter().zip(outcomes) {
                let Differences { missed, invented, elsewhere } = outcome.differences;
                let all = missed + invented + elsewhere;
                assert!(all <= 4, "{structure} {mode}, {} rays: {:?}", rays.name, outcome.differences);
            }
        }
    }
}
