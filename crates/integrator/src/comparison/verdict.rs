use super::Comparison;
use std::fmt;

/// What a comparison says of two pictures, at a given false-alarm rate ([`Comparison::verdict`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// They differ by more than chance.
    Different,
    /// No test finds a difference, though a difference could have been found.
    NoDifferenceFound,
    /// Not even a difference as large as the picture itself would have been found ([`Comparison::least_p_value`]): tiles are
    /// too few, or errors not known well enough.
    CannotTell,
}

impl Comparison {
    /// The verdict if equal pictures are to be called different with a probability of `false_alarm`, which is within (0, 1).
    pub fn verdict(&self, false_alarm: f64) -> Verdict {
        if self.p_value() < false_alarm {
            Verdict::Different
        } else if self.least_p_value >= false_alarm {
            Verdict::CannotTell
        } else {
            Verdict::NoDifferenceFound
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Different => "different",
            Self::NoDifferenceFound => "no difference found",
            Self::CannotTell => "cannot tell",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Estimates;
    use globillum_material::Rgb;

    /// A picture of mean 1 beside another one, without errors.
    fn comparison(side: u32, difference: f64) -> Comparison {
        let [mut a, mut b] = [0; 2].map(|_| Estimates::unknown(side, side));
        a.means.fill(Rgb::WHITE);
        b.means.fill(Rgb::splat(1.0 + difference));
        Comparison::between(&[a], &[b]).expect("they have a size")
    }

    #[test]
    fn pictures_of_few_tiles_and_unknown_errors_tell_nothing() {
        // Tiles are blocks of 4 x 4 pixels. The deviate of `n` tiles is at most the root of `n`: 1 and 2 of one
        // and of four.
        for (side, least) in [(4, 0.635), (8, 0.0455)] {
            let small = comparison(side, 1.0);
            assert_eq!(small.verdict(0.001), Verdict::CannotTell, "{side}");
            assert!((small.least_p_value / least - 1.0).abs() < 0.01, "{small:?}");
        }
        assert_eq!(comparison(64, 1.0).verdict(0.001), Verdict::Different);
        assert_eq!(comparison(64, 0.0).verdict(0.001), Verdict::NoDifferenceFound);
        assert_eq!(comparison(8, 0.0).verdict(0.1), Verdict::NoDifferenceFound);
    }

    #[test]
    fn pictures_with_errors_are_told_apart_whatever_their_size() {
        let picture = |mean| {
            let mut picture = Estimates::unknown(4, 4);
            picture.means.fill(Rgb::splat(mean));
            picture.standard_errors.fill(Rgb::splat(0.01));
            picture.block_errors.fill(Rgb::splat(0.01));
            picture.observations.fill(8);
            picture
        };
        for (mean, expected) in [(1.0, Verdict::NoDifferenceFound), (2.0, Verdict::Different)] {
            let comparison =
                Comparison::between(&[picture(1.0)], &[picture(mean)]).expect("they have a size");
            assert!(comparison.least_p_value < 0.001, "{comparison:?}");
            assert_eq!(comparison.verdict(0.001), expected);
        }
    }

    /// One tile of 64 outshines the others, so that its difference alone decides, however much all differ.
    #[test]
    fn where_one_tile_decides_nothing_is_told() {
        let [mut a, mut b] = [0; 2].map(|_| Estimates::unknown(32, 32));
        a.means.fill(Rgb::splat(0.01));
        a.means[0] = Rgb::splat(1000.0);
        for (b, a) in b.means.iter_mut().zip(&a.means) {
            *b = 3.0 * *a;
        }
        let without = Comparison::between(&[a.clone()], &[b.clone()]).expect("they have a size");
        assert_eq!(without.verdict(0.001), Verdict::CannotTell);
        // The errors of one side bring tiles to one scale.
        for (error, mean) in a.standard_errors.iter_mut().zip(&a.means) {
            *error = *mean * 0.1;
        }
        let with = Comparison::between(&[a], &[b]).expect("they have a size");
        assert_eq!(with.verdict(0.001), Verdict::Different);
    }

    #[test]
    fn black_pictures_are_equal() {
        let black = || [Estimates::unknown(4, 4)];
        let comparison = Comparison::between(&black(), &black()).expect("they have a size");
        assert_eq!(comparison.verdict(0.001), Verdict::NoDifferenceFound);
    }
}
