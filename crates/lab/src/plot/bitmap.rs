//! A bitmap backend that spaces letters by the font's metrics.

use ab_glyph::{Font, FontRef, PxScale, ScaleFont, point};
use anyhow::Result;
use epaint_default_fonts::UBUNTU_LIGHT;
use plotters::prelude::*;
use plotters_backend::text_anchor::{HPos, Pos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind,
};

/// [`BitMapBackend`] with its own text: the original ignores the left side bearing of letters and rounds every
/// position to a pixel.
pub(super) struct Bitmap<'p> {
    pixels: BitMapBackend<'p>,
    font: FontRef<'static>,
}

type Failure = DrawingErrorKind<<BitMapBackend<'static> as DrawingBackend>::ErrorType>;

impl<'p> Bitmap<'p> {
    /// A bitmap over `pixels`, three bytes each, row by row from the top.
    pub(super) fn new(pixels: &'p mut [u8], size: (u32, u32)) -> Result<Self> {
        let font = FontRef::try_from_slice(UBUNTU_LIGHT)?;
        Ok(Self { pixels: BitMapBackend::with_buffer(pixels, size), font })
    }
}

impl DrawingBackend for Bitmap<'_> {
    type ErrorType = <BitMapBackend<'static> as DrawingBackend>::ErrorType;

    fn get_size(&self) -> (u32, u32) {
        self.pixels.get_size()
    }

    fn ensure_prepared(&mut self) -> Result<(), Failure> {
        self.pixels.ensure_prepared()
    }

    fn present(&mut self) -> Result<(), Failure> {
        self.pixels.present()
    }

    fn draw_pixel(&mut self, at: BackendCoord, color: BackendColor) -> Result<(), Failure> {
        self.pixels.draw_pixel(at, color)
    }

    fn draw_line<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
    ) -> Result<(), Failure> {
        self.pixels.draw_line(from, to, style)
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        upper_left: BackendCoord,
        lower_right: BackendCoord,
        style: &S,
        fill: bool,
    ) -> Result<(), Failure> {
        self.pixels.draw_rect(upper_left, lower_right, style, fill)
    }

    fn draw_text<S: BackendTextStyle>(
        &mut self,
        text: &str,
        style: &S,
        at: BackendCoord,
    ) -> Result<(), Failure> {
        let (color, transform) = (style.color(), style.transform());
        let scale = PxScale::from(style.size() as f32);
        let (places, width) = places(&self.font, scale, text);
        let (left, baseline) = start(style.anchor(), width, scale.y);
        let mut drawn = Ok(());
        for (letter, place) in places {
            let glyph = letter.with_scale_and_position(scale, point(left + place, baseline));
            let Some(outline) = self.font.outline_glyph(glyph) else { continue };
            let corner = outline.px_bounds().min;
            outline.draw(|x, y, coverage| {
                let (x, y) = transform.transform(corner.x as i32 + x as i32, corner.y as i32 + y as i32);
                let drawn_so_far = std::mem::replace(&mut drawn, Ok(()));
                drawn = drawn_so_far.and_then(|()| {
                    self.pixels.draw_pixel((at.0 + x, at.1 + y), color.mix(f64::from(coverage)))
                });
            });
        }
        drawn
    }
}

/// Each letter with its position along the line, and the line's length.
fn places(font: &FontRef<'_>, scale: PxScale, text: &str) -> (Vec<(ab_glyph::GlyphId, f32)>, f32) {
    let font = font.as_scaled(scale);
    let (mut places, mut x) = (Vec::new(), 0.0);
    for letter in text.chars().map(|letter| font.glyph_id(letter)) {
        x += places.last().map_or(0.0, |&(before, _)| font.kern(before, letter));
        places.push((letter, x));
        x += font.h_advance(letter);
    }
    (places, x)
}

/// The start of a line of this width and its baseline, relative to its anchor, as in plotters' SVG.
fn start(anchor: Pos, width: f32, size: f32) -> (f32, f32) {
    let left = match anchor.h_pos {
        HPos::Left => 0.0,
        HPos::Center => -width / 2.0,
        HPos::Right => -width,
    };
    // Plotters' size is 1.24 times the font size of SVG.
    let em = size / 1.24;
    let baseline = match anchor.v_pos {
        VPos::Top => 0.76 * em,
        VPos::Center => 0.26 * em,
        VPos::Bottom => -0.26 * em,
    };
    (left, baseline)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The columns of a line of text that are not white.
    fn columns(text: &str) -> Vec<bool> {
        let (width, height) = (300, 40);
        let mut pixels = vec![255; 3 * width * height];
        let mut bitmap = Bitmap::new(&mut pixels, (width as u32, height as u32)).expect("the font is good");
        let style = TextStyle::from(("sans-serif", 24).into_font());
        bitmap.draw_text(text, &style, (10, 10)).expect("it fits");
        drop(bitmap);
        (0..width).map(|x| (0..height).any(|y| pixels[3 * (y * width + x)] < 128)).collect()
    }

    /// Words are separated, also after an apostrophe, and letters do not overlap.
    #[test]
    fn letters_keep_their_distance() {
        let gaps = |text: &str| {
            let columns = columns(text);
            let ink: Vec<usize> = (0..columns.len()).filter(|&x| columns[x]).collect();
            ink.windows(2).map(|pair| pair[1] - pair[0] - 1).filter(|&gap| gap > 0).collect::<Vec<_>>()
        };
        // Three letters have two gaps; the second contains the space.
        let of_words = gaps("'s m");
        assert!(of_words.len() >= 2 && of_words.iter().any(|&gap| gap >= 5), "{of_words:?}");
        // Equal to within a pixel.
        let equal = gaps("lll");
        assert!(equal.len() == 2 && equal[0].abs_diff(equal[1]) <= 1, "{equal:?}");
    }
}
