//! From sums and Student's t to standard normal deviates, and from these to probabilities.

use std::f64::consts::{PI, SQRT_2};

/// From this number of degrees of freedom on, the expansion for deviates is good.
const MANY: f64 = 8.0;

/// Standard normal deviate of a value `t` of Student's distribution with `dof` degrees of freedom, at least 1.
///
/// From 8 degrees of freedom on it is that of Hill (1970, "Algorithm 395: Student's t-distribution"), off by less than
/// 0.001 for deviates up to 7; below, by the probability itself, off by less than 1e-6 for deviates up to 35.
pub(super) fn of_student(t: f64, dof: f64) -> f64 {
    if dof < MANY {
        return quantile_above(student_above(t.abs(), dof)).copysign(t);
    }
    let a = dof - 0.5;
    let b = 48.0 * a * a;
    let y = a * (t * t / dof).ln_1p();
    let correction = (((-0.4 * y - 3.3) * y - 24.0) * y - 85.5) / (0.8 * y * y + 100.0 + b);
    (((correction + y + 3.0) / b + 1.0) * y.sqrt()).copysign(t)
}

/// The probability that a value of Student's distribution is above `t`, which is not negative.
fn student_above(t: f64, dof: f64) -> f64 {
    // Shares of `dof` and the square in their sum; the square may overflow.
    let (rest, part) = (1.0 / (1.0 + t * t / dof), 1.0 / (1.0 + dof / (t * t)));
    let half = 0.5 * dof;
    let ln_beta = libm::lgamma(half) + 0.5 * PI.ln() - libm::lgamma(half + 0.5);
    let scale = (half * rest.ln() + 0.5 * part.ln() - ln_beta).exp();
    if rest < 0.5 {
        scale / dof * beta_series(half, 0.5, rest)
    } else {
        0.5 - scale * beta_series(0.5, half, part)
    }
}

/// The sum that the incomplete beta function is a multiple of (Abramowitz and Stegun 1964, 26.5.4), for `x` up to 1/2.
fn beta_series(a: f64, b: f64, x: f64) -> f64 {
    let (mut sum, mut term, mut n) = (1.0, 1.0, 0.0);
    while term > 1e-17 * sum {
        term *= (a + b + n) / (a + 1.0 + n) * x;
        sum += term;
        n += 1.0;
    }
    sum
}

/// The standard normal deviate that another is above with a probability `p`, in `[0, 0.5]`.
fn quantile_above(p: f64) -> f64 {
    // Abramowitz and Stegun 1964, 26.2.23, off by less than 4.5e-4; two of Newton's steps, in logarithms, do the rest.
    let s = (-2.0 * p.ln()).sqrt();
    let start = s
        - ((0.010_328 * s + 0.802_853) * s + 2.515_517)
            / (((0.001_308 * s + 0.189_269) * s + 1.432_788) * s + 1.0);
    // Beyond, probabilities lose digits and vanish.
    if start.is_nan() || start > 35.0 {
        return s.max(35.0);
    }
    (0..2).fold(start, |z, _| {
        let density = (-0.5 * z * z).exp() / (2.0 * PI).sqrt();
        z + (above(z) / p).ln() * above(z) / density
    })
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
    0.5 * libm::erfc(z / SQRT_2)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed forms of the probability above `t`.
    #[test]
    fn one_and_two_degrees_of_freedom_have_closed_forms() {
        for t in [1e-6, 0.1, 1.0, 1.5, 12.706, 636.6, 1e7] {
            let root = f64::sqrt(2.0 + t * t);
            for (dof, p) in [(1.0, (1.0 / t).atan() / PI), (2.0, 1.0 / (root * (root + t)))] {
                assert!((student_above(t, dof) / p - 1.0).abs() < 1e-12, "{dof}, {t}");
                assert!((above(of_student(t, dof)) / p - 1.0).abs() < 1e-9, "{dof}, {t}");
                assert_eq!(of_student(-t, dof), -of_student(t, dof));
            }
        }
    }

    /// Student's quantiles of 97.5 % and 99.95 %, from tables.
    #[test]
    fn quantiles_of_student_are_those_of_the_normal_distribution() {
        for (dof, t, extreme) in [
            (1.0, 12.7062, 636.619),
            (2.0, 4.30265, 31.5991),
            (3.0, 3.18245, 12.9240),
            (6.0, 2.44691, 5.95882),
            (8.0, 2.30600, 5.04131),
            (30.0, 2.04227, 3.64596),
        ] {
            assert!((of_student(t, dof) - 1.95996).abs() < 2e-4, "{dof}: {}", of_student(t, dof));
            assert!(
                (of_student(-extreme, dof) + 3.29053).abs() < 2e-4,
                "{dof}: {}",
                of_student(extreme, dof)
            );
        }
    }

    #[test]
    fn extreme_values_have_a_deviate() {
        for dof in [1.0, 1.5, 7.9] {
            assert!(of_student(1e-300, dof).abs() < 1e-6, "{dof}");
            assert!(of_student(-1e300, dof) <= -35.0, "{dof}");
        }
        let below = of_student(6.0, MANY - 1e-9);
        assert!((below - of_student(6.0, MANY)).abs() < 1e-3, "{below}");
    }

    #[test]
    fn probabilities_are_those_of_tables() {
        for (z, p) in [(0.0, 0.5), (1.959_964, 0.025), (3.090_232, 0.001)] {
            assert!((above(z) / p - 1.0).abs() < 1e-5, "{z}");
        }
    }
}
