//! Error over time on logarithmic axes, with a panel for each accelerator and a line for each combination.

use super::combination::{Combination, accel_name};
use super::ladder::{Ladder, Level};
use super::study::Study;
use crate::plot::{self, Drawing, failed, short, ticks};
use anyhow::Result;
use globillum::integrator::{Estimator, PathReuse, Sampler};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::series::DashedLineSeries;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Width and height of a panel with its title, labels and margins.
const SIZE: (u32, u32) = (420, 440);
/// Height of the axis title and legend below all panels.
const BELOW: u32 = 74;

/// Draws `study` as `convergence-NAME.svg` and `.png`.
pub(crate) fn write(folder: &Path, study: &Study) -> Result<[PathBuf; 2]> {
    plot::write_both(folder, &format!("convergence-{}", study.name), &Chart { study })
}

struct Chart<'s> {
    study: &'s Study,
}

impl Drawing for Chart<'_> {
    fn size(&self) -> (u32, u32) {
        (SIZE.0 * self.study.ladders_by_accel().len().max(3) as u32, SIZE.1 + BELOW)
    }

    fn draw<'a, B: DrawingBackend + 'a>(&self, area: &DrawingArea<B, Shift>) -> Result<()> {
        let by_accel = self.study.ladders_by_accel();
        let (panels, below) = area.split_vertically(SIZE.1);
        for (cell, ladders) in panels.split_evenly((1, by_accel.len())).iter().zip(&by_accel) {
            panel(cell, self.study, ladders)?;
        }
        let middle = ((self.size().0 / 2) as i32, 0);
        let centered = ("sans-serif", 14).into_font().color(&BLACK).pos(Pos::new(HPos::Center, VPos::Top));
        below.draw(&Text::new("seconds of rendering", middle, centered)).map_err(failed)?;
        draw_legend(&below)
    }
}

/// The ranges of both axes, common to all panels.
fn ranges(study: &Study) -> (Range<f64>, Range<f64>) {
    let levels = || study.ladders.iter().flat_map(|ladder| &ladder.levels).filter(|level| visible(level));
    let around = |values: &mut dyn Iterator<Item = f64>| {
        let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(low, high), x| (low.min(x), high.max(x)));
        if low < high { low / 1.5..high * 1.5 } else { 1e-3..1.0 }
    };
    let seconds = around(&mut levels().map(|level| level.seconds));
    (seconds, around(&mut levels().map(|level| level.errors.rmse())))
}

/// Whether the level's mean squared error exceeds twice its standard error, which includes the reference's
/// error.
fn visible(level: &Level) -> bool {
    level.errors.mse > 2.0 * level.errors.mse_std_err
}

fn panel<'a, B: DrawingBackend + 'a>(
    area: &DrawingArea<B, Shift>,
    study: &Study,
    ladders: &[&Ladder],
) -> Result<()> {
    let (seconds, error) = ranges(study);
    let lowest = error.start;
    let title = format!("{}, {}", study.name, accel_name(ladders[0].accel));
    let mut chart = ChartBuilder::on(area)
        .caption(title, ("sans-serif", 18))
        .margin(10)
        .x_label_area_size(28)
        .y_label_area_size(64)
        .build_cartesian_2d(
            seconds.clone().log_scale().with_key_points(ticks(&seconds)),
            error.clone().log_scale().with_key_points(ticks(&error)),
        )
        .map_err(failed)?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .y_desc("RMSE in % of the mean radiance")
        .x_label_formatter(&|x| short(*x))
        .y_label_formatter(&|y| short(100.0 * y))
        .label_style(("sans-serif", 13))
        .axis_desc_style(("sans-serif", 14))
        .draw()
        .map_err(failed)?;
    if study.reference_error > lowest {
        let ends = [seconds.start, seconds.end].map(|x| (x, study.reference_error));
        chart.draw_series(DashedLineSeries::new(ends, 1, 3, BLACK.stroke_width(1))).map_err(failed)?;
    }
    for ladder in ladders {
        let style = Style::of(ladder.combination);
        let levels = || ladder.levels.iter().filter(|level| visible(level));
        let points: Vec<_> = levels().map(|level| (level.seconds, level.errors.rmse())).collect();
        chart.draw_series(style.line(points.clone())).map_err(failed)?;
        let bars = levels().map(|level| {
            let [low, high] = level.errors.interval_95();
            PathElement::new([(level.seconds, low.max(lowest)), (level.seconds, high)], style.colour)
        });
        chart.draw_series(bars).map_err(failed)?;
        let fill = |&at: &_| EmptyElement::at(at) + Polygon::new(style.corners(), style.inside());
        chart.draw_series(points.iter().map(fill)).map_err(failed)?;
        let edge = |&at: &_| EmptyElement::at(at) + PathElement::new(style.outline(), style.colour);
        chart.draw_series(points.iter().map(edge)).map_err(failed)?;
    }
    Ok(())
}

