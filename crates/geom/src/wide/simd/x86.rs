//! Vectors of 256 bits on x86-64: AVX2 with FMA, and AVX-512.
//!
//! Both levels share all but five methods. AVX-512 brings mask registers, a maximum of magnitudes, and
//! loads of a whole ray.

use super::{CornerColumns, LANES, RayColumns, Simd};
use crate::cpu::{Avx2, Avx512};
use crate::{Ray, Triangle};
use glam::{DVec3, Vec3};
use std::arch::x86_64::*;
use std::mem::offset_of;

const F32: usize = size_of::<f32>();
const F64: usize = size_of::<f64>();

// What the casts below rest on.
const _: () = {
    assert!(offset_of!(DVec3, x) == 0 && offset_of!(DVec3, y) == F64 && offset_of!(DVec3, z) == 2 * F64);
    assert!(offset_of!(Ray, origin) == 0 && offset_of!(Ray, direction) == 3 * F64);
    assert!(offset_of!(Ray, t_min) == 6 * F64 && offset_of!(Ray, t_max) == 7 * F64);
    assert!(size_of::<Ray>() == 8 * F64 && align_of::<Ray>() == align_of::<f64>());
    assert!(offset_of!(Vec3, x) == 0 && offset_of!(Vec3, y) == F32 && offset_of!(Vec3, z) == 2 * F32);
    assert!(offset_of!(Triangle, vertices) == 0 && size_of::<[Vec3; 3]>() == 9 * F32);
    assert!(size_of::<Triangle>() == 9 * F32 && align_of::<Triangle>() == align_of::<f32>());
};

/// Origin, direction, `t_min` and `t_max`.
#[inline(always)]
fn numbers(ray: &Ray) -> &[f64; 8] {
    // SAFETY: a ray is eight `f64`, in this order.
    unsafe { &*std::ptr::from_ref(ray).cast() }
}

/// The coordinates of the first vertex, the second and the third.
#[inline(always)]
fn coordinates(triangle: &Triangle) -> &[f32; 9] {
    // SAFETY: a triangle is nine `f32`, in this order.
    unsafe { &*std::ptr::from_ref(triangle).cast() }
}

/// All bits of the lanes in `mask`.
#[inline]
#[target_feature(enable = "avx2")]
fn lanes(mask: u8) -> __m256 {
    let bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    let mask = _mm256_and_si256(_mm256_set1_epi32(i32::from(mask)), bits);
    _mm256_castsi256_ps(_mm256_cmpeq_epi32(mask, bits))
}

/// The coordinates of eight triangles, side by side.
#[inline]
#[target_feature(enable = "avx2")]
fn transpose_corners(triangles: [&Triangle; LANES]) -> CornerColumns {
    let mut corners = [[0.0; LANES]; 9];
    // Of two rows, coordinates 0, 1, 4 and 5, and coordinates 2, 3, 6 and 7.
    let mut pairs = [[_mm256_setzero_pd(); 4]; 2];
    for i in 0..4 {
        let (a, b) = (coordinates(triangles[2 * i]), coordinates(triangles[2 * i + 1]));
        // SAFETY: there are nine.
        let (a, b) = unsafe { (_mm256_loadu_ps(a.as_ptr()), _mm256_loadu_ps(b.as_ptr())) };
        pairs[0][i] = _mm256_castps_pd(_mm256_unpacklo_ps(a, b));
        pairs[1][i] = _mm256_castps_pd(_mm256_unpackhi_ps(a, b));
    }
    for (at, [a, b, c, d]) in [(0, pairs[0]), (2, pairs[1])] {
        // Of four rows, one coordinate of the first four and one of the last.
        let (ab, cd) = (_mm256_unpacklo_pd(a, b), _mm256_unpacklo_pd(c, d));
        let (ab1, cd1) = (_mm256_unpackhi_pd(a, b), _mm256_unpackhi_pd(c, d));
        let columns = [
            (at, _mm256_permute2f128_pd::<0x20>(ab, cd)),
            (at + 1, _mm256_permute2f128_pd::<0x20>(ab1, cd1)),
            (at + 4, _mm256_permute2f128_pd::<0x31>(ab, cd)),
            (at + 5, _mm256_permute2f128_pd::<0x31>(ab1, cd1)),
        ];
        for (column, x) in columns {
            // SAFETY: a column has room for eight.
            unsafe { _mm256_storeu_ps(corners[column].as_mut_ptr(), _mm256_castpd_ps(x)) };
        }
    }
    for (i, triangle) in triangles.into_iter().enumerate() {
        corners[8][i] = coordinates(triangle)[8];
    }
    corners
}

