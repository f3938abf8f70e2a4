/// The reconstruction filter of a pixel.
///
/// Sample positions are distributed as the filter, so all samples have the same weight and each belongs to
/// one pixel (filter importance sampling, Ernst, Stamminger and Greiner 2006).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum PixelFilter {
    /// Constant over the pixel.
    #[default]
    Box,
    /// The product of two triangular densities, each two pixels wide.
    Tent,
}

impl PixelFilter {
    /// The position of a sample for `u` in `[0, 1)^2`, in pixels from the pixel's upper left corner.
    pub(crate) fn place(self, u: [f64; 2]) -> [f64; 2] {
        match self {
            Self::Box => u,
            Self::Tent => u.map(|u| 0.5 + tent(u)),
        }
    }
}

/// The inverse of the distribution with density `1 - |x|` in `[-1, 1]`.
fn tent(u: f64) -> f64 {
    if u < 0.5 { (2.0 * u).sqrt() - 1.0 } else { 1.0 - (2.0 * (1.0 - u)).sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tent_inverts_its_distribution() {
        for i in 0..=1000 {
            let u = f64::from(i) / 1001.0;
            let x = tent(u);
            let below = if x < 0.0 { (1.0 + x) * (1.0 + x) / 2.0 } else { 1.0 - (1.0 - x) * (1.0 - x) / 2.0 };
            assert!((below - u).abs() < 1e-15, "{u}");
        }
        assert_eq!((tent(0.0), tent(0.5)), (-1.0, 0.0));
        assert!(tent(1.0_f64.next_down()) < 1.0);
    }

    #[test]
    fn filters_are_centred_on_the_pixel() {
        for (filter, first) in [(PixelFilter::Box, [0.0, 0.0]), (PixelFilter::Tent, [-0.5, -0.5])] {
            assert_eq!(
                (filter.place([0.5, 0.5]), filter.place([0.0, 0.0])),
                ([0.5, 0.5], first),
                "{filter:?}"
            );
        }
    }
}
