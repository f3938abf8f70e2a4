//! Tables as Markdown.

use super::row::Row;
use crate::table::table;
use std::io::{Result, Write};

/// Writes the table of one mesh, with a row for each accelerator.
pub(crate) fn write(out: &mut impl Write, rows: &[Row]) -> Result<()> {
    let first = &rows[0];
    writeln!(
        out,
        "\n{}: {} triangles; {} camera rays, {} bounce and shadow rays; hash {}\n",
        first.mesh, first.triangles, first.camera_rays, first.bounce_rays, first.hash
    )?;
    let mut table = table(&[
        "structure",
        "build ms",
        "B/tri",
        "camera ns",
        "bounce ns",
        "any shadow ns",
        "any bounce ns",
        "visits",
        "tests",
        "repeated",
        "break-even",
    ]);
    for (i, row) in rows.iter().enumerate() {
        let never = if i + 1 < rows.len() { "never" } else { "" };
        let one = |x: f64| format!("{x:.1}");
        let whole = |x: f64| format!("{x:.0}");
        table.add_row([
            row.accelerator.clone(),
            one(row.build_ms),
            whole(row.bytes_per_triangle),
            whole(row.closest_camera_ns),
            whole(row.closest_bounce_ns),
            whole(row.any_shadow_ns),
            whole(row.any_bounce_ns),
            one(row.visits_bounce),
            one(row.tests_bounce),
            one(row.repeats_bounce),
            row.break_even_rays.map_or(never.to_owned(), |rays| format!("{:.2} M", rays / 1e6)),
        ]);
    }
    writeln!(
        out,
        "{table}\n\nVisits, tests and repeated tests are per bounce ray. Break-even is the number of bounce rays after\n\
         which the next row, which takes longer to build, is faster in total.\n"
    )
}

/// Writes the total times of the closest-hit queries of two k-d trees and the grid.
pub(crate) fn write_totals(out: &mut impl Write, rows: &[Vec<Row>]) -> Result<()> {
    let mut table = table(&["mesh", "structure", "build ms", "rays", "all queries ns"]);
    for row in rows.iter().flatten() {
        if ["k-d tree, sliding midpoint", "k-d tree", "uniform grid"].contains(&row.accelerator.as_str()) {
            let rays = row.camera_rays + row.bounce_rays;
            let all = row.closest_camera_ns * row.camera_rays as f64
                + row.closest_bounce_ns * row.bounce_rays as f64;
            table.add_row([
                row.mesh.clone(),
                row.accelerator.clone(),
                format!("{:.1}", row.build_ms),
                rays.to_string(),
                format!("{all:.0}"),
            ]);
        }
    }
    writeln!(out, "\nTotal times for the closest hits of camera and bounce rays:\n\n{table}\n")
}
