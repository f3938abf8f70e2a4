//! What is checked of an accelerator, which may be one of the user's: that it is over the triangles of the scene, and that
//! batches have an answer for each ray. Too few or too many would be taken for those of other rays.

use globillum_geom::{Accel, Hit, Ray, Triangles};

/// Whether the accelerator has the bounds of these triangles. All empty boxes are equal.
pub(crate) fn is_over(accel: &(impl Accel + ?Sized), triangles: &Triangles) -> bool {
    let (of_accel, of_triangles) = (accel.bounds(), triangles.bounds());
    of_accel == of_triangles || of_accel.is_empty() && of_triangles.is_empty()
}

/// The closest hits of `rays`, one for each.
///
/// # Panics
/// If the accelerator stores another number of answers.
pub(crate) fn intersect(accel: &(impl Accel + ?Sized), rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
    accel.intersect_batch(rays, hits);
    check("intersect_batch", hits.len(), rays.len());
}

/// Whether each of `rays` hits anything.
///
/// # Panics
/// If the accelerator stores another number of answers.
pub(crate) fn occluded(accel: &(impl Accel + ?Sized), rays: &[Ray], occluded: &mut Vec<bool>) {
    accel.occluded_batch(rays, occluded);
    check("occluded_batch", occluded.len(), rays.len());
}

fn check(method: &str, answers: usize, rays: usize) {
    assert_eq!(answers, rays, "Accel::{method} stored {answers} answers for {rays} rays");
}
