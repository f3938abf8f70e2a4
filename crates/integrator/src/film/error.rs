use super::dispersion::{Dispersion, Halves};
use super::moments::{Moments, Tally};
use super::pass_node::PassNodeHeader;
use super::{Film, student};
use globillum_material::Rgb;
use std::cmp::Reverse;

/// How far pictures of these samples are from the truth, told by the samples.
///
/// Relative to the picture's mean radiance, over all pixels and components alike.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ErrorEstimate {
    /// Root of the mean squared error: the standard errors of the pixels, averaged as squares, over
    /// the picture's mean radiance. Infinite before there are two observations, and if the mean is not above 0: samples of
    /// [`PathReuse::Tiles`](crate::PathReuse) may be negative. 0 if no pixel varied: that is certain only
    /// where [`interval_95`](Self::interval_95) ends at 0, and where radiance is not so small that variances underflow,
    /// below 1e-154.
    pub relative_rmse: f64,
    /// The interval that holds with a probability of 95 % what `relative_rmse` is on average over all seeds.
    ///
    /// It comes from the difference between the two halves of a node of passes ([`Film`]), of which only chance is
    /// the reason, summed over blocks of pixels that are independent of each other. Each half needs two
    /// observations: with Sobol' points, passes `4 k` to `4 k + 3` for some `k`; with independent samples, passes
    /// `2 k` and `2 k + 1` of at least two samples each. Among several nodes that of the most observations counts.
    ///
    /// Without such a node it comes from the differences between the blocks, of which some are truly noisier, and
    /// is too wide. `[0, inf]` if nothing is known, or if strips of the picture hold different passes.
    ///
    /// If no pixel varied, it is `[0, 0]` from 64 observations on and `[0, inf]` before. Of 64 equal observations, others
    /// differ with a probability of less than 5 %, with a confidence of 95 % (Hanley and Lippman-Hand 1983, the rule of
    /// three): light that fewer find may be missing.
    ///
    /// How often it holds, and where less: docs/estimators.md.
    pub interval_95: [f64; 2],
}

impl Film {
    /// How far the whole picture is from the truth.
    pub fn error(&self) -> ErrorEstimate {
        let mut sums = ErrorSums::default();
        sums.add(self);
        sums.error()
    }
}

/// From this number of equal observations on, a picture that never varied is taken for exact.
const MIN_EQUAL_OBSERVATIONS: u64 = 64;

/// Sums over pixels, row by row from the top.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct PixelSums {
    /// The number of pixels added.
    pub pixels: u64,
    /// The sum of [`Film::mean`].
    pub mean: Rgb,
    /// The sum of [`Film::variance_of_mean`]; infinite before there are two observations.
    pub variance: Rgb,
}

impl PixelSums {
    /// Adds the pixels of `film`.
    pub(crate) fn add(&mut self, film: &Film) {
        film.means().for_each(|mean| self.mean += mean);
        film.variances_of_mean().for_each(|variance| self.variance += variance);
        self.pixels += film.pixel_count() as u64;
    }

    /// [`ErrorEstimate::relative_rmse`] of the pixels added; infinite if there are none.
    pub fn relative_rmse(&self) -> f64 {
        let [mse, mean] = [self.variance, self.mean].map(|sum| (sum / self.pixels as f64).mean());
        if mse == 0.0 {
            0.0
        } else if mse.is_finite() && mean > 0.0 {
            mse.sqrt() / mean
        } else {
            f64::INFINITY
        }
    }
}

/// What the error of a picture is made of, gathered from strips in the order of their rows.
#[derive(Debug, Default)]
pub(crate) struct ErrorSums {
    pub(crate) pixels: PixelSums,
    /// The passes of the first strip; `None` if another one has others.
    passes: Option<Passes>,
    /// The spreads of all blocks, if the halves of nodes say nothing.
    blocks: Vec<f64>,
}

/// Passes that all strips have.
#[derive(Debug)]
struct Passes {
    tally: Tally,
    /// Each node with how its halves differ.
    nodes: Vec<(PassNodeHeader, Vec<Halves>)>,
}

impl ErrorSums {
    /// Adds the rows of `film`, which are below those added before.
    pub(crate) fn add(&mut self, film: &Film) {
        let tally = film.tally();
        let headers = || film.nodes().iter().map(|node| node.header);
        if self.pixels.pixels == 0 {
            let nodes = headers().map(|header| (header, Vec::new())).collect();
            self.passes = Some(Passes { tally, nodes });
        }
        self.passes = self.passes.take().filter(|own| own.nodes.iter().map(|node| node.0).eq(headers()));
        let own = self.passes.iter_mut().flat_map(|own| &mut own.nodes);
        for ((_, halves), node) in own.zip(film.nodes()) {
            halves.extend(&node.halves);
        }
        if film.nodes().iter().flat_map(|node| &node.halves).all(|halves| halves.spread == 0.0) {
            let moments: Vec<Moments> = film.all_sums().map(|(moments, _)| moments).collect();
            self.blocks.extend(film.independent_blocks().spreads(&moments));
        }
        self.pixels.add(film);
    }

    /// The error of all rows added.
    pub(crate) fn error(&self) -> ErrorEstimate {
        let relative_rmse = self.pixels.relative_rmse();
        let unknown = ErrorEstimate { relative_rmse, interval_95: [0.0, f64::INFINITY] };
        let Some(passes) = self.passes.as_ref().filter(|_| relative_rmse.is_finite()) else { return unknown };
        if relative_rmse == 0.0 && passes.tally.observations >= MIN_EQUAL_OBSERVATIONS {
            return ErrorEstimate { relative_rmse, interval_95: [0.0; 2] };
        }
        let Dispersion { variance, dof } = passes.dispersion(&self.blocks);
        if dof == 0.0 {
            return unknown;
        }
        // Of the logarithm, which is less skewed than the variance; half of it for the root.
        let std_err = (variance / (passes.tally.observations - 1) as f64).sqrt() / 2.0;
        let factor = (student::quantile_975(dof as u64) * std_err).exp();
        ErrorEstimate { relative_rmse, interval_95: [relative_rmse / factor, relative_rmse * factor] }
    }
}

impl Passes {
    /// What is known of the picture's variance: by the halves of the largest node, or if it has none that
    /// vary, by the blocks of pixels.
    fn dispersion(&self, blocks: &[f64]) -> Dispersion {
        let nodes = self.nodes.iter().map(|(header, halves)| (header, Dispersion::between(halves)));
        let known = nodes.filter(|(_, dispersion)| dispersion.dof > 0.0);
        let largest = known.max_by_key(|(header, _)| (header.tally.observations, Reverse(header.first)));
        largest
            .map_or_else(|| Dispersion::among(blocks, self.tally.observations), |(_, dispersion)| dispersion)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The root of the mean variance over the mean, unless that says nothing.
    #[test]
    fn a_mean_that_is_not_above_zero_has_an_infinite_relative_error() {
        let sums = |mean: f64, variance: f64| PixelSums {
            pixels: 4,
            mean: Rgb::splat(mean),
            variance: Rgb::splat(variance),
        };
        assert_eq!(sums(8.0, 1.0).relative_rmse(), 0.25);
        for mean in [0.0, -8.0] {
            assert_eq!(sums(mean, 1.0).relative_rmse(), f64::INFINITY, "{mean}");
            assert_eq!(sums(mean, 0.0).relative_rmse(), 0.0, "{mean}");
        }
        assert_eq!(PixelSums::default().relative_rmse(), f64::INFINITY);
    }
}
