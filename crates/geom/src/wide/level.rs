//! Which instructions a search, or other work, is compiled for.

#[cfg(target_arch = "x86_64")]
use super::simd::{Avx2, Avx512};
use super::simd::{Portable, Simd};

/// Instruction sets that a [`WideKdTree`](super::WideKdTree) is searched with, from the slowest.
/// All give the same answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum SimdLevel {
    /// Plain Rust.
    Portable,
    /// AVX2 with FMA.
    Avx2,
    /// AVX-512 F, BW, DQ and VL.
    Avx512,
}

impl SimdLevel {
    /// All of them, whether this machine has them or not.
    pub const ALL: [Self; 3] = [Self::Portable, Self::Avx2, Self::Avx512];

    /// The best that this machine has.
    pub fn best() -> Self {
        Token::new(Self::Avx512).level()
    }

    /// Runs `work`, compiled for these instructions, or for the best below them that this machine has.
    ///
    /// For passes over arrays, of which the compiler makes vectors, and for long computations of which much
    /// is inlined. Only what is inlined into `work` is
    /// compiled so: mark the closure, and what it calls, `#[inline(always)]`. What it computes is
    /// the same to the bit with any instructions.
    ///
    /// ```
    /// use globillum_geom::SimdLevel;
    ///
    /// let mut roots = [1.0_f64, 4.0, 9.0, 16.0];
    /// SimdLevel::best().run(
    ///     #[inline(always)]
    ///     || roots.iter_mut().for_each(|x| *x = x.sqrt()),
    /// );
    /// assert_eq!(roots, [1.0, 2.0, 3.0, 4.0]);
    /// ```
    #[inline(always)]
    pub fn run<R>(self, work: impl FnOnce() -> R) -> R {
        match Token::new(self) {
            Token::Portable(simd) => simd.vectorize(work),
            #[cfg(target_arch = "x86_64")]
            Token::Avx2(simd) => simd.vectorize(work),
            #[cfg(target_arch = "x86_64")]
            Token::Avx512(simd) => simd.vectorize(work),
        }
    }
}

/// A [`SimdLevel`] that this machine has.
#[derive(Clone, Copy, Debug)]
pub(super) enum Token {
    Portable(Portable),
    #[cfg(target_arch = "x86_64")]
    Avx2(Avx2),
    #[cfg(target_arch = "x86_64")]
    Avx512(Avx512),
}

impl Token {
    /// `level`, or the best below it.
    #[cfg(target_arch = "x86_64")]
    pub(super) fn new(level: SimdLevel) -> Self {
        let avx512 = (level >= SimdLevel::Avx512).then(Avx512::detect).flatten();
        let avx2 = (level >= SimdLevel::Avx2).then(Avx2::detect).flatten();
        match (avx512, avx2) {
            (Some(avx512), _) => Self::Avx512(avx512),
            (None, Some(avx2)) => Self::Avx2(avx2),
            (None, None) => Self::Portable(Portable),
        }
    }

    /// `level`, or the best below it.
    #[cfg(not(target_arch = "x86_64"))]
    pub(super) fn new(_: SimdLevel) -> Self {
        Self::Portable(Portable)
    }

    pub(super) fn level(self) -> SimdLevel {
        match self {
            Self::Portable(_) => SimdLevel::Portable,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(_) => SimdLevel::Avx2,
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(_) => SimdLevel::Avx512,
        }
    }
}
