use super::decision::Decision;
use super::numbers::{Numbers, Samples};

/// The random numbers of one bounce, each uniform in `[0, 1)`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct BounceNumbers {
    /// Chooses a light.
    pub(crate) light: f64,
    /// Chooses a point on it.
    pub(crate) point: [f64; 2],
    /// Samples the scattered direction.
    pub(crate) scatter: [f64; 2],
    /// Russian roulette, if it has begun.
    pub(crate) roulette: Option<f64>,
}

impl BounceNumbers {
    /// The numbers of `N` samples at a bounce, with one for roulette if `roulette`.
    #[inline(always)]
    pub(crate) fn draw<const N: usize>(samples: &[Numbers; N], bounce: u32, roulette: bool) -> [Self; N] {
        let samples = Samples::of(samples);
        let [x, y, light] = samples.uniform(Decision::light(bounce));
        let [u, v] = samples.scatter(bounce);
        let mut all = [Self::default(); N];
        for (i, numbers) in all.iter_mut().enumerate() {
            *numbers = Self { light: light[i], point: [x[i], y[i]], scatter: [u[i], v[i]], roulette: None };
        }
        if roulette {
            let [chances] = samples.uniform(Decision::roulette(bounce));
            for (numbers, chance) in all.iter_mut().zip(chances) {
                numbers.roulette = Some(chance);
            }
        }
        all
    }
}
