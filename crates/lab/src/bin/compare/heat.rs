//! The cost of each pixel's camera ray, as a picture and as a histogram.
#![allow(clippy::print_stdout, reason = "examples talk to people")]

use crate::structures::Structures;
use anyhow::Result;
use globillum::geom::{Counts, KdTree, Ray, SplitRule, Traverse, UniformGrid};
use globillum_lab::plot::write_png;
use globillum_testkit::meshes::Subject;
use globillum_testkit::rays::Rays;
use image::{Rgb, RgbImage};
use plotters::style::Color;
use plotters::style::colors::colormaps::{ColorMap, ViridisRGB};
use std::path::{Path, PathBuf};

/// Visits and tests that a pixel's camera ray takes.
struct Costs {
    structure: &'static str,
    of_pixels: Vec<u64>,
}

fn costs(structure: &'static str, accel: &impl Traverse, rays: &[Ray]) -> Costs {
    let cost = |ray| {
        let (_, counts) = Counts::closest(accel, ray);
        counts.visits + counts.tests
    };
    Costs { structure, of_pixels: rays.iter().map(cost).collect() }
}

/// Of the best tree, the best of the other rules, and the grid.
fn all_costs(subject: &Subject, side: u32, structures: &Structures) -> Result<[Costs; 3]> {
    let triangles = &subject.triangles;
    let kd = KdTree::build(triangles, &structures.usual_kd())?;
    let sliding = KdTree::build(triangles, &structures.kd(SplitRule::SlidingMidpoint))?;
    let grid = UniformGrid::build(triangles, &structures.grid())?;
    let rays = Rays::new(subject, &kd, side).camera;
    Ok([costs("kd", &kd, &rays), costs("sliding", &sliding, &rays), costs("grid", &grid, &rays)])
}

/// Prints how many pixels cost how much, in classes that double.
pub(crate) fn print_histogram(subject: &Subject, side: u32, structures: &Structures) -> Result<()> {
    println!("pixels by visits and tests of their camera ray:");
    for Costs { structure, of_pixels } in all_costs(subject, side, structures)? {
        println!("  {structure}");
        let class = |cost: &u64| cost.checked_ilog2().map_or(0, |log| log as usize + 1);
        let mut classes = vec![0_usize; of_pixels.iter().map(class).max().unwrap_or(0) + 1];
        of_pixels.iter().for_each(|cost| classes[class(cost)] += 1);
        for (i, &count) in classes.iter().enumerate().filter(|&(_, &count)| count > 0) {
            let bar = "#".repeat((60 * count).div_ceil(of_pixels.len()));
            println!(
                "  {:>7} {count:>8} {bar}",
                if i == 0 { "0".to_owned() } else { format!("< {}", 1_u64 << i) }
            );
        }
    }
    Ok(())
}

/// Writes one heat map for each structure, all of a mesh on one logarithmic scale.
pub(crate) fn write_maps(
    folder: &Path,
    subject: &Subject,
    side: u32,
    structures: &Structures,
) -> Result<Vec<PathBuf>> {
    let all = all_costs(subject, side, structures)?;
    let most = all.iter().flat_map(|costs| &costs.of_pixels).max().copied().unwrap_or(0).max(1);
    let write = |costs: &Costs| {
        let path = folder.join(format!("heat-{}-{}.png", subject.name, costs.structure));
        let color = |x, y| {
            let cost = costs.of_pixels[(y * side + x) as usize];
            let (r, g, b) = ViridisRGB.get_color((1.0 + cost as f32).ln() / (1.0 + most as f32).ln()).rgb();
            Rgb([r, g, b])
        };
        write_png(&path, &RgbImage::from_fn(side, side, color))?;
        Ok(path)
    };
    all.iter().map(write).collect()
}
