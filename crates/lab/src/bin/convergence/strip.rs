//! The pictures of equal time side by side, and their errors below them.

use crate::race::Race;
use crate::study::Study;
use anyhow::Result;
use globillum::io::PictureFile;
use globillum_lab::plot::{self, Drawing, failed};
use image::RgbImage;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::colors::colormaps::{ColorMap, ViridisRGB};
use std::path::{Path, PathBuf};

/// A picture's side in the strip, about.
const PANEL: u32 = 192;
const GAP: u32 = 8;
/// Room for three lines above the pictures, and for the scale below.
const TOP: u32 = 62;
const BOTTOM: u32 = 50;

/// Errors from this, dark, to 1, bright.
const LEAST: f64 = 1e-3;

/// What the pictures' mean comes out as.
const BRIGHTNESS: f64 = 0.3;

/// Draws the strip as `equal-time-NAME.png`, and writes its pictures beside it.
pub(crate) fn write(folder: &Path, study: &Study) -> Result<PathBuf> {
    let races: Vec<&Race> = study.races_of_first().collect();
    let pictures = races.iter().map(|race| picture(folder, study, race)).collect::<Result<Vec<_>>>()?;
    let path = folder.join(format!("equal-time-{}.png", study.name));
    plot::write_as_png(&path, &Strip { races, pictures })?;
    Ok(path)
}

/// The picture as it is seen, which goes into a file of its own.
fn picture(folder: &Path, study: &Study, race: &Race) -> Result<RgbImage> {
    let (estimator, sampler) = (race.combination.estimator_name(), race.combination.sampler_name());
    let name = format!("{}-{estimator}-{}.png", study.name, sampler.trim_end_matches('\''));
    let path = folder.join("pictures").join(name.to_lowercase());
    PictureFile::create(&path)?.exposed((BRIGHTNESS / study.mean).log2()).write(&race.film)?;
    Ok(image::open(&path)?.to_rgb8())
}

struct Strip<'s> {
    races: Vec<&'s Race>,
    pictures: Vec<RgbImage>,
}

impl Strip<'_> {
    /// How many pixels along each side one pixel of a picture takes up.
    fn zoom(&self) -> u32 {
        (PANEL / self.pictures[0].width()).max(1)
    }

    fn panel(&self) -> u32 {
        self.zoom() * self.pictures[0].width()
    }
}

impl Drawing for Strip<'_> {
    fn size(&self) -> (u32, u32) {
        let count = self.races.len() as u32;
        (count * (self.panel() + GAP) + GAP, TOP + 2 * (self.panel() + GAP) + BOTTOM)
    }

    fn draw<'a, B: DrawingBackend + 'a>(&self, area: &DrawingArea<B, Shift>) -> Result<()> {
        for (i, (race, picture)) in self.races.iter().zip(&self.pictures).enumerate() {
            let x = GAP + i as u32 * (self.panel() + GAP);
            self.draw_caption(area, x, race)?;
            let shown = |x, y| picture.get_pixel(x, y).0;
            self.draw_panel(area, (x, TOP), shown)?;
            let error = |x, y| heat(race.error_map[(y * picture.width() + x) as usize]);
            self.draw_panel(area, (x, TOP + self.panel() + GAP), error)?;
        }
        self.draw_scale(area)
    }
}

impl Strip<'_> {
    fn draw_caption<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
        x: u32,
        race: &Race,
    ) -> Result<()> {
        let combination = race.combination;
        let lines = [
            format!("{}, {}", combination.estimator_name(), combination.sampler_name()),
            format!("{} samples, {:.2} s", race.samples, race.seconds),
            format!("RMSE {:.2} %", 100.0 * race.errors.rmse()),
        ];
        for (line, y) in lines.into_iter().zip([4, 22, 40]) {
            area.draw(&Text::new(line, (x as i32, y), ("sans-serif", 15))).map_err(failed)?;
        }
        Ok(())
    }

    fn draw_panel<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
        (left, top): (u32, u32),
        colour: impl Fn(u32, u32) -> [u8; 3],
    ) -> Result<()> {
        let (side, zoom) = (self.pictures[0].width(), self.zoom());
        for (x, y) in (0..side).flat_map(|y| (0..side).map(move |x| (x, y))) {
            let [r, g, b] = colour(x, y);
            let at = |x: u32, y: u32| ((left + x * zoom) as i32, (top + y * zoom) as i32);
            let square = Rectangle::new([at(x, y), at(x + 1, y + 1)], RGBColor(r, g, b).filled());
            area.draw(&square).map_err(failed)?;
        }
        Ok(())
    }

    /// What the colours of the lower row mean.
    fn draw_scale<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> Result<()> {
        const WIDTH: i32 = 300;
        const HEIGHT: i32 = 12;
        let (left, top) = (GAP as i32, (self.size().1 - BOTTOM + 4) as i32);
        for x in 0..WIDTH {
            let [r, g, b] = heat(LEAST.powf(1.0 - f64::from(x) / f64::from(WIDTH)));
            let bar = [(left + x, top), (left + x + 1, top + HEIGHT)];
            area.draw(&Rectangle::new(bar, RGBColor(r, g, b).filled())).map_err(failed)?;
        }
        for (decade, label) in ["0.1 %", "1 %", "10 %", "100 %"].into_iter().enumerate() {
            let place =
                (left + decade as i32 * WIDTH / 3 - if decade == 0 { 0 } else { 12 }, top + HEIGHT + 4);
            area.draw(&Text::new(label, place, ("sans-serif", 13))).map_err(failed)?;
        }
        let text = "error of a pixel, in % of the picture's mean radiance";
        area.draw(&Text::new(text, (left + WIDTH + 40, top - 1), ("sans-serif", 15))).map_err(failed)
    }
}

/// The colour of an error.
fn heat(error: f64) -> [u8; 3] {
    let share = 1.0 - (error.clamp(LEAST, 1.0).ln() / LEAST.ln());
    let (r, g, b) = ViridisRGB.get_color(share as f32).rgb();
    [r, g, b]
}
