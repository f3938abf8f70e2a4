use crate::Rgb;

/// The sRGB encoding of a linear component, both in `[0, 1]` (IEC 61966-2-1); the same bits on every machine.
///
/// Nothing is clamped: below 0 the encoding goes on in a straight line, above 1 as its power law. NaN stays
/// NaN.
///
/// ```
/// use globillum_material::srgb_encode;
///
/// assert!((srgb_encode(0.214_041_14) - 0.5).abs() < 1e-8); // half way to white for the eye
/// ```
pub fn srgb_encode(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055 }
}

impl Rgb {
    /// The colour as an 8-bit display shows it: each component clamped to `[0, 1]`, encoded by
    /// [`srgb_encode`] and rounded to the nearest of 255 steps. NaN becomes 0.
    ///
    /// ```
    /// use globillum_material::Rgb;
    ///
    /// assert_eq!(Rgb::new(0.5, 7.0, -1.0).to_srgb8(), [188, 255, 0]);
    /// ```
    pub fn to_srgb8(self) -> [u8; 3] {
        self.to_array().map(|linear| (srgb_encode(linear.clamp(0.0, 1.0)) * 255.0).round() as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values() {
        let known = [
            (0.0, 0.0),
            (0.001, 0.01292),
            (0.003_130_8, 0.040_449_94),
            (0.18, 0.461_356),
            (0.214_041_14, 0.5),
            (0.5, 0.735_357),
            (1.0, 1.0),
        ];
        for (linear, encoded) in known {
            assert!((srgb_encode(linear) - encoded).abs() < 1e-6, "{linear}");
        }
    }

    #[test]
    fn the_two_pieces_meet() {
        let joint = 0.003_130_8_f64;
        assert!((srgb_encode(joint.next_up()) - srgb_encode(joint)).abs() < 1e-7);
    }

    #[test]
    fn bytes_are_rounded_to_nearest() {
        let known = [(-1.0, 0), (0.0, 0), (0.000_151, 0), (0.000_153, 1), (0.5, 188), (1.0, 255), (7.0, 255)];
        for (linear, byte) in known {
            assert_eq!(Rgb::new(0.0, linear, 1.0).to_srgb8(), [0, byte, 255], "{linear}");
        }
        assert_eq!(Rgb::new(f64::NAN, f64::INFINITY, f64::NEG_INFINITY).to_srgb8(), [0, 255, 0]);
    }
}
