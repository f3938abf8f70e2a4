use super::Film;
use globillum_material::Rgb;

/// The picture as other programs take it: components red, green and blue of one pixel after the other, row
/// by row from the top.
impl Film {
    /// Mean radiance as an 8-bit display shows it ([`Rgb::to_srgb8`]): radiance 1 and above is full.
    ///
    /// To brighten it, by two stops here: `film.means().flat_map(|mean| (4.0 * mean).to_srgb8())`.
    ///
    /// ```
    /// /// The picture as a portable pixmap (PPM), which most viewers open.
    /// fn ppm(film: &globillum_integrator::Film) -> Vec<u8> {
    ///     let header = format!("P6 {} {} 255\n", film.width(), film.height());
    ///     [header.into_bytes(), film.to_srgb8()].concat()
    /// }
    /// ```
    pub fn to_srgb8(&self) -> Vec<u8> {
        self.means().flat_map(Rgb::to_srgb8).collect()
    }

    /// Mean radiance, linear and not clamped, rounded to `f32`; what lies beyond its range is infinite.
    pub fn to_rgb32f(&self) -> Vec<f32> {
        self.means().flat_map(Rgb::to_array).map(|component| component as f32).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Moments, PassNode, Tally};
    use super::*;
    use crate::PathReuse;

    #[test]
    fn components_follow_each_other_row_by_row() {
        let colours = [Rgb::new(0.5, 0.0, 1.0), Rgb::new(2.0, 1e300, 0.25)];
        let pixels = colours.map(|sum| Moments { sum: 2.0 * sum, spread: Rgb::BLACK });
        let tally = Tally { samples: 2, observations: 1 };
        let mut film = Film::new(1, 0..2, PathReuse::Off);
        film.insert(PassNode::of_pass(0, tally, pixels.into(), 2));
        assert_eq!(film.to_srgb8(), [188, 0, 255, 255, 255, 137]);
        assert_eq!(film.to_rgb32f(), [0.5, 0.0, 1.0, 2.0, f32::INFINITY, 0.25]);
    }
}
