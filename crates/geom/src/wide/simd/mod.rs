//! Vectors of eight lanes, on whatever the machine has.
//!
//! The traversals are written once, over [`Simd`]. A value of a type that implements it is a token
//! of [`cpu`](crate::cpu): it exists only where the instructions do, so using it is safe.

mod portable;
#[cfg(target_arch = "x86_64")]
mod x86;

use crate::{Ray, Triangle};

/// How many lanes a vector has.
pub(super) const LANES: usize = 8;

/// How many rays a packet has, and at most are in flight in a stream: one for each bit of a [`RayMask`].
pub(super) const PACKET: usize = 64;

/// How many vectors the rays of a packet fill.
pub(super) const GROUPS: usize = PACKET / LANES;

/// A set of rays, a bit each. It is kept in a register: were it a list in memory, the place of an
/// entry would depend on the outcome of a node test, and later loads would wait for it.
pub(super) type RayMask = u64;

/// The set bits of a mask of rays or lanes, ascending. An iterator and not a closure: what is not
/// inlined is not compiled for the instruction set.
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

/// Nine rows of `count` coordinates, up to eight, one after another: those of three vertices along
/// each axis. Readable a vector beyond the end.
#[derive(Clone, Copy)]
pub(super) struct Rows<'a> {
    words: &'a [f32],
    count: usize,
}

impl<'a> Rows<'a> {
    pub(super) const COUNT: usize = 9;

    #[inline(always)]
    pub(super) fn new(words: &'a [f32], count: usize) -> Self {
        assert!(count <= LANES && words.len() >= (Self::COUNT + 1) * LANES);
        Self { words, count }
    }

    /// The coordinates along `axis` of the three vertices.
    #[inline(always)]
    pub(super) fn along(self, axis: usize) -> [&'a [f32; LANES]; 3] {
        assert!(axis < 3);
        let start = 3 * axis * self.count;
        // SAFETY: these rows start at or before `8 * LANES`, and there are `10 * LANES` words.
        unsafe {
            let row = self.words.as_ptr().add(start);
            [&*row.cast(), &*row.add(self.count).cast(), &*row.add(2 * self.count).cast()]
        }
    }

    /// The lanes that hold a triangle.
    #[inline(always)]
    pub(super) fn lanes(self) -> u8 {
        (0xff_u32 >> (LANES - self.count)) as u8
    }
}

/// The numbers of rays, one of each: origin, direction, `t_min`, `t_max`.
pub(super) type RayColumns<const N: usize> = [[f64; N]; 8];

/// The coordinates of triangles, one of each: those of the first vertex, the second and the third.
pub(super) type CornerColumns = [[f32; LANES]; 9];

/// Vectors of eight `f32` or `u32`. Masks are bytes, bit `i` for lane `i`.
///
/// Comparisons with NaN are false. `mul_add` may round once or twice.
pub(super) trait Simd: Copy {
    /// Eight `f32`.
    type F: Copy;
    /// Eight `u32`.
    type I: Copy;

    fn splat(self, x: f32) -> Self::F;
    fn load(self, x: &[f32; LANES]) -> Self::F;
    fn store(self, to: &mut [f32; LANES], x: Self::F);
    fn add(self, a: Self::F, b: Self::F) -> Self::F;
    fn sub(self, a: Self::F, b: Self::F) -> Self::F;
    fn mul(self, a: Self::F, b: Self::F) -> Self::F;
    fn div(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a * b + c`.
    fn mul_add(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// `a * b - c`.
    fn mul_sub(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// The smaller; `b` if either is NaN.
    fn min(self, a: Self::F, b: Self::F) -> Self::F;
    /// The larger; `b` if either is NaN.
    fn max(self, a: Self::F, b: Self::F) -> Self::F;
    fn abs(self, a: Self::F) -> Self::F;
    /// The larger of the magnitudes.
    fn max_abs(self, a: Self::F, b: Self::F) -> Self::F;
    fn lt(self, a: Self::F, b: Self::F) -> u8;
    fn le(self, a: Self::F, b: Self::F) -> u8;
    /// The sign bits.
    fn signs(self, a: Self::F) -> u8;
    /// Lane `i` is lane `index[i] % 8` of `table`.
    fn permute(self, table: Self::F, index: Self::I) -> Self::F;
    /// Lane by lane, `a` where `mask` has a bit and `b` where not.
    fn select(self, mask: u8, a: Self::F, b: Self::F) -> Self::F;
    /// The smallest of the lanes in `mask`, or infinity.
    fn min_of(self, a: Self::F, mask: u8) -> f32;

    fn load_i(self, x: &[u32; LANES]) -> Self::I;
    fn store_i(self, to: &mut [u32; LANES], x: Self::I);
    /// The indices of eight lanes, three bits each.
    fn lane_indices(self, packed: u32) -> Self::I;
    /// [`Simd::permute`] for integers.
    fn permute_i(self, table: Self::I, index: Self::I) -> Self::I;

    /// The numbers of eight rays, side by side.
    fn columns(self, rays: &[Ray; LANES]) -> RayColumns<LANES>;
    /// The coordinates of eight triangles, side by side.
    fn corners(self, triangles: [&Triangle; LANES]) -> CornerColumns;

    /// Asks for the cache line at `x`, whatever is there.
    fn prefetch<T>(self, x: *const T);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cpu::{SimdLevel, Token};
    use glam::{DVec3, Vec3};

    fn at_every_level(check: impl Fn(SimdLevel, RayColumns<LANES>, CornerColumns)) {
        let number = |at: usize, column: usize| (9 * at + column) as f64;
        let rays: [Ray; LANES] = std::array::from_fn(|i| {
            let [ox, oy, oz, dx, dy, dz, t_min, t_max] = std::array::from_fn(|column| number(i, column));
            Ray { origin: DVec3::new(ox, oy, oz), direction: DVec3::new(dx, dy, dz), t_min, t_max }
        });
        let triangles: [Triangle; LANES] = std::array::from_fn(|i| {
            let corner = |at: usize| Vec3::from_array([0, 1, 2].map(|axis| number(i, 3 * at + axis) as f32));
            Triangle::new(corner(0), corner(1), corner(2))
        });
        for level in SimdLevel::ALL {
            let (columns, corners) = match Token::new(level) {
                Token::Portable(simd) => (simd.columns(&rays), simd.corners(triangles.each_ref())),
                #[cfg(target_arch = "x86_64")]
                Token::Avx2(simd) => (simd.columns(&rays), simd.corners(triangles.each_ref())),
                #[cfg(target_arch = "x86_64")]
                Token::Avx512(simd) => (simd.columns(&rays), simd.corners(triangles.each_ref())),
            };
            check(level, columns, corners);
        }
    }

    #[test]
    fn columns_are_what_rays_and_triangles_are_made_of() {
        at_every_level(|level, columns, corners| {
            for (column, numbers) in columns.iter().enumerate() {
                assert_eq!(*numbers, std::array::from_fn(|i| (9 * i + column) as f64), "{level:?}");
            }
            for (column, numbers) in corners.iter().enumerate() {
                assert_eq!(*numbers, std::array::from_fn(|i| (9 * i + column) as f32), "{level:?}");
            }
        });
    }
}
