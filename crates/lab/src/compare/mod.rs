//! Compares every accelerator and every split rule on a few meshes:
//! `cargo run --release -p globillum-lab --bin compare`.
//!
//! docs/accelerators.md contains the tables and explains them.

mod chart;
mod heat;
mod measure;
mod row;
mod shape;
mod structures;
mod tables;

use crate::machine::{command, cpu_model};
use anyhow::{Context, Result, ensure};
use clap::Parser;
use globillum_cli::load_mesh;
use globillum_testkit::meshes::{Subject, procedural};
use globillum_testkit::rays::Rays;
use measure::measure;
use row::Row;
use std::io::Write;
use std::path::{Path, PathBuf};
use structures::Structures;

/// Compares every accelerator and every split rule on a few meshes.
#[derive(Debug, Parser)]
#[command(version)]
pub struct Options {
    /// Compare on this mesh instead of the procedural ones; may be given several times
    #[arg(long, value_name = "FILE.obj")]
    mesh: Vec<PathBuf>,
    /// Pixels along each side of the square picture, with one camera ray each
    #[arg(long, default_value_t = 192, value_parser = clap::value_parser!(u32).range(1..=4096))]
    side: u32,
    /// Factor on the camera distance; the field of view narrows, so the mesh fills the picture as before
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, value_parser = farther)]
    farther: f64,
    /// Repetitions of each timing; the median is reported
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    repeats: u32,
    #[command(flatten)]
    structures: Structures,
    /// The folder for compare.csv, compare.svg, compare.png and the heat maps
    #[arg(long, value_name = "DIR", default_value = "compare")]
    out: PathBuf,
}

/// Measures everything, and writes the files; tables and the files' names go to `out`.
///
/// # Errors
/// An invalid option, or a file that cannot be read or written; the message names it. An error of `out`.
pub fn run(options: &Options, out: &mut impl Write) -> Result<()> {
    let subjects = options.subjects()?;
    let folder = &options.out;
    std::fs::create_dir_all(folder).with_context(|| format!("{}: cannot be created", folder.display()))?;
    let contenders = options.structures.contenders();
    let progress =
        indicatif::ProgressBar::new((subjects.len() * contenders.len()) as u64 * u64::from(options.repeats));
    let mut rows: Vec<Vec<Row>> = Vec::new();
    for subject in &subjects {
        let rays = Rays::new(subject, options.side)?;
        let measured = measure(&contenders, subject, &rays, options.repeats as usize, || progress.inc(1))?;
        rows.push(row::rows(&subject.name, subject.triangles.live().len(), &rays, measured));
    }
    progress.finish_and_clear();

    for (subject, rows) in subjects.iter().zip(&rows) {
        tables::write(out, rows)?;
        shape::write(out, &subject.triangles, &options.structures)?;
        heat::write_histogram(out, subject, options.side, &options.structures)?;
    }
    tables::write_totals(out, &rows)?;
    writeln!(out, "{}: `{}`", cpu_model().unwrap_or_else(|| "unknown".to_owned()), command("compare"))?;

    let mut written = vec![row::write_csv(folder, &rows)?];
    written.extend(chart::write(folder, &rows)?);
    for subject in &subjects {
        written.extend(heat::write_maps(folder, subject, options.side, &options.structures)?);
    }
    for path in &written {
        writeln!(out, "{}", path.display())?;
    }
    assert_one_hash(&rows)
}

fn assert_one_hash(rows: &[Vec<Row>]) -> Result<()> {
    for rows in rows {
        for row in rows {
            ensure!(row.hash == rows[0].hash, "{}: {} gives different answers", row.mesh, row.accelerator);
        }
    }
    Ok(())
}

impl Options {
    fn subjects(&self) -> Result<Vec<Subject>> {
        let mut subjects = self.meshes()?;
        for subject in &mut subjects {
            subject.eye = subject.target + self.farther * (subject.eye - subject.target);
            subject.half_height /= self.farther;
        }
        Ok(subjects)
    }

    /// Each mesh with its default camera.
    fn meshes(&self) -> Result<Vec<Subject>> {
        if self.mesh.is_empty() {
            return Ok(procedural()?);
        }
        let subjects = self.mesh.iter().map(|path| subject_from(path)).collect::<Result<Vec<_>>>()?;
        for (i, subject) in subjects.iter().enumerate() {
            let twice = subjects[..i].iter().any(|other| other.name == subject.name);
            ensure!(!twice, "--mesh: two meshes are named {}; their pictures would collide", subject.name);
        }
        Ok(subjects)
    }
}

/// Parses a factor on the camera distance. The limit keeps rays of different pixels distinct.
fn farther(text: &str) -> Result<f64, String> {
    let factor: f64 = text.parse().map_err(|_| "expected a number".to_owned())?;
    let range = 1.0..=1e15;
    if range.contains(&factor) { Ok(factor) } else { Err("it must lie in [1, 1e15]".to_owned()) }
}

fn subject_from(path: &Path) -> Result<Subject> {
    let mesh = load_mesh(path)?;
    let name =
        path.file_stem().map_or_else(|| path.display().to_string(), |s| s.to_string_lossy().into_owned());
    let subject = Subject::new(name, mesh)?;
    ensure!(!subject.triangles.live().is_empty(), "{}: no triangle can be hit", path.display());
    Ok(subject)
}
