use crate::{Aabb, Hit, Ray};
use std::fmt::Debug;

/// A structure that finds the triangle a ray meets.
///
/// # Contract
/// Every implementation gives the same answers, bit for bit; `globillum-geom`'s conformance
/// suite checks it.
///
/// 1. A hit is reported iff `t_min < t < t_max`, both strict, with `t` as
///    [`decide::Shear::decide`](crate::decide::Shear::decide) computes it. `occluded(r)` is
///    `intersect(r).is_some()`, always.
/// 2. Among equal `t` the smallest triangle index wins.
/// 3. A ray that is not [traceable](Ray::is_traceable) hits nothing. `-0.0` acts as `+0.0`.
/// 4. Scaling a direction by `2^k` scales `t` by exactly `2^-k`, as long as it stays within
///    [`Ray::DIRECTION_DOMAIN`] and no component or `t` leaves the normal range of `f64`.
/// 5. Degenerate triangles are never hit; a structure over no triangles hits nothing.
/// 6. Queries neither panic nor allocate more than their output.
///
/// Many rays at a time are faster than one after the other, above all in a
/// [`WideKdTree`](crate::WideKdTree):
///
/// ```
/// use glam::{DVec3, Vec3};
/// use globillum_geom::{Accel, Ray, Triangle, Triangles, WideKdTree};
///
/// let triangles = Triangles::new(vec![Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y)])?;
/// let tree = WideKdTree::build(&triangles)?;
/// let down = |x, y| Ray::new(DVec3::new(x, y, 2.0), -DVec3::Z);
/// let mut hits = Vec::new(); // can be used again and again
/// tree.intersect_batch(&[down(0.2, 0.2), down(0.9, 0.9)], &mut hits);
/// assert_eq!((hits[0].map(|hit| hit.t), hits[1]), (Some(2.0), None));
/// # Ok::<(), globillum_geom::GeomError>(())
/// ```
pub trait Accel: Debug + Send + Sync {
    /// The closest hit in the ray's range; `None` if there is none.
    fn intersect(&self, ray: &Ray) -> Option<Hit>;

    /// Whether anything is hit in the ray's range.
    fn occluded(&self, ray: &Ray) -> bool;

    /// [`intersect`](Accel::intersect) for many rays: `hits` is cleared, then filled with one
    /// entry a ray, in order.
    fn intersect_batch(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
        hits.clear();
        hits.extend(rays.iter().map(|ray| self.intersect(ray)));
    }

    /// [`occluded`](Accel::occluded) for many rays: `occluded` is cleared, then filled with one
    /// entry a ray, in order.
    fn occluded_batch(&self, rays: &[Ray], occluded: &mut Vec<bool>) {
        occluded.clear();
        occluded.extend(rays.iter().map(|ray| self.occluded(ray)));
    }

    /// The smallest box around everything that can be hit; empty if nothing can.
    fn bounds(&self) -> Aabb;

    /// Bytes of memory held, the triangles included.
    fn bytes(&self) -> usize;
}

/// An accelerator behind a pointer is an accelerator.
macro_rules! forward_accel {
    ($pointer:ty) => {
        impl<A: Accel + ?Sized> Accel for $pointer {
            fn intersect(&self, ray: &Ray) -> Option<Hit> {
                (**self).intersect(ray)
            }
            fn occluded(&self, ray: &Ray) -> bool {
                (**self).occluded(ray)
            }
            fn intersect_batch(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
                (**self).intersect_batch(rays, hits);
            }
            fn occluded_batch(&self, rays: &[Ray], occluded: &mut Vec<bool>) {
                (**self).occluded_batch(rays, occluded);
            }
            fn bounds(&self) -> Aabb {
                (**self).bounds()
            }
            fn bytes(&self) -> usize {
                (**self).bytes()
            }
        }
    };
}

forward_accel!(&A);
forward_accel!(Box<A>);
forward_accel!(std::sync::Arc<A>);
