//! The cost of each pixel's camera ray, as a picture and as a histogram.

use super::structures::Structures;
use crate::plot::{self, Drawing, Scale, failed, short};
use anyhow::Result;
use globillum::geom::{Counts, KdTree, Ray, SplitRule, Traverse, UniformGrid};
use globillum_testkit::meshes::Subject;
use globillum_testkit::rays::Rays;
use plotters::coord::Shift;
use plotters::prelude::*;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Node visits and triangle tests of each pixel's camera ray.
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

/// The costs of the default k-d tree, of the sliding midpoint tree and of the grid.
fn all_costs(subject: &Subject, side: u32, structures: &Structures) -> Result<[Costs; 3]> {
    let triangles = &subject.triangles;
    let kd = KdTree::build_with(triangles, &structures.usual_kd())?;
    let sliding = KdTree::build_with(triangles, &structures.kd(SplitRule::SlidingMidpoint))?;
    let grid = UniformGrid::build_with(triangles, &structures.grid())?;
    let rays = Rays::new(subject, side)?.camera;
    Ok([costs("kd", &kd, &rays), costs("sliding", &sliding, &rays), costs("grid", &grid, &rays)])
}

/// Writes the number of pixels by cost, in classes of doubling width.
pub(crate) fn write_histogram(
    out: &mut impl Write,
    subject: &Subject,
    side: u32,
    structures: &Structures,
) -> Result<()> {
    writeln!(out, "pixels by visits and tests of their camera ray:")?;
    for Costs { structure, of_pixels } in all_costs(subject, side, structures)? {
        writeln!(out, "  {structure}")?;
        let class = |cost: &u64| cost.checked_ilog2().map_or(0, |log| log as usize + 1);
        let mut classes = vec![0_usize; of_pixels.iter().map(class).max().unwrap_or(0) + 1];
        of_pixels.iter().for_each(|cost| classes[class(cost)] += 1);
        for (i, &count) in classes.iter().enumerate().filter(|&(_, &count)| count > 0) {
            let bar = "#".repeat((60 * count).div_ceil(of_pixels.len()));
            writeln!(
                out,
                "  {:>7} {count:>8} {bar}",
                if i == 0 { "0".to_owned() } else { format!("< {}", 1_u64 << i) }
            )?;
        }
    }
    Ok(())
}

/// Draws one heat map for each structure. All maps of a mesh share one logarithmic scale.
pub(crate) fn write_maps(
    folder: &Path,
    subject: &Subject,
    side: u32,
    structures: &Structures,
) -> Result<Vec<PathBuf>> {
    let all = all_costs(subject, side, structures)?;
    let most = all.iter().flat_map(|costs| &costs.of_pixels).max().copied().unwrap_or(0).max(2);
    let write = |costs: &Costs| {
        let path = folder.join(format!("heat-{}-{}.png", subject.name, costs.structure));
        plot::write_png(&path, &HeatMap { costs, side, scale: Scale::new(1.0..most as f64) })?;
        Ok(path)
    };
    all.iter().map(write).collect()
}

/// A map with a square of pixels for each ray, and the colour scale below it.
struct HeatMap<'c> {
    costs: &'c Costs,
    /// Rays along each side.
    side: u32,
    scale: Scale,
}

/// The least number of pixels along each side of a map.
const MIN_SIDE: u32 = 384;
const MARGIN: u32 = 16;
/// The height of the scale and its caption.
const BELOW: u32 = 64;

impl HeatMap<'_> {
    /// Pixels along each side of a ray's square.
    fn zoom(&self) -> u32 {
        MIN_SIDE.div_ceil(self.side)
    }
}

impl Drawing for HeatMap<'_> {
    fn size(&self) -> (u32, u32) {
        let map = self.zoom() * self.side;
        (map + 2 * MARGIN, MARGIN + map + BELOW)
    }

    fn draw<'a, B: DrawingBackend + 'a>(&self, area: &DrawingArea<B, Shift>) -> Result<()> {
        let (zoom, side) = (self.zoom(), self.side);
        for (i, &cost) in (0..).zip(&self.costs.of_pixels) {
            let at = |x, y| ((MARGIN + x * zoom) as i32, (MARGIN + y * zoom) as i32);
            let (x, y) = (i % side, i / side);
            let colour = self.scale.colour(cost as f64);
            area.draw(&Rectangle::new([at(x, y), at(x + 1, y + 1)], colour.filled())).map_err(failed)?;
        }
        let (left, top) = (MARGIN as i32, (MARGIN + zoom * side + 8) as i32);
        self.scale.draw(area, (left, top), (zoom * side) as i32, short)?;
        let text = "visits and tests of a pixel's camera ray";
        area.draw(&Text::new(text, (left, top + Scale::HEIGHT), ("sans-serif", 15))).map_err(failed)
    }
}
