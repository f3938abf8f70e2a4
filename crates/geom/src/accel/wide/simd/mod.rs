//! Vectors of eight lanes, on whatever the machine has.
//!
//! The traversals are written once, over [`Simd`], a thin layer over the vectors of `fearless_simd`. A value of a
//! type that implements it is a token of [`cpu`](crate::cpu): it exists only where the instructions do.

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
mod x86;

use crate::cpu::Portable;
use crate::{Ray, Triangle};
use fearless_simd::{Select, SimdInt, SimdMask, f32x8, f64x8, u32x8};
pub(super) use fearless_simd::{SimdBase, SimdFloat};

/// How many lanes a vector has.
pub(super) const LANES: usize = 8;

/// How many rays a packet has, and at most are in flight in a stream: one for each bit of a [`RayMask`].
pub(super) const PACKET: usize = 64;

/// How many vectors the rays of a packet fill.
pub(super) const GROUPS: usize = PACKET / LANES;

/// A set of rays, a bit each. A register holds it. In a list in memory, the place of an entry would depend on the
/// outcome of a node test, and later loads would wait for it.
pub(super) type RayMask = u64;

/// The set bits of a mask of rays or lanes, ascending. It is an iterator and not a closure, since
/// functions that are not inlined are not compiled for the instruction set.
pub(super) struct Bits(pub(super) RayMask);

impl Iterator for Bits {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        if self.0 == 0 {
            return None;
        }
        let bit = self.0.trailing_zeros() as usize % PACKET;
        self.0 &= self.0 - 1;
        Some(bit)
    }
}

/// What vectors are stored to and loaded from. Aligned to cache lines: a load of a vector that was stored across two
/// lines waits for both.
#[repr(align(64))]
#[derive(Clone, Copy, Debug)]
pub(super) struct Aligned<T>(pub(super) T);

/// `N` rays as a structure of arrays: a row for each of the three coordinates of origins, the same of directions, `t_min` and
/// `t_max`.
pub(super) type RayColumns<const N: usize> = Aligned<[[f64; N]; 8]>;

/// Eight triangles as a structure of arrays: a row for each of the three coordinates of the first vertex, the second and the
/// third.
pub(super) type CornerColumns = Aligned<[[f32; LANES]; 9]>;

/// Vectors of eight `f32` or `u32`. They have the operators and methods of `fearless_simd`, and those of [`SimdFloat`] and
/// [`SimdInt`]. A mask is a byte with bit `i` for lane `i`.
///
/// Comparisons with NaN are false. `mul_add` may round once or twice; `min` and `max` with a NaN are either operand.
///
/// No [`array::map`] on vectors: it is not always inlined, and then not compiled for the instruction set.
pub(super) trait Simd: fearless_simd::Simd {
    /// Eight `f32`.
    type F: SimdFloat<Self, Element = f32, Array = [f32; LANES], Bits = Self::I>;
    /// Eight `u32`.
    type I: SimdInt<Self, Element = u32, Array = [u32; LANES]>;

    /// How many rays of a stream are in flight: enough to hide latency, and few enough that their state stays in the
    /// first-level cache (measured, docs/history.md). This is for a cache of 32 KiB, which most processors without AVX-512
    /// have.
    const IN_FLIGHT: usize = 24;

    #[inline(always)]
    fn splat(self, x: f32) -> Self::F {
        SimdBase::splat(self, x)
    }
    #[inline(always)]
    fn load(self, x: &[f32; LANES]) -> Self::F {
        SimdBase::load_array_ref(self, x)
    }
    /// The larger of the magnitudes.
    #[inline(always)]
    fn max_abs(self, a: Self::F, b: Self::F) -> Self::F {
        a.abs().max(b.abs())
    }
    #[inline(always)]
    fn lt(self, a: Self::F, b: Self::F) -> u8 {
        a.simd_lt(b).to_bitmask() as u8
    }
    #[inline(always)]
    fn le(self, a: Self::F, b: Self::F) -> u8 {
        a.simd_le(b).to_bitmask() as u8
    }
    /// Lane `i` is lane `index[i] % 8` of `table`.
    #[inline(always)]
    fn permute(self, table: Self::F, index: Self::I) -> Self::F {
        SimdBase::load_array(
            self,
            index.to_array().map(
                #[inline(always)]
                |i| table[i as usize % LANES],
            ),
        )
    }
    /// Lane by lane, `a` where `mask` has a bit and `b` where not.
    #[inline(always)]
    fn select(self, mask: u8, a: Self::F, b: Self::F) -> Self::F {
        <Self::F as SimdBase<Self>>::Mask::from_bitmask(self, mask.into()).select(a, b)
    }
    /// The smallest of the lanes in `mask`, or infinity.
    #[inline(always)]
    fn min_of(self, a: Self::F, mask: u8) -> f32 {
        self.select(mask, a, self.splat(f32::INFINITY)).reduce_min()
    }