/// The marker and line style of a combination, also distinct in greyscale print.
struct Style {
    colour: RGBColor,
    estimator: Estimator,
    reuse: bool,
    dashed: bool,
    filled: bool,
}

impl Style {
    fn of(Combination { estimator, sampler, path_reuse, max_bounces }: Combination) -> Self {
        let reuse = path_reuse != PathReuse::Off;
        let colour = match (estimator, max_bounces) {
            (_, Some(_)) => RGBColor(110, 110, 110),
            _ if reuse => RGBColor(40, 100, 210),
            (Estimator::Bsdf, _) => RGBColor(230, 120, 20),
            (Estimator::Light, _) => RGBColor(20, 140, 130),
            _ => RGBColor(68, 1, 84),
        };
        Self { colour, estimator, reuse, dashed: sampler == Sampler::Sobol, filled: max_bounces.is_none() }
    }

    /// A line through `points`, dashed for Sobol' points.
    fn line<C: Clone + 'static>(&self, points: Vec<C>) -> DashedLineSeries<std::vec::IntoIter<C>, u32> {
        // A dash longer than the chart draws a solid line.
        let (dash, gap) = if self.dashed { (7, 5) } else { (1 << 20, 0) };
        DashedLineSeries::new(points, dash, gap, self.colour.stroke_width(2))
    }

    /// The corners of the marker around a point: an octagon for `Bsdf`, a triangle for `Light`, a square for
    /// `Mis`, a diamond with path reuse.
    fn corners(&self) -> Vec<(i32, i32)> {
        match self.estimator {
            _ if self.reuse => vec![(0, -6), (6, 0), (0, 6), (-6, 0)],
            Estimator::Bsdf => vec![(5, 0), (4, 4), (0, 5), (-4, 4), (-5, 0), (-4, -4), (0, -5), (4, -4)],
            Estimator::Light => vec![(0, -6), (6, 4), (-6, 4)],
            _ => vec![(-4, -4), (4, -4), (4, 4), (-4, 4)],
        }
    }

    fn inside(&self) -> ShapeStyle {
        if self.filled { self.colour.filled() } else { WHITE.filled() }
    }

    /// The closed outline of the marker.
    fn outline(&self) -> Vec<(i32, i32)> {
        let corners = self.corners();
        corners.iter().chain(&corners[..1]).copied().collect()
    }
}

fn draw_legend<'a, B: DrawingBackend + 'a>(area: &DrawingArea<B, Shift>) -> Result<()> {
    let combinations = Combination::unbiased().chain([Combination::TRUNCATED]);
    for (i, combination) in combinations.enumerate() {
        let style = Style::of(combination);
        // A column for each estimator, and one for path reuse and the truncated paths; a row for each sampler.
        let (x, y) = (20 + 210 * (i as i32 / 2), 36 + 20 * (i as i32 % 2));
        let ends = vec![(x, y), (x + 44, y)];
        let dashes: Vec<_> = style.line(ends).into_iter().collect();
        for dash in &dashes {
            area.draw(dash).map_err(failed)?;
        }
        let at = || EmptyElement::at((x + 22, y));
        area.draw(&(at() + Polygon::new(style.corners(), style.inside()))).map_err(failed)?;
        area.draw(&(at() + PathElement::new(style.outline(), style.colour))).map_err(failed)?;
        let text = format!("{}, {}", combination.estimator_name(), combination.sampler_name());
        area.draw(&Text::new(text, (x + 52, y - 7), ("sans-serif", 14))).map_err(failed)?;
    }
    Ok(())
}
