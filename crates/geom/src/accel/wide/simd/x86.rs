//! Vectors of 256 bits on x86: AVX2 with FMA, and AVX-512.
//!
//! Operations for which `fearless_simd` has no portable method, or a slower one, are written here with intrinsics in
//! its kernels, which are safe.

use super::{Aligned, LANES, RayColumns, Simd, ray_numbers};
use crate::Ray;
use crate::cpu::{Avx2, Avx512};
use fearless_simd::{SimdBase, SimdCombine, SimdInto, f32x8, f64x4, kernel, u32x8};
#[cfg(target_arch = "x86")]
use std::arch::x86::*;
#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;

/// Implements [`Simd`] for a token: the methods that both have in common, and its `own`.
macro_rules! vectors_of_256_bits {
    ($token:ident, $($own:tt)*) => {
        impl Simd for $token {
            type F = f32x8<Self>;
            type I = u32x8<Self>;

            #[inline(always)]
            fn permute(self, table: Self::F, index: Self::I) -> Self::F {
                kernel!(
                    #[inline(always)]
                    fn kernel(token: $token, table: __m256, index: __m256i) -> __m256 {
                        _mm256_permutevar8x32_ps(table, index)
                    }
                );
                kernel(self, table.into(), index.into()).simd_into(self)
            }

            $($own)*
        }
    };
}

vectors_of_256_bits! { Avx2,
    // Four rows and four columns at once: the zips of wider vectors become stores of half a vector, and the
    // loads that follow wait for these.
    #[inline(always)]
    fn columns(self, rays: &[Ray; LANES]) -> RayColumns<LANES> {
        let mut halves = [[f64x4::splat(self, 0.0); LANES]; 2];
        for (i, ray) in rays.iter().enumerate() {
            let [a, b, c, d, e, f, g, h] = ray_numbers(ray);
            halves[0][i] = f64x4::load_array(self, [a, b, c, d]);
            halves[1][i] = f64x4::load_array(self, [e, f, g, h]);
        }
        let mut columns = Aligned([[0.0; LANES]; 8]);
        for (columns, [a, b, c, d, e, f, g, h]) in columns.0.as_chunks_mut::<4>().0.iter_mut().zip(halves) {
            let (first, last) = (transpose_four(self, a, b, c, d), transpose_four(self, e, f, g, h));
            for i in 0..4 {
                first[i].combine(last[i]).store_array(&mut columns[i]);
            }
        }
        columns
    }
}

kernel!(
    #[inline(always)]
    fn transpose_four(
        token: Avx2,
        a: f64x4<Avx2>,
        b: f64x4<Avx2>,
        c: f64x4<Avx2>,
        d: f64x4<Avx2>,
    ) -> [f64x4<Avx2>; 4] {
        // Columns 0 and 2 of rows two by two, and columns 1 and 3.
        let (even, even2) = (_mm256_unpacklo_pd(a.into(), b.into()), _mm256_unpacklo_pd(c.into(), d.into()));
        let (odd, odd2) = (_mm256_unpackhi_pd(a.into(), b.into()), _mm256_unpackhi_pd(c.into(), d.into()));
        [
            _mm256_permute2f128_pd::<0x20>(even, even2).simd_into(token),
            _mm256_permute2f128_pd::<0x20>(odd, odd2).simd_into(token),
            _mm256_permute2f128_pd::<0x31>(even, even2).simd_into(token),
            _mm256_permute2f128_pd::<0x31>(odd, odd2).simd_into(token),
        ]
    }
);

vectors_of_256_bits! { Avx512,
    // Most processors with AVX-512 have a first-level cache of 48 KiB.
    const IN_FLIGHT: usize = 40;

    #[inline(always)]
    fn max_abs(self, a: Self::F, b: Self::F) -> Self::F {
        kernel!(
            #[inline(always)]
            fn kernel(token: Avx512, a: __m256, b: __m256) -> __m256 {
                // Operation 3: the larger magnitude; sign 2: cleared.
                _mm256_range_ps::<0b1011>(a, b)
            }
        );
        kernel(self, a.into(), b.into()).simd_into(self)
    }
}
