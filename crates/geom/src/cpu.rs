//! CPU dispatch: code is written once, compiled for each [`SimdLevel`], and selected at run time.
//!
//! The vectors and the tokens are those of the crate `fearless_simd`. A value of a token type ([`Avx2`],
//! [`Avx512`]) exists only if the machine supports the instruction set, so code that has one may use these
//! instructions.

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
pub(crate) use fearless_simd::{Avx2, Avx512};

/// The instruction sets that code is compiled for, in ascending order. All give the same results, to the bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum SimdLevel {
    /// The baseline of the compilation target: SSE2 on x86-64, NEON on 64-bit ARM, SIMD128 on WebAssembly where
    /// it is enabled, else no vector instructions.
    Portable,
    /// AVX2 with FMA (x86-64-v3).
    Avx2,
    /// AVX-512 as of Intel's Ice Lake and AMD's Zen 4. Earlier processors with AVX-512 have [`SimdLevel::Avx2`].
    Avx512,
}

impl SimdLevel {
    /// All levels, whether or not this machine supports them.
    pub const ALL: [Self; 3] = [Self::Portable, Self::Avx2, Self::Avx512];

    /// The highest level that this machine supports.
    pub fn best() -> Self {
        Token::new(Self::Avx512).level()
    }

    /// Calls `work`, compiled for this level, or for the highest level below it that this machine supports.
    /// Returns its result, which is the same at every level, to the bit.
    ///
    /// Use it for long computations, such as loops over arrays that the compiler vectorizes. Only code that
    /// is inlined into `work` is compiled for the level: mark the closure and the functions that it calls
    /// `#[inline(always)]`.
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
        vectorized!(Token::new(self), |_simd| work())
    }
}

/// Runs an expression, compiled for the level of `$token`; `$simd` is the token of that level.
macro_rules! vectorized {
    ($token:expr, |$simd:ident| $work:expr) => {
        match $token {
            $crate::cpu::Token::Portable($simd) => fearless_simd::Simd::vectorize(
                $simd,
                #[inline(always)]
                || $work,
            ),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            $crate::cpu::Token::Avx2($simd) => fearless_simd::Simd::vectorize(
                $simd,
                #[inline(always)]
                || $work,
            ),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            $crate::cpu::Token::Avx512($simd) => fearless_simd::Simd::vectorize(
                $simd,
                #[inline(always)]
                || $work,
            ),
        }
    };
}
pub(crate) use vectorized;

/// A [`SimdLevel`] that this machine supports.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Token {
    Portable(Portable),
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    Avx2(Avx2),
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    Avx512(Avx512),
}

impl Token {
    /// The token of `level`, or of the highest supported level below it.
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    pub(crate) fn new(level: SimdLevel) -> Self {
        let best = fearless_simd::Level::new();
        let avx512 = best.as_avx512().filter(|_| level >= SimdLevel::Avx512);
        let avx2 = best.as_avx2().filter(|_| level >= SimdLevel::Avx2);
        match (avx512, avx2) {
            (Some(avx512), _) => Self::Avx512(avx512),
            (None, Some(avx2)) => Self::Avx2(avx2),
            (None, None) => Self::Portable(portable()),
        }
    }

    /// The token of `level`, or of the highest supported level below it.
    #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
    pub(crate) fn new(_: SimdLevel) -> Self {
        Self::Portable(portable())
    }

    pub(crate) fn level(self) -> SimdLevel {
        match self {
            Self::Portable(_) => SimdLevel::Portable,
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Avx2(_) => SimdLevel::Avx2,
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Avx512(_) => SimdLevel::Avx512,
        }
    }
}

/// Defines the token that every machine of the compilation target has, and the function that returns it. It cannot
/// fail: the baseline level has the features that the compiler was told of.
macro_rules! baseline {
    ($($(#[$attribute:meta])* $token:ident: $value:expr;)+) => {
        $(
            $(#[$attribute])*
            pub(crate) type Portable = fearless_simd::$token;

            $(#[$attribute])*
            pub(crate) fn portable() -> Portable {
                $value
            }
        )+
    };
}

baseline! {
    #[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), target_feature = "sse2", target_feature = "fxsr"))]
    // The baseline level has the features that the condition asks for.
    Sse2: fearless_simd::Level::baseline().as_sse2().expect("part of the target");
    #[cfg(all(target_arch = "aarch64", target_feature = "neon"))]
    // The baseline level has the features that the condition asks for.
    Neon: fearless_simd::Level::baseline().as_neon().expect("part of the target");
    #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
    // The baseline level has the features that the condition asks for.
    WasmSimd128: fearless_simd::Level::baseline().as_wasm_simd128().expect("part of the target");
    #[cfg(not(any(
        all(any(target_arch = "x86", target_arch = "x86_64"), target_feature = "sse2", target_feature = "fxsr"),
        all(target_arch = "aarch64", target_feature = "neon"),
        all(target_arch = "wasm32", target_feature = "simd128"),
    )))]
    Fallback: fearless_simd::Fallback::new();
}
