//! The suite that every accelerator must pass, for those who write their own.
//!
//! One call builds the accelerator over many small, nasty scenes and compares each answer, bit
//! for bit, with an oracle that was written on its own. Random rays at random triangles find nothing: rays
//! must be aimed at edges and vertices, snapped to axes, laid into planes, and started on surfaces. [`cases`]
//! holds hard cases by name, [`Regime`] makes scenes and rays at random from six families, [`leaks`] shoots at
//! the edges and vertices of closed [`shapes`] from within.
//!
//! # What an accelerator does
//!
//! [`Accel`](crate::Accel) states what the answers are. This is how to give them:
//!
//! - **Decide** each candidate by [`Shear::decide`](crate::decide::Shear::decide) and by nothing else: its `t`,
//!   `u` and `v` are the answer, to the bit. [`Shear::new`](crate::decide::Shear::new) returns `None` for a ray
//!   that hits nothing, whatever the scene.
//! - **Offer** only triangles that are [`live`](crate::Triangles::live). A hit counts if `t_min < t < t_max`; the one of
//!   smallest `t` wins, of equals the one of smallest index. So what begins at the best `t` so far is still
//!   visited, and only what begins beyond it is not.
//! - **Prune** with boxes, slabs or cells that are widened by [`Ray::pruning_slack`](crate::Ray::pruning_slack),
//!   given the bounds of all triangles. The computed `t` of a hit names a point within `24 u reach` of the
//!   triangle, not on it; without slack an accelerator loses hits that brute force finds. The bound needs the
//!   edge functions of `Shear`, which are never wrong in sign (Kahan's difference of products; Jeannerod, Louvet
//!   and Muller, "Further analysis of Kahan's algorithm", 2013) after the projection of Woop, Benthin and Wald,
//!   "Watertight Ray/Triangle Intersection" (JCGT 2(1), 2013); docs/numerics.md of the repository proves it.
//! - **Mind** direction components that are zero, of either sign: a quotient of two zeros is not a number, and
//!   no comparison with it may discard anything.
//! - **Answer** `occluded` as `intersect(ray).is_some()`, and batches as their rays alone; without panicking, and
//!   without an allocation beyond the output.
//!
//! An accelerator that does this and no more, and the same without slack, which is found out:
//!
//! ```
//! use globillum_geom::conformance::{Suite, Violation};
//! use globillum_geom::decide::Shear;
//! use globillum_geom::{Aabb, Accel, Hit, Ray, Triangles};
//!
//! /// Every triangle in its own box.
//! #[derive(Debug)]
//! struct Boxes {
//!     triangles: Triangles,
//!     /// 1, but to show what becomes of hits without slack.
//!     slack: f64,
//! }
//!
//! /// Whether the ray may have a hit in the widened box at `t_end` or before.
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
//!             if !admits(ray, &triangle.bounds(), slack, t_end) {
//!                 continue;
//!             }
//!             let Some(met) = shear.decide(triangle) else { continue };
//!             let in_range = ray.t_min < met.t && met.t < ray.t_max;
//!             // Indices ascend: of equal distances the first stays.
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
//! triangles or walk a grid have more to mind; docs/numerics.md derives it for those of this crate.

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
