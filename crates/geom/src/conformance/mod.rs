//! A test suite for implementations of [`Accel`](crate::Accel).
//!
//! [`Suite::check`] builds the accelerator over many small, difficult scenes and compares each answer, bit for
//! bit, with an independent [`oracle`]. Uniformly random rays and triangles rarely expose errors. The suite's
//! rays therefore aim at edges and vertices, are parallel to axes, lie within planes of triangles, or start on
//! surfaces. [`cases`] holds named hard cases. [`Regime`] generates scenes and rays of six families at random.
//! [`leaks`] casts rays from inside closed [`shapes`] at their edges and vertices.
//!
//! # Writing an accelerator
//!
//! [`Accel`](crate::Accel) states what an accelerator returns. An implementation follows these rules:
//!
//! - **Decision**: test each candidate triangle with [`Shear::decide`](crate::decide::Shear::decide) only. Its
//!   `t`, `u` and `v` are the answer, to the bit. [`Shear::new`](crate::decide::Shear::new) returns `None` for
//!   a ray that cannot hit anything.
//! - **Candidates**: consider only [`live`](crate::Triangles::live) triangles that the ray does not
//!   [exclude](crate::Ray::excludes). A hit counts if `t_min < t < t_max`. The hit of smallest `t` wins; the smallest index
//!   breaks ties. A node that begins exactly at the closest `t` so far is therefore visited; a node that begins beyond it
//!   is not.
//! - **Pruning**: widen boxes, slabs and cells by [`Ray::pruning_slack`](crate::Ray::pruning_slack), given the
//!   bounds of all triangles. The computed `t` of a hit describes a point within `24 eps reach` of the triangle
//!   (`eps = 2^-53`), not on it. Without slack an accelerator loses hits that brute force finds. The bound relies on the edge
//!   functions of `Shear`, whose signs are exact (Kahan's difference of products; Jeannerod, Louvet and Muller,
//!   "Further analysis of Kahan's algorithm", 2013) after the projection of Woop, Benthin and Wald, "Watertight
//!   Ray/Triangle Intersection" (JCGT 2(1), 2013). docs/numerics.md of the repository contains the proof.
//! - **Zeros**: a direction component can be zero, of either sign. The quotient of two zeros is NaN; a comparison
//!   with NaN must not discard a candidate.
//! - **Other queries**: `occluded` returns `intersect(ray).is_some()`. A batch clears its output and stores the answers of
//!   its rays one by one. `bounds` returns [`Triangles::bounds`](crate::Triangles::bounds). No query panics, or allocates
//!   more than [`Accel`](crate::Accel) allows.
//!
//! The following accelerator follows the rules. Without slack, the suite rejects it:
//!
//! ```
//! use globillum_geom::conformance::{Suite, Violation};
//! use globillum_geom::decide::Shear;
//! use globillum_geom::{Aabb, Accel, Hit, Ray, Triangles};
//!
//! /// Tests the bounding box of every triangle.
//! #[derive(Debug)]
//! struct Boxes {
//!     triangles: Triangles,
//!     /// 1; 0 shows that the suite finds hits that are lost without slack.
//!     slack: f64,
//! }
//!
//! /// Whether the ray can have a hit in the widened box at `t_end` or before.
//! fn admits(ray: &Ray, bounds: &Aabb, slack: f64, t_end: f64) -> bool {
//!     let (mut start, mut end) = (ray.t_min, t_end);
//!     for axis in 0..3 {
//!         let (origin, direction) = (ray.origin[axis], ray.direction[axis]);
//!         let low = f64::from(bounds.min[axis]) - origin - slack;
//!         let high = f64::from(bounds.max[axis]) - origin + slack;
//!         if direction == 0.0 {
//!             if low > 0.0 || high < 0.0 {
//!                 return false;
//!             }
//!             continue;
//!         }
//!         let (near, far) = if direction > 0.0 { (low, high) } else { (high, low) };
//!         start = start.max(near / direction);
//!         end = end.min(far / direction);
//!     }
//!     start <= end
//! }
//!
//! impl Accel for Boxes {
//!     fn intersect(&self, ray: &Ray) -> Option<Hit> {
//!         let shear = Shear::new(ray)?;
//!         let slack = self.slack * ray.pruning_slack(&self.bounds());
//!         let mut best: Option<Hit> = None;
//!         for &index in self.triangles.live() {
//!             let triangle = self.triangles.get(index);
//!             let t_end = best.map_or(ray.t_max, |hit| hit.t);
//!             if ray.excludes(index) || !admits(ray, &triangle.bounds(), slack, t_end) {
//!                 continue;
//!             }
//!             let Some(met) = shear.decide(triangle) else { continue };
//!             let in_range = ray.t_min < met.t && met.t < ray.t_max;
//!             // Indices ascend: the first of equal distances stays.
//!             if in_range && best.is_none_or(|hit| met.t < hit.t) {
//!                 best = Some(Hit { t: met.t, u: met.u, v: met.v, triangle: index });
//!             }
//!         }
//!         best
//!     }
//!
//!     fn occluded(&self, ray: &Ray) -> bool {
//!         self.intersect(ray).is_some()
//!     }
//!
//!     fn bounds(&self) -> Aabb {
//!         self.triangles.bounds()
//!     }
//!
//!     fn bytes(&self) -> usize {
//!         self.triangles.bytes()
//!     }
//! }
//!
//! let suite = Suite { rays: 10_000, ..Suite::default() };
//! suite.check(|triangles| Ok(Boxes { triangles: triangles.clone(), slack: 1.0 }))?;
//! let violation = suite.check(|triangles| Ok(Boxes { triangles: triangles.clone(), slack: 0.0 }));
//! assert!(violation.is_err());
//! # Ok::<(), Violation>(())
//! ```
//!
//! A [`Violation`] names the case, the scene and the ray. Structures that list a triangle in several cells, clip
//! triangles or traverse a grid need further care; docs/numerics.md derives it for the structures of this crate.

mod aim;
pub mod cases;
mod compare;
mod leaks;
pub mod oracle;
mod regime;
mod source;
mod suite;

#[doc(no_inline)]
pub use crate::shapes;
pub use compare::{Tally, Violation, compare};
pub use leaks::{Target, leaks};
pub use regime::Regime;
pub use source::{Seeded, Source};
pub use suite::{Suite, check_bytes};
