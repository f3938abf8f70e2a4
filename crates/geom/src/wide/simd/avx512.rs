//! AVX-512, with vectors of 256 bits: its masks, compression and permutations are what pays.

use super::avx2::turn;
use super::rows::numbers;
use super::{CornerColumns, LANES, RayColumns, Simd};
use crate::{Ray, Triangle};
use std::arch::x86_64::*;

/// The machine has AVX-512 F, DQ, VL and BW.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Avx512(());

impl Avx512 {
    pub(in super::super) fn detect() -> Option<Self> {
        let all = is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("popcnt")
            && is_x86_feature_detected!("lzcnt");
        all.then_some(Self(()))
    }
}

/// Calls an intrinsic in a method of the token.
macro_rules! call {
    ($e:expr) => {
        // SAFETY: the token exists only where the instructions do; every pointer that is read or
        // written through comes from a reference to as much as that.
        unsafe { $e }
    };
}

impl Simd for Avx512 {
    type F = __m256;
    type I = __m256i;

    #[inline(always)]
    fn vectorize<R>(self, f: impl FnOnce() -> R) -> R {
        #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx512bw,avx2,fma,bmi1,bmi2,popcnt,lzcnt")]
        fn inner<R>(f: impl FnOnce() -> R) -> R {
            f()
        }
        call!(inner(f))
    }

