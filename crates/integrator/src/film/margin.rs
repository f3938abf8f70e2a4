//! Intervals of single pixels.

use super::moments::mean;
use super::student;
use globillum_material::Rgb;

/// How many standard errors of its neighbourhood a pixel's margin is at least.
///
/// A pixel of skewed samples that has missed the rare bright ones underestimates its error; its neighbours
/// rarely miss them all. Less than 1.4 leaves too many of them out, more makes intervals too wide where
/// observations are few and normally distributed: of equal spread, they then hold the truth of 96.4 % of 4,
/// 95.5 % of 8 and 95.1 % of 16 (docs/estimators.md).
const NEIGHBOUR_FACTOR: f64 = 1.4;

/// Half the interval of 95 % of a pixel's mean, component by component, from the variances of means: its `own`,
/// those of the pixels `around` it, itself among them, and, where none of these varied, the mean over the `picture`.
/// Infinite of fewer than two observations.
pub(super) fn margin_95(
    observations: u64,
    own: Rgb,
    around: impl Iterator<Item = Rgb>,
    picture: impl FnOnce() -> Rgb,
) -> Rgb {
    if observations < 2 {
        return Rgb::splat(f64::INFINITY);
    }
    let mut around = mean(around).to_array();
    if around.contains(&0.0) {
        for (around, picture) in around.iter_mut().zip(picture().to_array()) {
            *around = if *around == 0.0 { picture } else { *around };
        }
    }
    let [r, g, b] = around;
    let quantile = student::quantile_975(observations - 1);
    own.map(|own| quantile * own.sqrt()).max(Rgb::new(r, g, b).map(|around| NEIGHBOUR_FACTOR * around.sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    const STUDENTS: f64 = 2.131_45;

    fn margin(own: Rgb, around: Rgb, picture: Rgb) -> [f64; 3] {
        margin_95(16, own, [own, around].into_iter(), || picture).to_array()
    }

    #[test]
    fn a_component_that_never_varied_has_the_margin_of_its_neighbours_or_of_the_picture() {
        let margins = margin(Rgb::new(4.0, 0.0, 0.0), Rgb::new(0.0, 8.0, 0.0), Rgb::splat(9.0));
        for (margin, expected) in
            margins.into_iter().zip([2.0 * STUDENTS, 2.0 * NEIGHBOUR_FACTOR, 3.0 * NEIGHBOUR_FACTOR])
        {
            assert_relative_eq!(margin, expected, max_relative = 1e-4);
        }
    }

    /// Whatever a file says of its standard error.
    #[test]
    fn fewer_than_two_observations_have_an_infinite_margin() {
        for (observations, own) in [(0, Rgb::BLACK), (1, Rgb::BLACK), (1, Rgb::WHITE)] {
            let margin = margin_95(observations, own, [own, Rgb::WHITE].into_iter(), || Rgb::WHITE);
            assert_eq!(margin, Rgb::splat(f64::INFINITY), "{observations}");
        }
    }

    #[test]
    fn quiet_neighbours_make_no_margin_narrower() {
        assert_relative_eq!(margin(Rgb::WHITE, Rgb::BLACK, Rgb::BLACK)[0], STUDENTS, max_relative = 1e-4);
        // Those that vary more than 3.6 times as much make it wider.
        assert!(margin(Rgb::WHITE, Rgb::splat(3.6), Rgb::BLACK)[0] < 1.01 * STUDENTS);
        assert!(margin(Rgb::WHITE, Rgb::splat(5.4), Rgb::BLACK)[0] > 1.1 * STUDENTS);
    }
}
