//! Which cases and scenes are checked, and in which order.

use super::cases;
use super::compare::{Tally, Violation};
use super::regime::{PENCIL, Regime};
use super::source::Seeded;
use crate::{Accel, GeomError, Triangles};

/// The extent of a check and the seed of its random scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Suite {
    /// The number of random rays, rounded up to whole scenes, in addition to those of the named cases.
    pub rays: u64,
    /// The seed of the random scenes and rays.
    pub seed: u64,
}

impl Default for Suite {
    fn default() -> Self {
        Self { rays: 100_000, seed: 0 }
    }
}

/// Random rays for each random scene, in addition to its pencil.
const RAYS_PER_SCENE: usize = 64;

impl Suite {
    /// Checks the accelerator that `build` makes against the contract of [`Accel`].
    ///
    /// # Errors
    /// The first [`Violation`] found, with the scene and the ray.
    pub fn check<A: Accel>(
        &self,
        build: impl Fn(&Triangles) -> Result<A, GeomError>,
    ) -> Result<Tally, Violation> {
        let mut tally = self.check_cases(&build)?;
        let mut source = Seeded::new(self.seed);
        let scenes = self.rays.div_ceil(((PENCIL + RAYS_PER_SCENE) * Regime::ALL.len()) as u64);
        for _ in 0..scenes {
            for regime in Regime::ALL {
                tally += regime.check(&mut source, RAYS_PER_SCENE, &build)?;
            }
        }
        Ok(tally)
    }

    /// Checks the named cases only.
    ///
    /// # Errors
    /// The first [`Violation`] found.
    pub fn check_cases<A: Accel>(
        &self,
        build: impl Fn(&Triangles) -> Result<A, GeomError>,
    ) -> Result<Tally, Violation> {
        let mut tally = Tally::default();
        for case in cases::all() {
            tally += case.check(&build)?;
        }
        Ok(tally)
    }
}

/// Checks the accelerator that `build` makes with the scene and rays that `bytes` encode. Fuzzers call it, and
/// tests replay their corpora with it.
///
/// # Errors
/// The first [`Violation`] found.
pub fn check_bytes<A: Accel>(
    bytes: &[u8],
    build: impl Fn(&Triangles) -> Result<A, GeomError>,
) -> Result<Tally, Violation> {
    let [which, words @ ..] = bytes else { return Ok(Tally::default()) };
    let regime = Regime::ALL[usize::from(*which) % Regime::ALL.len()];
    let word = |chunk: &[u8]| chunk.iter().rev().fold(0, |word, &byte| (word << 8) | u64::from(byte));
    let words: Vec<u64> = words.chunks(8).map(word).collect();
    regime.check(&mut words.into_iter(), 16, build)
}
