//! How certain a picture's variance is.

use super::moments::{Moments, Tally};
use crate::path::Tile;
use globillum_material::Rgb;

/// A picture's size, and the side of the squares of pixels that are independent of each other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Squares {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) side: u32,
}

/// By how much estimates of a picture's variance differ: one picture's passes are divided in two halves, and
/// what they say is compared square by square.
///
/// Between the halves of one square there is no difference but chance, whatever its true variance, and squares
/// are independent: the sum of the squared differences is that of the variances. Differences are relative
/// to the variance of the whole picture, so that the scale of its radiance plays no part.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Dispersion {
    /// Relative variance of an estimate of one degree of freedom.
    pub(crate) variance: f64,
    /// Degrees of freedom of `variance` (Satterthwaite 1946): 2 if one square decides, up to twice their number.
    /// 0 if nothing is known.
    pub(crate) dof: f64,
}

impl Dispersion {
    /// Of two sets of passes; unknown if one of them has no spread, with fewer than two observations.
    pub(crate) fn between([a, b]: [&[Moments]; 2], tallies: [Tally; 2], squares: Squares) -> Self {
        if tallies.iter().any(|tally| tally.observations < 2) {
            return Self::default();
        }
        let [m, n] = tallies.map(|tally| (tally.observations - 1) as f64);
        let whole = a.iter().zip(b).map(|(a, b)| spread(a) + spread(b));
        let scale = whole.sum::<f64>() / (m + n) * (1.0 / m + 1.0 / n).sqrt();
        let apart = |i: usize| spread(&a[i]) / m - spread(&b[i]) / n;
        let (mut sum, mut fourths) = (0.0, 0.0);
        for square in squares.all() {
            let apart = square.map(apart).sum::<f64>() / scale;
            sum += apart * apart;
            fourths += apart.powi(4);
        }
        // Satterthwaite's, where the variance of a squared difference is at most its square.
        let dof = 2.0 * sum * sum / fourths;
        if dof.is_finite() { Self { variance: sum, dof } } else { Self::default() }
    }

    /// Of one set of passes, by the squares' variances themselves: too large, since some squares are truly
    /// noisier. Unknown of one square.
    pub(crate) fn among(moments: &[Moments], tally: Tally, squares: Squares) -> Self {
        let whole = moments.iter().map(spread).sum::<f64>();
        let count = squares.all().count() as f64;
        if tally.observations < 2 || count < 2.0 || whole == 0.0 {
            return Self::default();
        }
        let shares = squares.all().map(|square| square.map(|i| spread(&moments[i])).sum::<f64>() / whole);
        let squared: f64 = shares.map(|share| (share - 1.0 / count).powi(2)).sum();
        let variance = squared * count / (count - 1.0) * (tally.observations - 1) as f64;
        Self { variance, dof: count - 1.0 }
    }

    /// Whether squares can disperse like this.
    pub(crate) fn is_possible(&self) -> bool {
        let known = self.variance > 0.0 && self.dof > 0.0;
        (known || *self == Self::default()) && self.variance.is_finite() && self.dof.is_finite()
    }
}

/// A pixel's squared deviations, the mean of the components.
fn spread(moments: &Moments) -> f64 {
    let Moments { spread, .. } = *moments;
    Rgb::mean(spread)
}

impl Squares {
    /// The pixels of every square, as places in the film.
    fn all(self) -> impl Iterator<Item = impl Iterator<Item = usize>> {
        let place = move |(x, y): (u32, u32)| y as usize * self.width as usize + x as usize;
        Tile::grid(self.width, self.height, self.side).map(move |square| square.pixels().map(place))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    const ROW: Squares = Squares { width: 4, height: 1, side: 2 };

    type Half = (Vec<Moments>, Tally);

    /// A row of four pixels with `observations` observations each and these sums of squared deviations.
    fn half(observations: u64, spreads: [f64; 4]) -> Half {
        let pixels = spreads.map(|spread| Moments { sum: Rgb::WHITE, spread: Rgb::splat(spread) });
        (pixels.to_vec(), Tally { samples: observations, observations })
    }

    fn between(a: &Half, b: &Half) -> Dispersion {
        Dispersion::between([&a.0, &b.0], [a.1, b.1], ROW)
    }

    #[test]
    fn halves_are_compared_square_by_square() {
        let (a, b) = (half(3, [1.0, 3.0, 2.0, 2.0]), half(5, [4.0, 8.0, 1.0, 3.0]));
        let Dispersion { variance, dof } = between(&a, &b);
        // Variances of the squares 2 and 2 beside 3 and 1; of all together 24 by 6 degrees of freedom.
        let unit = 1.0 / (16.0 * (0.5 + 0.25));
        assert_relative_eq!(variance, (1.0 + 1.0) * unit, max_relative = 1e-14);
        assert_relative_eq!(dof, 4.0, max_relative = 1e-14);
    }

    #[test]
    fn nothing_is_known_of_what_does_not_vary_or_was_observed_once() {
        let (once, still, good) = (half(1, [0.0; 4]), half(4, [0.0; 4]), half(4, [1.0, 2.0, 3.0, 4.0]));
        for (a, b) in [(&once, &good), (&good, &once), (&still, &still)] {
            assert_eq!(between(a, b), Dispersion::default());
        }
        let one = Squares { side: 4, ..ROW };
        assert_eq!(Dispersion::among(&good.0, good.1, one), Dispersion::default());
    }

    #[test]
    fn squares_by_themselves_disperse_by_their_variances() {
        let (pixels, tally) = half(4, [1.0, 2.0, 2.0, 3.0]);
        // Shares of 3/8 and 5/8: a variance of 1/32, and of their sum twice that, for 3 degrees of freedom.
        let Dispersion { variance, dof } = Dispersion::among(&pixels, tally, ROW);
        assert_relative_eq!(variance, 3.0 * 2.0 / 32.0, max_relative = 1e-14);
        assert_relative_eq!(dof, 1.0);
    }
}
