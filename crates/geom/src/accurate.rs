//! Accurate differences of products, the arithmetic of [`decide`](crate::decide).

use glam::DVec3;

/// `a * b - c * d` within 1.5 ulp: Kahan's algorithm (error bound: Jeannerod, Louvet and Muller, Mathematics
/// of Computation 82, 2013).
///
/// The sign is correct or zero, even if products underflow: the result is `fl(fl(ab - w) + fl(w - cd))` with
/// `w = fl(cd)`, and rounding is monotone and odd. Without underflow it is zero only if the exact difference
/// is.
#[inline(always)]
pub(crate) fn difference_of_products(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let cd = c * d;
    let cd_err = (-c).mul_add(d, cd);
    let difference = a.mul_add(b, -cd);
    difference + cd_err
}

/// The cross product, each component within 1.5 ulp.
#[inline(always)]
pub(crate) fn cross(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::new(
        difference_of_products(a.y, b.z, a.z, b.y),
        difference_of_products(a.z, b.x, a.x, b.z),
        difference_of_products(a.x, b.y, a.y, b.x),
    )
}
