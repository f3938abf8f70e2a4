//! Charts, written as SVG and PNG from one description.

mod bitmap;
mod scale;
mod ticks;

pub(crate) use scale::Scale;
pub(crate) use ticks::{short, ticks};

use anyhow::{Result, anyhow};
use bitmap::Bitmap;
use epaint_default_fonts::UBUNTU_LIGHT;
use globillum::io::AtomicFile;
use image::{ImageFormat, RgbImage};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// A drawing, independent of the format.
pub(crate) trait Drawing {
    /// Width and height in pixels.
    fn size(&self) -> (u32, u32);

    /// Draws it on a white area of that size.
    fn draw<'a, B: DrawingBackend + 'a>(&self, area: &DrawingArea<B, Shift>) -> Result<()>;
}

/// Writes `drawing` as `name.svg` and `name.png` in `folder`.
pub(crate) fn write_both(folder: &Path, name: &str, drawing: &impl Drawing) -> Result<[PathBuf; 2]> {
    let [svg, png] = ["svg", "png"].map(|extension| folder.join(format!("{name}.{extension}")));
    write_svg(&svg, drawing)?;
    write_png(&png, drawing)?;
    Ok([svg, png])
}

fn write_svg(path: &Path, drawing: &impl Drawing) -> Result<()> {
    let mut svg = String::new();
    draw_on(SVGBackend::with_string(&mut svg, drawing.size()), drawing)?;
    Ok(AtomicFile::create(path)?.commit(|file| file.write_all(svg.as_bytes()))?)
}

/// Writes `drawing` as PNG.
pub(crate) fn write_png(path: &Path, drawing: &impl Drawing) -> Result<()> {
    let (width, height) = drawing.size();
    let mut picture = RgbImage::new(width, height);
    draw_on(Bitmap::new(&mut picture, (width, height))?, drawing)?;
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, ImageFormat::Png)?;
    Ok(AtomicFile::create(path)?.commit(|file| file.write_all(bytes.get_ref()))?)
}

fn draw_on<B: DrawingBackend>(backend: B, drawing: &impl Drawing) -> Result<()> {
    // An embedded font gives the same letters on every machine.
    for style in [FontStyle::Normal, FontStyle::Bold] {
        register_font("sans-serif", style, UBUNTU_LIGHT).map_err(|_| anyhow!("the font is damaged"))?;
    }
    let area = backend.into_drawing_area();
    area.fill(&WHITE).map_err(failed)?;
    drawing.draw(&area)?;
    area.present().map_err(failed)
}

/// An error of plotters as `anyhow::Error`.
pub(crate) fn failed(error: impl std::fmt::Display) -> anyhow::Error {
    anyhow!("a chart cannot be drawn: {error}")
}
