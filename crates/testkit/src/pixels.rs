//! Films compared pixel by pixel.

use crate::stats::Z_LIMIT;
use globillum_integrator::Film;
use globillum_material::Rgb;

/// Largest deviation of a component of a pixel, in standard errors. With 256 passes of each of two pictures, any of all
/// components of 256 pixels exceeds it with a probability of 5e-9 (Student's distribution, as many degrees of freedom).
pub const PIXEL_LIMIT: f64 = 7.2;

/// Asserts that two pictures of independent seeds have the same mean, pixel by pixel ([`PIXEL_LIMIT`]) and as a whole
/// ([`Z_LIMIT`]), and that the difference of whole pictures would show if it were `max_margin` of their mean. Prints the
/// figures.
///
/// # Panics
/// If one does not hold, naming `what`.
#[allow(clippy::print_stdout, reason = "figures for docs/estimators.md, with --nocapture")]
pub fn assert_same_means(what: &str, a: &Film, b: &Film, max_margin: f64) {
    let z = largest_z(a, b);
    let difference = b.image_mean().mean() / a.image_mean().mean() - 1.0;
    // Errors of the sixteen pixels of a group may be fully correlated, which multiplies the error of the mean by up to 4.
    let dependence = |film: &Film| f64::from(film.path_reuse().tile_side()).sqrt();
    let [of_a, of_b] = [a, b].map(|film| dependence(film) * film.error().relative_rmse);
    let pixels = f64::from(a.width()) * f64::from(a.height());
    let margin = Z_LIMIT * of_a.hypot(of_b) / pixels.sqrt();
    let [before, after] = [a, b].map(|film| film.error().relative_rmse);
    println!("{what}: z {z:.2}, error {before:.4} becomes {after:.4}, mean {:+.4} %", 100.0 * difference);
    assert!(z < PIXEL_LIMIT, "{what}: {z}");
    assert!(difference.abs() < margin && margin < max_margin, "{what}: {difference}, margin {margin}");
}

/// Largest difference of a component of a pixel, in standard errors.
pub fn largest_z(a: &Film, b: &Film) -> f64 {
    largest(a, b, |difference, variance| if difference == 0.0 { 0.0 } else { difference / variance.sqrt() })
}

/// Largest difference of a component of a pixel.
pub fn largest_difference(a: &Film, b: &Film) -> f64 {
    largest(a, b, |difference, _| difference)
}

/// The largest of what `size` says of each component of each pixel, by the difference of the means and its variance.
fn largest(a: &Film, b: &Film, size: impl Fn(f64, f64) -> f64) -> f64 {
    let pixels = (0..a.height()).flat_map(|y| (0..a.width()).map(move |x| (x, y)));
    let components = pixels.flat_map(|(x, y)| {
        let difference: Rgb = a.mean(x, y) + b.mean(x, y) * -1.0;
        let variance = a.variance_of_mean(x, y) + b.variance_of_mean(x, y);
        difference.to_array().into_iter().zip(variance.to_array())
    });
    components.map(|(difference, variance)| size(difference.abs(), variance)).fold(0.0, f64::max)
}
