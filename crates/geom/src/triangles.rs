use crate::{Aabb, GeomError, SurfacePoint, Triangle};
use glam::{DVec3, Vec3};
use prefetch_index::prefetch_index;
use std::fmt;
use std::sync::Arc;

/// Validated triangles, from which every accelerator is built.
///
/// Indices are those of the input. A [degenerate](Triangle::is_degenerate) triangle keeps its index, but it
/// is not [`live`](Triangles::live) and never hit. Clones share the triangles.
#[derive(Clone)]
pub struct Triangles {
    all: Arc<[Triangle]>,
    live: Arc<[u32]>,
    bounds: Aabb,
    /// The length of the longest side of the bounds of all triangles that are not degenerate.
    extent: f64,
}

impl Triangles {
    /// The largest number of triangles: `2^30 - 1`, so that an index, an `f32` coordinate and two bits fit
    /// into 64 bits.
    pub const MAX_COUNT: usize = (1 << 30) - 1;

    /// Validates `triangles`. Replaces negative zeros by positive ones.
    ///
    /// # Errors
    /// [`GeomError::NonFinite`] or [`GeomError::Domain`] for the first invalid coordinate,
    /// [`GeomError::TooMany`] for more than [`Triangles::MAX_COUNT`] triangles.
    pub fn new(mut triangles: Vec<Triangle>) -> Result<Self, GeomError> {
        check_count(triangles.len())?;
        let mut live = Vec::with_capacity(triangles.len());
        let mut bounds = Aabb::EMPTY;
        for (index, triangle) in triangles.iter_mut().enumerate() {
            triangle.validate(index)?;
            // A negative zero would affect the sign of a zero `t`.
            triangle.vertices = triangle.vertices.map(|v| v + Vec3::ZERO);
            if !triangle.is_degenerate() {
                live.push(index as u32);
                bounds = bounds.union(&triangle.bounds());
            }
        }
        Ok(Self { all: triangles.into(), live: live.into(), bounds, extent: bounds.extent().max_element() })
    }

    /// The same triangles, of which only these are live.
    pub(crate) fn with_live(&self, live: Vec<u32>) -> Self {
        let bounds = live.iter().fold(Aabb::EMPTY, |all, &i| all.union(&self.get(i).bounds()));
        Self { all: self.all.clone(), live: live.into(), bounds, extent: self.extent }
    }

    /// The triangle of this index, degenerate or not.
    ///
    /// # Panics
    /// If `index` is not below [`Triangles::len`].
    #[inline]
    pub fn get(&self, index: u32) -> &Triangle {
        &self.all[index as usize]
    }

    /// Asks for the cache line where triangle `index` begins.
    #[inline(always)]
    pub(crate) fn prefetch(&self, index: u32) {
        prefetch_index(&*self.all, index as usize);
    }

    /// The point `(1 - u - v) * v0 + u * v1 + v * v2` of triangle `index`, with its normal and error bound. Both are NaN
    /// for a [degenerate](Triangle::is_degenerate) triangle whose [normal](Triangle::normal) is NaN.
    ///
    /// # Panics
    /// If `index` is not below [`Triangles::len`].
    #[inline(always)]
    pub fn surface_point(&self, index: u32, u: f64, v: f64) -> SurfacePoint {
        self.surface_point_with_normal(index, self.get(index).normal(), u, v)
    }

    /// [`Triangles::surface_point`] with a precomputed [`normal`](Triangle::normal) of triangle `index`,
    /// which is most of the work.
    ///
    /// # Panics
    /// If `index` is not below [`Triangles::len`].
    #[inline(always)]
    pub fn surface_point_with_normal(&self, index: u32, normal: DVec3, u: f64, v: f64) -> SurfacePoint {
        SurfacePoint::on(self.get(index), index, normal, [u, v], self.extent)
    }

    /// The point that stands for `position`, which was not computed from a triangle, as a receiver of what comes from
    /// the side of its unit `normal`: on a surface or on none.
    ///
    /// It is `position`, lifted along `normal` by a little more than `2^-22 (|n_x| X + |n_y| Y + |n_z| Z)`, where `X`,
    /// `Y` and `Z` are the largest magnitudes of coordinates of the triangles and of `position`. So a ray spawned from
    /// it to the side of `normal` does not hit a surface perpendicular to `normal` on which `position` lies, nor one
    /// below which it lies by at most that: less than coordinates in `f32` tell. A position known less well must be
    /// lifted by its error before.
    pub fn given_point(&self, position: DVec3, normal: DVec3) -> SurfacePoint {
        let Aabb { min, max } = self.bounds;
        let scene = if self.live.is_empty() { DVec3::ZERO } else { min.abs().max(max.abs()).as_dvec3() };
        SurfacePoint::given(position, normal, scene.max(position.abs()), self.extent)
    }

    /// All triangles in input order, degenerate ones included.
    pub fn as_slice(&self) -> &[Triangle] {
        &self.all
    }

    /// The indices, ascending, of the triangles that are not degenerate.
    pub fn live(&self) -> &[u32] {
        &self.live
    }

    /// The number of triangles, degenerate ones included.
    pub fn len(&self) -> usize {
        self.all.len()
    }

    /// Whether there are no triangles, degenerate ones included.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// The number of degenerate triangles.
    pub fn degenerate_count(&self) -> usize {
        self.all.len() - self.live.len()
    }

    /// The bounds of the live triangles; empty if there are none.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Memory in bytes, counted in full for each clone that shares it.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.all) + size_of_val(&*self.live)
    }
}

/// Counts and bounds, not the triangles.
impl fmt::Debug for Triangles {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Triangles")
            .field("len", &self.len())
            .field("degenerate", &self.degenerate_count())
            .field("bounds", &self.bounds)
            .field("bytes", &self.bytes())
            .finish_non_exhaustive()
    }
}

fn check_count(count: usize) -> Result<(), GeomError> {
    let limit = Triangles::MAX_COUNT;
    if count > limit { Err(GeomError::TooMany { count, limit }) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_must_fit() {
        assert!(check_count(Triangles::MAX_COUNT).is_ok());
        let count = Triangles::MAX_COUNT + 1;
        assert_eq!(check_count(count), Err(GeomError::TooMany { count, limit: count - 1 }));
    }
}
