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
