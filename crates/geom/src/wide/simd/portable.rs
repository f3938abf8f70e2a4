//! Vectors in plain Rust, for every machine.

use super::{CornerColumns, LANES, RayColumns, Simd};
use crate::cpu::Portable;
use crate::{Ray, Triangle};
use std::array::from_fn;

type F = [f32; LANES];
type I = [u32; LANES];

#[inline(always)]
fn mask_of(bit: impl Fn(usize) -> bool) -> u8 {
    (0..LANES).fold(0, |mask, i| mask | u8::from(bit(i)) << i)
}

impl Simd for Portable {
    type F = F;
    type I = I;

    #[inline(always)]
    fn splat(self, x: f32) -> F {
        [x; LANES]
    }
    #[inline(always)]
    fn load(self, x: &[f32; LANES]) -> F {
        *x
    }
    #[inline(always)]
    fn store(self, to: &mut [f32; LANES], x: F) {
        *to = x;
    }
    #[inline(always)]
    fn add(self, a: F, b: F) -> F {
        from_fn(|i| a[i] + b[i])
    }
    #[inline(always)]
    fn sub(self, a: F, b: F) -> F {
        from_fn(|i| a[i] - b[i])
    }
    #[inline(always)]
    fn mul(self, a: F, b: F) -> F {
        from_fn(|i| a[i] * b[i])
    }
    #[inline(always)]
    fn div(self, a: F, b: F) -> F {
        from_fn(|i| a[i] / b[i])
    }
    #[inline(always)]
    fn mul_add(self, a: F, b: F, c: F) -> F {
        from_fn(|i| a[i] * b[i] + c[i])
    }
    #[inline(always)]
    fn mul_sub(self, a: F, b: F, c: F) -> F {
        from_fn(|i| a[i] * b[i] - c[i])
    }
    #[inline(always)]
    fn min(self, a: F, b: F) -> F {
        from_fn(|i| if a[i] < b[i] { a[i] } else { b[i] })
    }
    #[inline(always)]
    fn max(self, a: F, b: F) -> F {
        from_fn(|i| if a[i] > b[i] { a[i] } else { b[i] })
    }
    #[inline(always)]
    fn abs(self, a: F) -> F {
        a.map(f32::abs)
    }
    #[inline(always)]
    fn max_abs(self, a: F, b: F) -> F {
        self.max(self.abs(a), self.abs(b))
    }
    #[inline(always)]
    fn lt(self, a: F, b: F) -> u8 {
        mask_of(|i| a[i] < b[i])
    }
    #[inline(always)]
    fn le(self, a: F, b: F) -> u8 {
        mask_of(|i| a[i] <= b[i])
    }
    #[inline(always)]
    fn signs(self, a: F) -> u8 {
        mask_of(|i| a[i].is_sign_negative())
    }
    #[inline(always)]
    fn permute(self, table: F, index: I) -> F {
        index.map(|i| table[i as usize % LANES])
    }
    #[inline(always)]
    fn select(self, mask: u8, a: F, b: F) -> F {
        from_fn(|i| if mask >> i & 1 == 1 { a[i] } else { b[i] })
    }
    #[inline(always)]
    fn min_of(self, a: F, mask: u8) -> f32 {
        (0..LANES).fold(f32::INFINITY, |m, i| if mask >> i & 1 == 1 && a[i] < m { a[i] } else { m })
    }

    #[inline(always)]
    fn load_i(self, x: &[u32; LANES]) -> I {
        *x
    }
    #[inline(always)]
    fn store_i(self, to: &mut [u32; LANES], x: I) {
        *to = x;
    }
    #[inline(always)]
    fn lane_indices(self, packed: u32) -> I {
        from_fn(|i| packed >> (3 * i))
    }
    #[inline(always)]
    fn permute_i(self, table: I, index: I) -> I {
        index.map(|i| table[i as usize % LANES])
    }

    #[inline(always)]
    fn columns(self, rays: &[Ray; LANES]) -> RayColumns<LANES> {
        let mut columns = [[0.0; LANES]; 8];
        for (i, ray) in rays.iter().enumerate() {
            let Ray { origin: o, direction: d, t_min, t_max } = *ray;
            for (column, x) in columns.iter_mut().zip([o.x, o.y, o.z, d.x, d.y, d.z, t_min, t_max]) {
                column[i] = x;
            }
        }
        columns
    }

    #[inline(always)]
    fn corners(self, triangles: [&Triangle; LANES]) -> CornerColumns {
        from_fn(|at| triangles.map(|triangle| triangle.vertices[at / 3][at % 3]))
    }

    #[inline(always)]
    fn prefetch<T>(self, _: *const T) {}
}
