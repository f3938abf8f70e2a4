//! What a comparison of two pictures comes to.

use crate::exit::{Differs, Undecided};
use anyhow::{Result, bail};
use globillum::integrator::{Comparison, Estimates};
use globillum::material::Rgb;
use std::fmt;

/// Whether two pictures differ by more than chance, and by which figures.
#[derive(Debug)]
pub(super) struct Verdict {
    /// The probability that equal pictures differ as much.
    p: f64,
    /// How often equal pictures may be called different.
    false_alarm: f64,
    /// The least `p` of pictures of this size, if that is not below `false_alarm`.
    least: Option<f64>,
}

impl Verdict {
    /// The verdict on pictures that were compared.
    pub(super) fn of(
        comparison: &Comparison,
        (a, b): (&[Estimates], &[Estimates]),
        false_alarm: f64,
    ) -> Self {
        let p = comparison.p_value();
        let are_errors_known = comparison.largest_block.is_some();
        let least = (p >= false_alarm && !are_errors_known).then(|| least_p_value(a, b));
        Self { p, false_alarm, least: least.filter(|&least| least >= false_alarm) }
    }

    /// Fails unless no difference is found by tests that can find one.
    pub(super) fn into_result(self) -> Result<()> {
        let Self { p, false_alarm, least } = self;
        if p < false_alarm {
            bail!(Differs(format!("by more than chance (p = {p:.2e}, false-alarm rate {false_alarm:?})")));
        }
        match least {
            Some(least) => bail!(Undecided(format!(
                "errors are not known, and pictures of this size have p = {least:.2e} at least \
                 (false-alarm rate {false_alarm:?})"
            ))),
            None => Ok(()),
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { p, false_alarm, least } = self;
        let verdict = match least {
            _ if p < false_alarm => "different",
            None => "no difference found",
            Some(_) => "cannot tell",
        };
        write!(f, "{verdict}: p = {p:.2e}, false-alarm rate {false_alarm:?}")
    }
}

/// The p-value of white beside black, of pictures with the sizes, places and tiles of these, whose errors are not
/// known: about the least that these can have.
fn least_p_value(a: &[Estimates], b: &[Estimates]) -> f64 {
    let of_colour = |pictures: &[Estimates], colour| {
        let picture = |like: &Estimates| {
            let mut picture = Estimates::unknown(like.width, like.height);
            (picture.full_size, picture.origin) = (like.full_size, like.origin);
            picture.path_reuse = like.path_reuse;
            picture.means.fill(colour);
            picture
        };
        pictures.iter().take(1).map(picture).collect::<Vec<_>>()
    };
    let comparison = Comparison::between(&of_colour(a, Rgb::WHITE), &of_colour(b, Rgb::BLACK));
    comparison.map_or(1.0, |comparison| comparison.p_value())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verdict(side: u32, difference: f64, false_alarm: f64) -> Verdict {
        let [a, mut b] = [0; 2].map(|_| Estimates::unknown(side, side));
        b.means.fill(Rgb::splat(difference));
        let (a, b) = ([a], [b]);
        let comparison = Comparison::between(&a, &b).expect("they have a size");
        Verdict::of(&comparison, (&a, &b), false_alarm)
    }

    #[test]
    fn pictures_of_few_tiles_and_unknown_errors_tell_nothing() {
        // Tiles are blocks of 4 x 4 pixels. The deviate of `n` tiles is at most the root of `n`: 1 and 2 of one
        // and of four.
        for (side, least) in [(4, 0.635), (8, 0.0455)] {
            let small = verdict(side, 1.0, 0.001);
            assert!(small.to_string().starts_with("cannot tell: p = "), "{small}");
            assert!(small.least.is_some_and(|p| (p / least - 1.0).abs() < 0.01), "{small:?}");
            assert!(small.into_result().is_err_and(|error| error.is::<Undecided>()), "{side}");
        }
        for (difference, verdict_of_64) in [(1.0, "different"), (0.0, "no difference found")] {
            assert!(verdict(64, difference, 0.001).to_string().starts_with(verdict_of_64), "{difference}");
        }
        assert!(verdict(8, 0.0, 0.1).into_result().is_ok());
    }
}
