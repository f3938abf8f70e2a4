//! From sums and Student's t to standard normal deviates, and from these to probabilities.

/// Standard normal deviate of a value `t` of Student's distribution with `dof` degrees of freedom (Hill 1970,
/// "Algorithm 395: Student's t-distribution").
///
/// For deviates up to 3.3, off by less than 0.02 from two degrees of freedom on, and by less than 0.005 from three.
pub(super) fn of_student(t: f64, dof: f64) -> f64 {
    let a = dof - 0.5;
    let b = 48.0 * a * a;
    let y = a * (t * t / dof).ln_1p();
    let correction = (((-0.4 * y - 3.3) * y - 24.0) * y - 85.5) / (0.8 * y * y + 100.0 + b);
    (((correction + y + 3.0) / b + 1.0) * y.sqrt()).copysign(t)
}

/// A sum of independent terms of mean 0 over the root of the sum of their squares: a standard normal deviate if no
/// few terms outweigh the others, whatever their variances. 0 if all terms are.
///
/// Given the terms' sizes, its variance is exactly 1 if their signs are as likely either way.
pub(super) fn of_sum(terms: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut squares) = (0.0, 0.0);
    for term in terms {
        sum += term;
        squares += term * term;
    }
    if squares == 0.0 { 0.0 } else { sum / f64::sqrt(squares) }
}

/// The probability that a standard normal deviate is above `z`.
pub(super) fn above(z: f64) -> f64 {
    0.5 * libm::erfc(z / std::f64::consts::SQRT_2)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Student's quantiles of 97.5 % and 99.95 %, from tables.
    #[test]
    fn quantiles_of_student_are_those_of_the_normal_distribution() {
        for (dof, t, extreme, bound) in [
            (2.0, 4.303, 31.599, 0.02),
            (3.0, 3.182, 12.924, 0.005),
            (6.0, 2.447, 5.959, 0.005),
            (30.0, 2.042, 3.646, 0.005),
        ] {
            assert!((of_student(t, dof) - 1.960).abs() < bound, "{dof}: {}", of_student(t, dof));
            assert!((of_student(-extreme, dof) + 3.291).abs() < bound, "{dof}: {}", of_student(extreme, dof));
        }
    }

    #[test]
    fn probabilities_are_those_of_tables() {
        for (z, p) in [(0.0, 0.5), (1.959_964, 0.025), (3.090_232, 0.001)] {
            assert!((above(z) / p - 1.0).abs() < 1e-5, "{z}");
        }
    }
}
