//! CPU dispatch: code is written once, compiled for each [`SimdLevel`], and selected at run time.
//!
//! A value of a token type ([`Avx2`], [`Avx512`]) exists only if the machine supports the instruction set, so
//! code that has one may use these instructions.

/// The instruction sets that code is compiled for, in ascending order. All give the same results, to the bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum SimdLevel {
    /// The baseline of the compilation target.
    Portable,
    /// AVX2 with FMA.
    Avx2,
    /// AVX-512 F, BW, DQ and VL.
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
        match Token::new(self) {
            Token::Portable(simd) => simd.vectorize(work),
            #[cfg(target_arch = "x86_64")]
            Token::Avx2(simd) => simd.vectorize(work),
            #[cfg(target_arch = "x86_64")]
            Token::Avx512(simd) => simd.vectorize(work),
        }
    }
}

/// The token that every machine has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Portable;

impl Portable {
    /// Calls `work`, compiled for the baseline of the target.
    #[inline(always)]
    pub(crate) fn vectorize<R>(self, work: impl FnOnce() -> R) -> R {
        work()
    }
}

/// Defines the token of an instruction set, given its CPU features.
#[cfg(target_arch = "x86_64")]
macro_rules! instruction_set {
    ($(#[$attribute:meta])* $token:ident: $($feature:tt),+) => {
        $(#[$attribute])*
        #[derive(Clone, Copy, Debug)]
        pub(crate) struct $token(());

        impl $token {
            /// The token; `None` if the machine does not support every feature.
            fn detect() -> Option<Self> {
                ($(is_x86_feature_detected!($feature))&&+).then_some(Self(()))
            }

            /// Calls `work`, compiled for this instruction set.
            #[inline(always)]
            pub(crate) fn vectorize<R>(self, work: impl FnOnce() -> R) -> R {
                #[target_feature($(enable = $feature),+)]
                fn inner<R>(work: impl FnOnce() -> R) -> R {
                    work()
                }
                // SAFETY: the token exists only if the machine supports all of the features.
                unsafe { inner(work) }
            }
        }
    };
}

#[cfg(target_arch = "x86_64")]
instruction_set! {
    /// The machine supports AVX2 and FMA.
    Avx2: "avx2", "fma", "bmi1", "bmi2", "popcnt", "lzcnt"
}

#[cfg(target_arch = "x86_64")]
instruction_set! {
    /// The machine supports AVX-512 F, BW, DQ and VL.
    Avx512: "avx512f", "avx512dq", "avx512vl", "avx512bw", "avx2", "fma", "bmi1", "bmi2", "popcnt", "lzcnt"
}

/// A [`SimdLevel`] that this machine supports.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Token {
    Portable(Portable),
    #[cfg(target_arch = "x86_64")]
    Avx2(Avx2),
    #[cfg(target_arch = "x86_64")]
    Avx512(Avx512),
}

impl Token {
    /// The token of `level`, or of the highest supported level below it.
    #[cfg(target_arch = "x86_64")]
    pub(crate) fn new(level: SimdLevel) -> Self {
        let avx512 = (level >= SimdLevel::Avx512).then(Avx512::detect).flatten();
        let avx2 = (level >= SimdLevel::Avx2).then(Avx2::detect).flatten();
        match (avx512, avx2) {
            (Some(avx512), _) => Self::Avx512(avx512),
            (None, Some(avx2)) => Self::Avx2(avx2),
            (None, None) => Self::Portable(Portable),
        }
    }

    /// The token of `level`, or of the highest supported level below it.
    #[cfg(not(target_arch = "x86_64"))]
    pub(crate) fn new(_: SimdLevel) -> Self {
        Self::Portable(Portable)
    }

    pub(crate) fn level(self) -> SimdLevel {
        match self {
            Self::Portable(_) => SimdLevel::Portable,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(_) => SimdLevel::Avx2,
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(_) => SimdLevel::Avx512,
        }
    }
}
