//! Traces the same rays with this library's accelerators and with other libraries. See README.md.

mod bvh;
mod embree;
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
use globillum::geom::{KdOptions, KdTree};
use indicatif::{ProgressBar, ProgressStyle};
use measure::measure;
use peer::Entry;
use rays::Kind;
use report::{Machine, MeshReport, Report, Row};
use scenes::{Indexed, Scene};
use std::path::PathBuf;
use std::process::Command;

/// Traces the same rays with this library's accelerators and with other libraries.
#[derive(Parser)]
#[command(version)]
struct Options {
    /// An OBJ file, or "room", "terrain" or "statue"; may be given several times
    #[arg(long = "mesh", value_name = "MESH")]
    meshes: Vec<String>,
    /// Camera rays, rounded up to a square of whole tiles
    #[arg(long, default_value_t = 512 * 512, value_parser = clap::value_parser!(u32).range(1..=1 << 26))]
    rays: u32,
    /// Timed rounds; the best is reported
    #[arg(long, default_value_t = 7, value_parser = clap::value_parser!(u32).range(1..))]
    repeats: u32,
    /// Also write all figures to this file
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

fn main() -> Result<()> {
    let options = Options::parse();
    let names = if options.meshes.is_empty() { scenes::defaults() } else { options.meshes.clone() };
    let embree = Embree::from_env()?;
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
    let scene = Scene::load(name).with_context(|| format!("mesh {name}"))?;
    let entries = build(&scene, embree)?;
    let tree = KdTree::build(&scene.triangles, &KdOptions::default())?;
    let rays = rays::generate(&scene, &tree, options.rays);
    ensure!(
        rays.iter().all(|rays| !rays.is_empty()),
        "mesh {name}: no ray of some kind; the camera or the light does not see the mesh"
    );
    progress.inc_length(3 * u64::from(options.repeats) * entries.len() as u64);
    let outcomes = [0, 1, 2].map(|i| {
        progress.set_message(format!("{}: {:?}", scene.name, Kind::ALL[i]));
        measure(&entries, Kind::ALL[i], &rays[i], options.repeats as usize, || progress.inc(1))
    });
    let row = |(i, entry)| Row::new(entry, [0, 1, 2].map(|kind| outcomes[kind][i]));
    Ok(MeshReport {
        mesh: scene.name,
        triangles: scene.triangles.len(),
        rays: rays.map(|rays| rays.len()),
        rows: entries.iter().enumerate().map(row).collect(),
    })
}

/// Every structure over the scene's mesh, this library's first.
fn build(scene: &Scene, embree: Option<&Embree>) -> Result<Vec<Entry>> {
    let indexed = Indexed::new(&scene.triangles);
    let mut entries = ours::build(&scene.triangles)?;
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

    /// Includes Embree if `EMBREE_LIB` is set.
    #[test]
    fn all_peers_agree_except_for_rays_through_edges() {
        let scene = Scene::load("room").expect("it is procedural");
        let embree = Embree::from_env().expect("EMBREE_LIB names Embree or is unset");
        let entries = build(&scene, embree.as_ref()).expect("the mesh is good");
        let tree = KdTree::build(&scene.triangles, &KdOptions::default()).expect("the mesh is good");
        let rays = rays::generate(&scene, &tree, 4096);
        for (kind, rays) in Kind::ALL.into_iter().zip(&rays) {
            let outcomes = measure(&entries, kind, rays, 1, || {});
            for (Entry { structure, mode, .. }, outcome) in entries.iter().zip(outcomes) {
                let Differences { missed, invented, elsewhere } = outcome.differences;
                let all = missed + invented + elsewhere;
                assert!(all <= 4, "{structure} {mode}, {kind:?} rays: {:?}", outcome.differences);
            }
        }
    }
}
