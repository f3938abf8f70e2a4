//! Films compared pixel by pixel.

use globillum_integrator::Film;
use globillum_material::Rgb;

/// Largest deviation of a component of a pixel, in standard errors. With 256 passes of each of two pictures, any of all
/// components of 256 pixels exceeds it with a probability of 5e-9 (Student's distribution, as many degrees of freedom).
pub const PIXEL_LIMIT: f64 = 7.2;

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
