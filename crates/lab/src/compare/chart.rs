//! Bar charts: build times on the left, query times on the right, one row of panels per mesh.

use super::row::Row;
use crate::plot::{self, Drawing, failed};
use anyhow::Result;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::path::{Path, PathBuf};

/// The colour, name and value of a kind of bar.
struct Series {
    name: &'static str,
    color: RGBColor,
    value: fn(&Row) -> f64,
}

const BUILD: [Series; 1] = [Series { name: "build", color: RGBColor(68, 1, 84), value: |row| row.build_ms }];

/// The colours differ in brightness too, so that they remain distinct in greyscale print.
const QUERIES: [Series; 3] = [
    Series { name: "closest, camera", color: RGBColor(68, 1, 84), value: |row| row.closest_camera_ns },
    Series { name: "closest, bounce", color: RGBColor(33, 145, 140), value: |row| row.closest_bounce_ns },
    Series { name: "any, shadow", color: RGBColor(190, 210, 60), value: |row| row.any_shadow_ns },
];

/// Draws all rows as `compare.svg` and `compare.png` in `folder`.
pub(crate) fn write(folder: &Path, rows: &[Vec<Row>]) -> Result<[PathBuf; 2]> {
    plot::write_both(folder, "compare", &Bars(rows))
}

/// A row of two panels for each mesh.
struct Bars<'r>(&'r [Vec<Row>]);

impl Drawing for Bars<'_> {
    fn size(&self) -> (u32, u32) {
        (1200, 330 * self.0.len() as u32)
    }

    fn draw<'a, B: DrawingBackend + 'a>(&self, area: &DrawingArea<B, Shift>) -> Result<()> {
        for (cell, rows) in area.split_evenly((self.0.len(), 1)).iter().zip(self.0) {
            let (left, right) = cell.split_horizontally(560);
            panel(&left, rows, "build time in ms", &BUILD)?;
            panel(&right, rows, "time of a query in ns", &QUERIES)?;
        }
        Ok(())
    }
}

/// One bar for each row and series, the first row on top.
fn panel<'a, B: DrawingBackend + 'a>(
    area: &DrawingArea<B, Shift>,
    rows: &[Row],
    unit: &str,
    series: &[Series],
) -> Result<()> {
    let values = rows.iter().flat_map(|row| series.iter().map(|s| (s.value)(row)));
    let longest = values.fold(0.0, f64::max);
    // Bars leave room for the legend, if there is one.
    let width = longest * if series.len() > 1 { 1.3 } else { 1.05 };
    let count = rows.len() as f64;
    let mut chart = ChartBuilder::on(area)
        .caption(format!("{} ({} triangles)", rows[0].mesh, rows[0].triangles), ("sans-serif", 16))
        .margin(8)
        .x_label_area_size(36)
        .y_label_area_size(165)
        .build_cartesian_2d(0.0..width, 0.0..count)
        .map_err(failed)?;
    let whole = |x: &f64| format!("{x:.0}");
    let mut mesh = chart.configure_mesh();
    mesh.disable_y_mesh().disable_y_axis().x_desc(unit).x_label_formatter(&whole).draw().map_err(failed)?;
    let bottom = |row: usize| count - 1.0 - row as f64;
    let right = ("sans-serif", 13).into_font().color(&BLACK).pos(Pos::new(HPos::Right, VPos::Center));
    let names = rows.iter().enumerate().map(|(i, row)| {
        EmptyElement::at((0.0, bottom(i) + 0.5)) + Text::new(row.accelerator.clone(), (-6, 0), right.clone())
    });
    chart.draw_series(names).map_err(failed)?;
    let thickness = 0.84 / series.len() as f64;
    for (place, Series { name, color, value }) in series.iter().enumerate() {
        let bar = |(i, row)| {
            let top = bottom(i) + 0.92 - place as f64 * thickness;
            Rectangle::new([(0.0, top), (value(row), top - thickness)], color.filled())
        };
        let drawn = chart.draw_series(rows.iter().enumerate().map(bar)).map_err(failed)?;
        drawn.label(*name).legend(|(x, y)| Rectangle::new([(x, y - 5), (x + 12, y + 5)], color.filled()));
    }
    if series.len() > 1 {
        let mut legend = chart.configure_series_labels();
        legend.position(SeriesLabelPosition::LowerRight).background_style(WHITE.mix(0.9)).border_style(BLACK);
        legend.draw().map_err(failed)?;
    }
    Ok(())
}