    #[inline(always)]
    fn splat(self, x: f32) -> __m256 {
        call!(_mm256_set1_ps(x))
    }
    #[inline(always)]
    fn load(self, x: &[f32; LANES]) -> __m256 {
        call!(_mm256_loadu_ps(x.as_ptr()))
    }
    #[inline(always)]
    fn store(self, to: &mut [f32; LANES], x: __m256) {
        call!(_mm256_storeu_ps(to.as_mut_ptr(), x));
    }
    #[inline(always)]
    fn add(self, a: __m256, b: __m256) -> __m256 {
        call!(_mm256_add_ps(a, b))
    }
    #[inline(always)]
    fn sub(self, a: __m256, b: __m256) -> __m256 {
        call!(_mm256_sub_ps(a, b))
    }
    #[inline(always)]
    fn mul(self, a: __m256, b: __m256) -> __m256 {
        call!(_mm256_mul_ps(a, b))
    }
    #[inline(always)]
    fn div(self, a: __m256, b: __m256) -> __m256 {
        call!(_mm256_div_ps(a, b))
    }
    #[inline(always)]
    fn mul_add(self, a: __m256, b: __m256, c: __m256) -> __m256 {
        call!(_mm256_fmadd_ps(a, b, c))
    }
    #[inline(always)]
    fn mul_sub(self, a: __m256, b: __m256, c: __m256) -> __m256 {
        call!(_mm256_fmsub_ps(a, b, c))
    }
    #[inline(always)]
    fn min(self, a: __m256, b: __m256) -> __m256 {
        call!(_mm256_min_ps(a, b))
    }
    #[inline(always)]
    fn max(self, a: __m256, b: __m256) -> __m256 {
        call!(_mm256_max_ps(a, b))
    }
    #[inline(always)]
    fn abs(self, a: __m256) -> __m256 {
        call!(_mm256_andnot_ps(_mm256_set1_ps(-0.0), a))
    }
    #[inline(always)]
    fn max_abs(self, a: __m256, b: __m256) -> __m256 {
        // Operation 3: the larger magnitude; sign 2: cleared.
        call!(_mm256_range_ps::<0b1011>(a, b))
    }
    #[inline(always)]
    fn lt(self, a: __m256, b: __m256) -> u8 {
        call!(_mm256_cmp_ps_mask::<_CMP_LT_OQ>(a, b))
    }
    #[inline(always)]
    fn le(self, a: __m256, b: __m256) -> u8 {
        call!(_mm256_cmp_ps_mask::<_CMP_LE_OQ>(a, b))
    }
    #[inline(always)]
    fn signs(self, a: __m256) -> u8 {
        call!(_mm256_movemask_ps(a)) as u8
    }
    #[inline(always)]
    fn permute(self, table: __m256, index: __m256i) -> __m256 {
        call!(_mm256_permutevar8x32_ps(table, index))
    }
    #[inline(always)]
    fn select(self, mask: u8, a: __m256, b: __m256) -> __m256 {
        call!(_mm256_mask_blend_ps(mask, b, a))
    }
    #[inline(always)]
    fn min_of(self, a: __m256, mask: u8) -> f32 {
        call!({
            let a = self.select(mask, a, _mm256_set1_ps(f32::INFINITY));
            let a = _mm_min_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps::<1>(a));
            let a = _mm_min_ps(a, _mm_movehl_ps(a, a));
            _mm_cvtss_f32(_mm_min_ss(a, _mm_movehdup_ps(a)))
        })
    }

    #[inline(always)]
    fn load_i(self, x: &[u32; LANES]) -> __m256i {
        call!(_mm256_loadu_si256(x.as_ptr().cast()))
    }
    #[inline(always)]
    fn store_i(self, to: &mut [u32; LANES], x: __m256i) {
        call!(_mm256_storeu_si256(to.as_mut_ptr().cast(), x));
    }
    #[inline(always)]
    fn lane_indices(self, packed: u32) -> __m256i {
        call!(_mm256_srlv_epi32(
            _mm256_set1_epi32(packed as i32),
            _mm256_setr_epi32(0, 3, 6, 9, 12, 15, 18, 21)
        ))
    }
    #[inline(always)]
    fn permute_i(self, table: __m256i, index: __m256i) -> __m256i {
        call!(_mm256_permutevar8x32_epi32(table, index))
    }

    #[inline(always)]
    fn columns(self, rays: &[Ray; LANES]) -> RayColumns<LANES> {
        let mut columns = [[0.0; LANES]; 8];
        call!({
            // Columns 0, 2, 4 and 6 of rows two by two, and columns 1, 3, 5 and 7.
            let mut pairs = [[_mm512_setzero_pd(); 4]; 2];
            for i in 0..4 {
                let a = _mm512_loadu_pd(numbers(&rays[2 * i]).as_ptr());
                let b = _mm512_loadu_pd(numbers(&rays[2 * i + 1]).as_ptr());
                pairs[0][i] = _mm512_unpacklo_pd(a, b);
                pairs[1][i] = _mm512_unpackhi_pd(a, b);
            }
            for (odd, [a, b, c, d]) in pairs.into_iter().enumerate() {
                // Columns 0 and 4 of four rows, and columns 2 and 6.
                let (ab, cd) = (_mm512_shuffle_f64x2::<0x88>(a, b), _mm512_shuffle_f64x2::<0x88>(c, d));
                let (ab2, cd2) = (_mm512_shuffle_f64x2::<0xdd>(a, b), _mm512_shuffle_f64x2::<0xdd>(c, d));
                _mm512_storeu_pd(columns[odd].as_mut_ptr(), _mm512_shuffle_f64x2::<0x88>(ab, cd));
                _mm512_storeu_pd(columns[odd + 4].as_mut_ptr(), _mm512_shuffle_f64x2::<0xdd>(ab, cd));
                _mm512_storeu_pd(columns[odd + 2].as_mut_ptr(), _mm512_shuffle_f64x2::<0x88>(ab2, cd2));
                _mm512_storeu_pd(columns[odd + 6].as_mut_ptr(), _mm512_shuffle_f64x2::<0xdd>(ab2, cd2));
            }
        });
        columns
    }

    #[inline(always)]
    fn corners(self, triangles: [&Triangle; LANES]) -> CornerColumns {
        call!(turn(triangles))
    }

    #[inline(always)]
    fn prefetch<T>(self, x: *const T) {
        call!(_mm_prefetch::<_MM_HINT_T0>(x.cast()));
    }
}