/// Calls an intrinsic in a method of the token.
macro_rules! call {
    ($e:expr) => {
        // SAFETY: the token exists only where the instructions do; every pointer that is read or
        // written through comes from a reference to as much as that.
        unsafe { $e }
    };
}

/// Implements [`Simd`] for a token: the methods that both have in common, and its `own`.
macro_rules! vectors_of_256_bits {
    ($token:ty, $($own:tt)*) => {
        impl Simd for $token {
            type F = __m256;
            type I = __m256i;

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
            fn signs(self, a: __m256) -> u8 {
                call!(_mm256_movemask_ps(a)) as u8
            }
            #[inline(always)]
            fn permute(self, table: __m256, index: __m256i) -> __m256 {
                call!(_mm256_permutevar8x32_ps(table, index))
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
            fn corners(self, triangles: [&Triangle; LANES]) -> CornerColumns {
                call!(transpose_corners(triangles))
            }
            #[inline(always)]
            fn prefetch<T>(self, x: *const T) {
                call!(_mm_prefetch::<_MM_HINT_T0>(x.cast()));
            }

            $($own)*
        }
    };
}

vectors_of_256_bits! { Avx2,
    #[inline(always)]
    fn max_abs(self, a: __m256, b: __m256) -> __m256 {
        self.max(self.abs(a), self.abs(b))
    }
    #[inline(always)]
    fn lt(self, a: __m256, b: __m256) -> u8 {
        call!(_mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(a, b))) as u8
    }
    #[inline(always)]
    fn le(self, a: __m256, b: __m256) -> u8 {
        call!(_mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(a, b))) as u8
    }
    #[inline(always)]
    fn select(self, mask: u8, a: __m256, b: __m256) -> __m256 {
        call!(_mm256_blendv_ps(b, a, lanes(mask)))
    }
    #[inline(always)]
    fn columns(self, rays: &[Ray; LANES]) -> RayColumns<LANES> {
        let rows = rays.each_ref().map(numbers);
        let mut columns = [[0.0; LANES]; 8];
        // Four rows and four columns at once.
        for (r, c) in [(0, 0), (0, 4), (4, 0), (4, 4)] {
            call!({
                let (a0, a1) =
                    (_mm256_loadu_pd(rows[r][c..].as_ptr()), _mm256_loadu_pd(rows[r + 1][c..].as_ptr()));
                let (a2, a3) =
                    (_mm256_loadu_pd(rows[r + 2][c..].as_ptr()), _mm256_loadu_pd(rows[r + 3][c..].as_ptr()));
                // Columns 0 and 2 of rows two by two, and columns 1 and 3.
                let (even, even2) = (_mm256_unpacklo_pd(a0, a1), _mm256_unpacklo_pd(a2, a3));
                let (odd, odd2) = (_mm256_unpackhi_pd(a0, a1), _mm256_unpackhi_pd(a2, a3));
                _mm256_storeu_pd(columns[c][r..].as_mut_ptr(), _mm256_permute2f128_pd::<0x20>(even, even2));
                _mm256_storeu_pd(columns[c + 1][r..].as_mut_ptr(), _mm256_permute2f128_pd::<0x20>(odd, odd2));
                _mm256_storeu_pd(
                    columns[c + 2][r..].as_mut_ptr(),
                    _mm256_permute2f128_pd::<0x31>(even, even2),
                );
                _mm256_storeu_pd(columns[c + 3][r..].as_mut_ptr(), _mm256_permute2f128_pd::<0x31>(odd, odd2));
            });
        }
        columns
    }
}

vectors_of_256_bits! { Avx512,
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
    fn select(self, mask: u8, a: __m256, b: __m256) -> __m256 {
        call!(_mm256_mask_blend_ps(mask, b, a))
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
}
