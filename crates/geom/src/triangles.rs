use crate::{Aabb, GeomError, SurfacePoint, Triangle};
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// Triangles that have been checked, the only thing an accelerator is built from.
///
/// Indices are those of the input. Degenerate triangles (all three vertices on a line) keep
/// their index but are never hit: they are not [`live`](Triangles::live). Cloning is cheap; the
/// triangles are shared.
#[derive(Clone, Debug)]
pub struct Triangles {
    all: Arc<[Triangle]>,
    live: Arc<[u32]>,
    bounds: Aabb,
    /// The longest side of `bounds`.
    extent: f64,
}

impl Triangles {
    /// [`Triangle::MAX_COORDINATE`].
    pub const MAX_COORDINATE: f32 = Triangle::MAX_COORDINATE;

    /// The largest number of triangles: `2^30 - 1`, so that a triangle, a coordinate and two bits
    /// more fit into 64 bits.
    pub const MAX_COUNT: usize = (1 << 30) - 1;

    /// Checks `triangles` and takes them.
    ///
    /// # Errors
    /// [`GeomError::NonFinite`] or [`GeomError::Domain`] for the first bad coordinate,
    /// [`GeomError::TooMany`] beyond [`Triangles::MAX_COUNT`].
    pub fn new(mut triangles: Vec<Triangle>) -> Result<Self, GeomError> {
        check_count(triangles.len())?;
        let mut live = Vec::with_capacity(triangles.len());
        let mut bounds = Aabb::EMPTY;
        for (index, triangle) in triangles.iter_mut().enumerate() {
            triangle.validate(index)?;
            // A negative zero would show in the sign of a zero `t`.
            triangle.vertices = triangle.vertices.map(|v| v + Vec3::ZERO);
            if !triangle.is_degenerate() {
                live.push(index as u32);
                bounds = bounds.union(&triangle.bounds());
            }
        }
        Ok(Self { all: triangles.into(), live: live.into(), bounds, extent: bounds.extent().max_element() })
    }

    /// The triangle of that index, degenerate or not.
    ///
    /// # Panics
    /// If `index` is not below [`Triangles::len`].
    #[inline]
    pub fn get(&self, index: u32) -> &Triangle {
        &self.all[index as usize]
    }

    /// The point `(1 - u - v) * v0 + u * v1 + v * v2` of the triangle of that index, with what is
    /// needed to leave it.
    ///
    /// # Panics
    /// If `index` is not below [`Triangles::len`].
    #[inline(always)]
    pub fn surface_point(&self, index: u32, u: f64, v: f64) -> SurfacePoint {
        self.surface_point_with_normal(index, self.get(index).normal(), u, v)
    }

    /// The same, for those who keep the [`normal`](Triangle::normal) of triangle `index`: finding it is most
    /// of the work.
    ///
    /// # Panics
    /// If `index` is not below [`Triangles::len`].
    #[inline(always)]
    pub fn surface_point_with_normal(&self, index: u32, normal: DVec3, u: f64, v: f64) -> SurfacePoint {
        SurfacePoint::on(self.get(index), normal, u, v, self.extent)
    }

    /// All triangles in input order, degenerate ones included.
    pub fn as_slice(&self) -> &[Triangle] {
        &self.all
    }

    /// Indices, ascending, of the triangles that can be hit.
    pub fn live(&self) -> &[u32] {
        &self.live
    }

    /// How many there are, degenerate ones included.
    pub fn len(&self) -> usize {
        self.all.len()
    }

    /// Whether there are none at all.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// How many were found degenerate and cannot be hit.
    pub fn degenerate_count(&self) -> usize {
        self.all.len() - self.live.len()
    }

    /// The smallest box around the live triangles; empty if there are none.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Bytes that the triangles occupy, whoever shares them.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.all) + size_of_val(&*self.live)
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
