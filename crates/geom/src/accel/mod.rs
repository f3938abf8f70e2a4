//! Accelerators: the [contract](Accel), and those of this crate. [`BruteForce`] is the oracle of the others.

mod brute;
mod by_query;
mod counts;
mod grid;
mod kdtree;
mod prim_ref;
mod prune;
mod query;
mod wide;

pub use brute::BruteForce;
pub use counts::{Counts, QueryCounter, Traverse};
pub use grid::{GridOptions, UniformGrid};
pub use kdtree::{KdOptions, KdStats, KdTree, SplitRule};
pub use wide::WideBvh;

use crate::{Aabb, Hit, Ray};
use std::fmt::Debug;

/// An accelerator: a structure over triangles that answers closest-hit and any-hit queries.
///
/// # Contract
/// Every implementation gives the same answers, to the bit. The conformance suite of this crate, the module
/// `conformance` behind the feature of that name, checks it. The module's documentation says how to write an
/// accelerator; `cargo doc -p globillum-geom --features conformance --open` shows it.
///
/// 1. A hit is reported iff `t_min < t < t_max`, both strict, with `t` as
///    [`decide::Shear::decide`](crate::decide::Shear::decide) computes it, and the ray does not
///    [exclude](Ray::excludes) the triangle. `occluded(r)` is `intersect(r).is_some()`, always.
/// 2. Among equal `t` the smallest triangle index wins.
/// 3. A ray that is not [traceable](Ray::is_traceable) hits nothing. `-0.0` acts as `+0.0`.
/// 4. Scaling a direction by `2^k` scales `t` by exactly `2^-k`, as long as it stays within
///    [`Ray::DIRECTION_DOMAIN`] and no component or `t` leaves the normal range of `f64`.
/// 5. Degenerate triangles are never hit; a structure over no triangles hits nothing.
/// 6. Queries do not panic. Besides their output they allocate only working memory that the calling thread keeps
///    for later queries: none, or with a [`WideBvh`](crate::WideBvh) about 0.7 MB and up to 8 bytes for every 64
///    rays of its largest batch.
/// 7. A batch method leaves exactly one entry per ray in its output, whatever the output held before.
///    `bounds` returns exactly the bounds of the live triangles.
///
/// Batches are faster than single rays, above all with a [`WideBvh`](crate::WideBvh). By default both batch methods trace
/// single rays, so a structure that wraps another one should forward them too:
///
/// ```
/// use glam::{DVec3, Vec3};
/// use globillum_geom::{Accel, Ray, Triangle, Triangles, WideBvh};
///
/// let triangles = Triangles::new(vec![Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y)])?;
/// let tree = WideBvh::build(&triangles)?;
/// let down = |x, y| Ray::new(DVec3::new(x, y, 2.0), -DVec3::Z);
/// let mut hits = Vec::new(); // reusable
/// tree.intersect_batch(&[down(0.2, 0.2), down(0.9, 0.9)], &mut hits);
/// assert_eq!((hits[0].map(|hit| hit.t), hits[1]), (Some(2.0), None));
/// # Ok::<(), globillum_geom::GeomError>(())
/// ```
pub trait Accel: Debug + Send + Sync {
    /// The hit of smallest `t` in the ray's range, of equal `t` that of the smallest triangle index; `None`
    /// if the range contains no hit.
    fn intersect(&self, ray: &Ray) -> Option<Hit>;

    /// Whether the ray's range contains any hit.
    fn occluded(&self, ray: &Ray) -> bool;

    /// [`intersect`](Accel::intersect) for many rays: clears `hits`, then stores one entry per ray, in order.
    fn intersect_batch(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
        hits.clear();
        hits.extend(rays.iter().map(|ray| self.intersect(ray)));
    }

    /// [`occluded`](Accel::occluded) for many rays: clears `occluded`, then stores one entry per ray, in
    /// order.
    fn occluded_batch(&self, rays: &[Ray], occluded: &mut Vec<bool>) {
        occluded.clear();
        occluded.extend(rays.iter().map(|ray| self.occluded(ray)));
    }

    /// The bounds of all live triangles; empty if there are none.
    fn bounds(&self) -> Aabb;

    /// Memory in bytes, including the triangles, which may be shared.
    fn bytes(&self) -> usize;
}

/// Implements [`Accel`] for a pointer by forwarding every method.
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