    /// The smallest and the largest of the numbers that `column` has for the groups of `rays`.
    #[inline(always)]
    fn range<'a>(self, rays: RayMask, column: impl Fn(usize) -> &'a [f32; LANES]) -> [f32; 2] {
        let none = self.splat(f32::INFINITY);
        let (mut low, mut minus_high) = (none, none);
        for g in 0..GROUPS {
            let (x, lanes) = (self.load(column(g)), (rays >> (g * LANES)) as u8);
            low = low.min(self.select(lanes, x, none));
            minus_high = minus_high.min(self.select(lanes, -x, none));
        }
        [self.min_of(low, 0xff), -self.min_of(minus_high, 0xff)]
    }

    /// The indices of eight lanes, three bits each.
    #[inline(always)]
    fn lane_indices(self, packed: u32) -> Self::I {
        let shifts = Self::I::load_array(self, [0, 3, 6, 9, 12, 15, 18, 21]);
        <Self::I as SimdBase<Self>>::splat(self, packed) >> shifts
    }

    /// The numbers of eight rays, side by side.
    #[inline(always)]
    fn columns(self, rays: &[Ray; LANES]) -> RayColumns<LANES> {
        let mut rows = [f64x8::splat(self, 0.0); LANES];
        for (row, ray) in rows.iter_mut().zip(rays) {
            *row = f64x8::load_array(self, ray_numbers(ray));
        }
        let mut columns = Aligned([[0.0; LANES]; 8]);
        for (column, x) in columns.0.iter_mut().zip(transpose(rows)) {
            x.store_array(column);
        }
        columns
    }
    /// The coordinates of eight triangles, side by side.
    #[inline(always)]
    fn corners(self, triangles: [&Triangle; LANES]) -> CornerColumns {
        let (mut rows, mut corners) = ([self.splat(0.0); LANES], Aligned([[0.0; LANES]; 9]));
        for (i, triangle) in triangles.into_iter().enumerate() {
            let [row @ .., last] = coordinates(triangle);
            rows[i] = self.load(&row);
            corners.0[8][i] = last;
        }
        for (column, x) in corners.0.iter_mut().zip(transpose(rows)) {
            x.store_array(column);
        }
        corners
    }
}

/// Transposes eight vectors of eight lanes: thrice, each of the first four is zipped with one of the last four.
#[inline(always)]
fn transpose<S: Simd, V: SimdBase<S>>(mut rows: [V; LANES]) -> [V; LANES] {
    for _ in 0..3 {
        let [a, b, c, d, e, f, g, h] = rows;
        let (ae, bf, cg, dh) = (zip(a, e), zip(b, f), zip(c, g), zip(d, h));
        rows = [ae.0, ae.1, bf.0, bf.1, cg.0, cg.1, dh.0, dh.1];
    }
    rows
}

/// The lanes of two vectors in turns.
#[inline(always)]
fn zip<S: Simd, V: SimdBase<S>>(a: V, b: V) -> (V, V) {
    (a.zip_low(b), a.zip_high(b))
}

/// Origin, direction, `t_min` and `t_max`.
#[inline(always)]
pub(super) fn ray_numbers(ray: &Ray) -> [f64; 8] {
    let Ray { origin: o, direction: d, t_min, t_max, .. } = *ray;
    [o.x, o.y, o.z, d.x, d.y, d.z, t_min, t_max]
}

/// The coordinates of the first vertex, the second and the third.
#[inline(always)]
fn coordinates(triangle: &Triangle) -> [f32; 9] {
    let [a, b, c] = triangle.vertices;
    [a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z]
}

impl Simd for Portable {
    type F = f32x8<Self>;
    type I = u32x8<Self>;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cpu::{SimdLevel, Token, vectorized};
    use glam::{DVec3, Vec3};

    fn at_every_level(check: impl Fn(SimdLevel, RayColumns<LANES>, CornerColumns)) {
        let number = |at: usize, column: usize| (9 * at + column) as f64;
        let rays: [Ray; LANES] = std::array::from_fn(|i| {
            let [ox, oy, oz, dx, dy, dz, t_min, t_max] = std::array::from_fn(|column| number(i, column));
            Ray::new(DVec3::new(ox, oy, oz), DVec3::new(dx, dy, dz)).with_range(t_min, t_max)
        });
        let triangles: [Triangle; LANES] = std::array::from_fn(|i| {
            let corner = |at: usize| Vec3::from_array([0, 1, 2].map(|axis| number(i, 3 * at + axis) as f32));
            Triangle::new(corner(0), corner(1), corner(2))
        });
        for level in SimdLevel::ALL {
            let (columns, corners) = vectorized!(Token::new(level), |simd| {
                (simd.columns(&rays), simd.corners(triangles.each_ref()))
            });
            check(level, columns, corners);
        }
    }

    #[test]
    fn columns_are_what_rays_and_triangles_are_made_of() {
        at_every_level(|level, columns, corners| {
            for (column, numbers) in columns.0.iter().enumerate() {
                assert_eq!(*numbers, std::array::from_fn(|i| (9 * i + column) as f64), "{level:?}");
            }
            for (column, numbers) in corners.0.iter().enumerate() {
                assert_eq!(*numbers, std::array::from_fn(|i| (9 * i + column) as f32), "{level:?}");
            }
        });
    }
}
