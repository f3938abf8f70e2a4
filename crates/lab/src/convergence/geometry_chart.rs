//! Three panels: ray-triangle tests, furnaces by size, furnaces by offset.

use super::geometry::{Decision, Furnace, Geometry};
use crate::plot::{self, Drawing, failed};
use anyhow::Result;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::series::DashedLineSeries;
use std::path::{Path, PathBuf};

const OURS: RGBColor = RGBColor(68, 1, 84);
const THEIRS: RGBColor = RGBColor(230, 120, 20);

/// Draws `geometry.svg` and `geometry.png`.
pub(crate) fn write(folder: &Path, geometry: &Geometry) -> Result<[PathBuf; 2]> {
    plot::write_both(folder, "geometry", &Chart(geometry))
}

struct Chart<'g>(&'g Geometry);

impl Drawing for Chart<'_> {
    fn size(&self) -> (u32, u32) {
        (1260, 400)
    }

    fn draw<'a, B: DrawingBackend + 'a>(&self, area: &DrawingArea<B, Shift>) -> Result<()> {
        let [left, middle, right] = &area.split_evenly((1, 3))[..] else { return Ok(()) };
        decisions(left, &self.0.decisions)?;
        // The logarithmic axis has no zero: the furnace without offset is in the table only.
        let moved: Vec<&Furnace> = self.0.offsets.iter().filter(|furnace| furnace.offset > 0.0).collect();
        let sizes: Vec<&Furnace> = self.0.sizes.iter().collect();
        furnaces(middle, "furnace at the origin", "half its side, in any unit", &sizes, |furnace| {
            furnace.half
        })?;
        furnaces(
            right,
            "furnace of half side 1",
            "offset along each axis, in the same unit",
            &moved,
            |furnace| furnace.offset,
        )
    }
}

fn decisions<'a, B: DrawingBackend + 'a>(area: &DrawingArea<B, Shift>, decisions: &[Decision]) -> Result<()> {
    let slowest = decisions.iter().map(|d| d.nanoseconds[0]).fold(0.0, f64::max);
    let mut chart = ChartBuilder::on(area)
        .caption("ray-triangle tests", ("sans-serif", 18))
        .margin(10)
        .x_label_area_size(40)
        .y_label_area_size(64)
        .build_cartesian_2d(0.0..1.6 * slowest, (1e-16..10.0).log_scale())
        .map_err(failed)?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .x_desc("nanoseconds a test")
        .y_desc("largest relative error of t")
        .y_labels(10)
        .x_label_formatter(&|x| format!("{x:.0}"))
        .y_label_formatter(&|y: &f64| format!("1e{:.0}", y.log10()))
        .label_style(("sans-serif", 13))
        .axis_desc_style(("sans-serif", 14))
        .draw()
        .map_err(failed)?;
    for (place, decision) in decisions.iter().enumerate() {
        let at = (decision.nanoseconds[0], decision.ulps.max * decision.ulp);
        let colour = if decision.name.contains("f64") { OURS } else { THEIRS };
        let lines = [
            decision.name.to_owned(),
            format!("{:.0} leaks of 1e6", decision.leaks[0].max(decision.leaks[1])),
        ];
        // The two tests in single precision lie close together: one label is above, one below.
        let above = if place == 0 { -40 } else { 8 };
        for (line, text) in lines.into_iter().enumerate() {
            let label = Text::new(text, (-60, above + 15 * line as i32), ("sans-serif", 13));
            chart.draw_series([EmptyElement::at(at) + label]).map_err(failed)?;
        }
        chart.draw_series([Circle::new(at, 5, colour.filled())]).map_err(failed)?;
    }
    Ok(())
}

fn furnaces<'a, B: DrawingBackend + 'a>(
    area: &DrawingArea<B, Shift>,
    title: &str,
    unit: &str,
    furnaces: &[&Furnace],
    place: impl Fn(&Furnace) -> f64,
) -> Result<()> {
    let [first, .., last] = furnaces else { return Ok(()) };
    let span = place(first) / 3.0..place(last) * 3.0;
    let mut chart = ChartBuilder::on(area)
        .caption(title, ("sans-serif", 18))
        .margin(10)
        .x_label_area_size(40)
        .y_label_area_size(50)
        .build_cartesian_2d(span.log_scale(), 0.0..6.5)
        .map_err(failed)?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .x_desc(unit)
        .y_desc("radiance found, instead of 5")
        .x_labels(7)
        .x_label_formatter(&|x: &f64| format!("1e{:.0}", x.log10()))
        .label_style(("sans-serif", 13))
        .axis_desc_style(("sans-serif", 14))
        .draw()
        .map_err(failed)?;
    let ours: Vec<_> = furnaces.iter().map(|furnace| (place(furnace), furnace.loss.mean)).collect();
    let theirs: Vec<_> =
        furnaces.iter().filter_map(|furnace| Some((place(furnace), furnace.mitsuba?))).collect();
    chart.draw_series(LineSeries::new(ours.clone(), OURS.stroke_width(2))).map_err(failed)?;
    let circle = |at: &(f64, f64)| Circle::new(*at, 5, OURS.filled());
    let drawn = chart.draw_series(ours.iter().map(circle)).map_err(failed)?;
    drawn.label("globillum").legend(|(x, y)| Circle::new((x + 8, y), 5, OURS.filled()));
    let line = DashedLineSeries::new(theirs.clone(), 7, 5, THEIRS.stroke_width(2));
    chart.draw_series(line).map_err(failed)?;
    let triangle = |at: &(f64, f64)| TriangleMarker::new(*at, 7, THEIRS.filled());
    let drawn = chart.draw_series(theirs.iter().map(triangle)).map_err(failed)?;
    drawn.label("Mitsuba 3.9.1").legend(|(x, y)| TriangleMarker::new((x + 8, y), 7, THEIRS.filled()));
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerLeft)
        .label_font(("sans-serif", 14))
        .background_style(WHITE)
        .border_style(BLACK)
        .draw()
        .map_err(failed)
}
