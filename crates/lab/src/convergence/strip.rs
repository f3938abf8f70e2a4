//! The equal-time pictures side by side, with maps of their errors below.

use super::race::Race;
use super::study::Study;
use crate::plot::{self, Drawing, Scale, failed, short};
use anyhow::Result;
use globillum::io::PictureFile;
use image::RgbImage;
use plotters::coord::Shift;
use plotters::prelude::*;
use std::path::{Path, PathBuf};

/// Approximate side of a picture in the strip.
const PANEL: u32 = 192;
const GAP: u32 = 8;
/// Heights of the three caption lines above the pictures and of the scale below.
const TOP: u32 = 62;
const BOTTOM: u32 = 50;

/// The mean radiance after exposure.
const BRIGHTNESS: f64 = 0.3;

/// Draws the strip as `equal-time-NAME.png`, and writes its pictures to the folder `pictures`.
pub(crate) fn write(folder: &Path, study: &Study) -> Result<PathBuf> {
    let races: Vec<&Race> = study.races_of_first().collect();
    let pictures = races.iter().map(|race| picture(folder, study, race)).collect::<Result<Vec<_>>>()?;
    let path = folder.join(format!("equal-time-{}.png", study.name));
    plot::write_png(&path, &Strip { races, pictures })?;
    Ok(path)
}

/// Writes a picture to its own file, and returns its 8-bit pixels.
fn picture(folder: &Path, study: &Study, race: &Race) -> Result<RgbImage> {
    let name = format!("{}-{}.png", study.name, race.combination.file_name());
    let path = folder.join("pictures").join(name);
    PictureFile::create(&path)?.exposed((BRIGHTNESS / study.mean).log2()).write(&race.film)?;
    Ok(image::open(&path)?.to_rgb8())
}

struct Strip<'s> {
    races: Vec<&'s Race>,
    pictures: Vec<RgbImage>,
}

impl Strip<'_> {
    /// The side of a picture's pixel, in pixels of the strip.
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
        let colours = errors();
        for (i, (race, picture)) in self.races.iter().zip(&self.pictures).enumerate() {
            let x = GAP + i as u32 * (self.panel() + GAP);
            self.draw_caption(area, x, race)?;
            let shown = |x, y| {
                let [r, g, b] = picture.get_pixel(x, y).0;
                RGBColor(r, g, b)
            };
            self.draw_panel(area, (x, TOP), shown)?;
            let error = |x, y| colours.colour(race.error_map[(y * picture.width() + x) as usize]);
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
        colour: impl Fn(u32, u32) -> RGBColor,
    ) -> Result<()> {
        let (side, zoom) = (self.pictures[0].width(), self.zoom());
        for (x, y) in (0..side).flat_map(|y| (0..side).map(move |x| (x, y))) {
            let at = |x: u32, y: u32| ((left + x * zoom) as i32, (top + y * zoom) as i32);
            let square = Rectangle::new([at(x, y), at(x + 1, y + 1)], colour(x, y).filled());
            area.draw(&square).map_err(failed)?;
        }
        Ok(())
    }

    /// Draws the colour scale of the lower row.
    fn draw_scale<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> Result<()> {
        const WIDTH: i32 = 450;
        // The numbers at its ends extend beyond it on both sides.
        let (left, top) = (3 * GAP as i32, (self.size().1 - BOTTOM + 4) as i32);
        errors().draw(area, (left, top), WIDTH, |error| format!("{} %", short(100.0 * error)))?;
        let text = "error of a pixel, in % of the picture's mean radiance";
        let place = (left + WIDTH + 40, top);
        area.draw(&Text::new(text, place, ("sans-serif", 15))).map_err(failed)
    }
}

/// The colour scale of errors.
fn errors() -> Scale {
    Scale::new(1e-3..1.0)
}
