//! A logarithmic colour scale.

use super::{failed, ticks};
use anyhow::Result;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::colors::colormaps::{ColorMap, ViridisRGB};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::ops::Range;

/// Colours from dark to bright, linear in the logarithm of the number.
pub(crate) struct Scale {
    range: Range<f64>,
}

impl Scale {
    /// Pixels from the scale's top to the bottom of its numbers.
    pub(crate) const HEIGHT: i32 = 32;
    /// Height of the bar alone.
    const BAR: i32 = 12;

    /// A scale for the numbers in `range`, whose start is positive. Numbers outside have the colour of the
    /// nearer end.
    pub(crate) fn new(range: Range<f64>) -> Self {
        Self { range }
    }

    /// The colour of a number.
    pub(crate) fn colour(&self, x: f64) -> RGBColor {
        let Range { start, end } = self.range;
        ViridisRGB.get_color(((x.clamp(start, end) / start).ln() / (end / start).ln()) as f32)
    }

    /// Draws the scale, `width` pixels wide, with numbers below it.
    pub(crate) fn draw<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
        (left, top): (i32, i32),
        width: i32,
        label: impl Fn(f64) -> String,
    ) -> Result<()> {
        let Range { start, end } = self.range;
        for x in 0..width {
            let value = start * (end / start).powf((f64::from(x) + 0.5) / f64::from(width));
            let bar = [(left + x, top), (left + x + 1, top + Self::BAR)];
            area.draw(&Rectangle::new(bar, self.colour(value).filled())).map_err(failed)?;
        }
        let font = ("sans-serif", 13).into_font().color(&BLACK).pos(Pos::new(HPos::Center, VPos::Top));
        for tick in ticks(&(start..end.next_up())) {
            let x = left + (f64::from(width) * (tick / start).ln() / (end / start).ln()) as i32;
            let mark = [(x, top + Self::BAR), (x, top + Self::BAR + 4)];
            area.draw(&PathElement::new(mark, BLACK)).map_err(failed)?;
            let text = Text::new(label(tick), (x, top + Self::BAR + 6), font.clone());
            area.draw(&text).map_err(failed)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn larger_numbers_are_brighter() {
        let scale = Scale::new(1.0..100.0);
        let brightness = |x: f64| {
            let (r, g, b) = scale.colour(x).rgb();
            u32::from(r) + u32::from(g) + u32::from(b)
        };
        assert!(brightness(1.0) < brightness(10.0) && brightness(10.0) < brightness(100.0));
        assert_eq!((scale.colour(0.0), scale.colour(1e9)), (scale.colour(1.0), scale.colour(100.0)));
    }
}
