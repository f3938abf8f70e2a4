//! Hashes of answers and films.

use globillum_geom::Hit;
use globillum_integrator::Film;

/// The hash FNV-1a of 64-bit words (Fowler, Noll and Vo).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fnv(pub u64);

impl Default for Fnv {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fnv {
    /// Adds a word.
    pub fn add(&mut self, word: u64) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    /// Adds every bit of an answer.
    pub fn add_hit(&mut self, hit: &Option<Hit>) {
        match hit {
            None => self.add(u64::MAX),
            Some(Hit { t, u, v, triangle }) => {
                [t, u, v].into_iter().for_each(|x| self.add(x.to_bits()));
                self.add(u64::from(*triangle));
            }
        }
    }
}

/// The hash of every bit of a film's pixels, row by row from the top.
pub fn of_film(film: &Film) -> u64 {
    let mut hash = Fnv::default();
    film.means().flat_map(|mean| mean.to_array()).for_each(|x| hash.add(x.to_bits()));
    hash.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_that_of_its_authors() {
        // A 16-letter vector of the published test suite.
        let mut hash = Fnv::default();
        for word in [*b"chongo w", *b"as here!"] {
            hash.add(u64::from_le_bytes(word));
        }
        assert_eq!(hash.0, 0x858e_2fa3_2a55_e61d);
    }
}
