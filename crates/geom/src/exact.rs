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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// For integers of up to 53 bits, `i128` holds the exact difference.
        #[test]
        fn a_difference_of_products_is_within_a_rounding_and_a_half(
            a in -(1i64 << 53)..1i64 << 53, b in -(1i64 << 53)..1i64 << 53,
            da in -3i64..=3, db in -3i64..=3,
        ) {
            let clamp = |x: i64| x.clamp(-(1 << 53), 1 << 53);
            let (c, d) = (clamp(a + da), clamp(b + db));
            let exact = i128::from(a) * i128::from(b) - i128::from(c) * i128::from(d);
            let got = difference_of_products(a as f64, b as f64, c as f64, d as f64);
            prop_assert_eq!(exact.signum() as f64, if got == 0.0 { 0.0 } else { got.signum() });
            prop_assert!((got - exact as f64).abs() <= 2.0 * f64::EPSILON * (exact as f64).abs());
        }
    }
}
