//! Reports speed against error, for pictures and for ray-triangle tests:
//! `cargo run --release -p globillum-lab --bin convergence -- --quick`.
//!
//! docs/convergence.md explains a report.

mod chart;
mod combination;
mod corner;
mod errors;
mod furnace;
mod geometry;
mod geometry_chart;
mod ladder;
mod plan;
mod race;
mod reference;
mod report;
mod rows;
mod strip;
mod study;
mod subject;
mod verdict;

use anyhow::{Context, Result};
use geometry::Geometry;
use indicatif::{ProgressBar, ProgressStyle};
pub use plan::Options;
use std::io::Write;
use study::Study;

/// Measures everything, and writes the files; their names go to `out`.
///
/// # Errors
/// An invalid option, or a file that cannot be read or written; the message names it. An error of `out`.
pub fn run(options: &Options, out: &mut impl Write) -> Result<()> {
    let plan = options.plan()?;
    let subjects = options.subjects()?;
    let folder = &options.out;
    std::fs::create_dir_all(folder.join("pictures")).with_context(|| folder.display().to_string())?;

    let bar = ProgressBar::new((subjects.len() * Study::steps(&plan) + Geometry::STEPS) as u64);
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos}/{len}, {elapsed} elapsed, {msg}") {
        bar.set_style(style);
    }
    let studies = subjects
        .iter()
        .map(|subject| Study::of(subject, &plan, &bar).with_context(|| subject.name.clone()))
        .collect::<Result<Vec<_>>>()?;
    let geometry = Geometry::measure(&plan, &bar);
    bar.finish_and_clear();

    let mut written = rows::write(folder, &studies)?;
    for study in &studies {
        written.extend(chart::write(folder, study)?);
        written.push(strip::write(folder, study)?);
    }
    written.extend(geometry_chart::write(folder, &geometry)?);
    written.push(report::write(folder, &plan, &studies, &geometry)?);
    for path in &written {
        writeln!(out, "{}", path.display())?;
    }
    Ok(())
}
