//! The floor under a square light, a picture with a closed form for every pixel.

use super::errors::Truth;
use globillum::glam::DVec3;
use globillum::integrator::PinholeCamera;
use globillum::material::Rgb;
use globillum_testkit::form_factor::corner;

/// The radiance at `(x, z)` of the floor under a square light: four rectangles with a corner above the point
/// (`scenes::light_over_floor` is the scene).
fn radiance(x: f64, z: f64) -> f64 {
    let factor = corner(1.0 - x, 1.0 - z)
        + corner(1.0 + x, 1.0 - z)
        + corner(1.0 - x, 1.0 + z)
        + corner(1.0 + x, 1.0 + z);
    0.5 * factor
}

/// A camera under the light. A picture that is at most as wide as high shows only floor, from its middle
/// nearly to its edge.
pub(super) fn camera() -> PinholeCamera {
    let (eye, target) = (DVec3::new(0.2, 0.9, 0.45), DVec3::new(0.15, 0.0, 0.2));
    PinholeCamera::look_at(eye, target, DVec3::Y, 0.7).expect("eye and target are apart")
}

/// The exact picture of [`camera`] with `side` pixels along each side: the mean over each pixel by quadrature.
/// From eight pixels per side on, the error is below 1e-9.
pub(super) fn picture(side: u32) -> Truth {
    let camera = camera();
    let pixels = (0..side).flat_map(|y| (0..side).map(move |x| (x, y)));
    Truth::exact(pixels.map(|(x, y)| Rgb::splat(pixel(&camera, side, x, y))).collect())
}

/// The mean over a pixel, by the tensor product of Gauss quadrature with four nodes.
fn pixel(camera: &PinholeCamera, side: u32, x: u32, y: u32) -> f64 {
    const NODES: [(f64, f64); 4] = [
        (-0.861_136_311_594_052_6, 0.347_854_845_137_453_86),
        (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
        (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
        (0.861_136_311_594_052_6, 0.347_854_845_137_453_86),
    ];
    let on_film = |pixel: u32, node: f64| 2.0 * (f64::from(pixel) + 0.5 + 0.5 * node) / f64::from(side) - 1.0;
    let mut mean = 0.0;
    for (v, weight_v) in NODES {
        for (u, weight_u) in NODES {
            let ray = camera.ray(on_film(x, u), -on_film(y, v), 1.0);
            let point = ray.origin + ray.direction * (-ray.origin.y / ray.direction.y);
            mean += 0.25 * weight_u * weight_v * radiance(point.x, point.z);
        }
    }
    mean
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_the_floor_has_the_tabulated_value() {
        assert!((radiance(0.0, 0.0) - 0.277_063_212).abs() < 1e-9);
    }

    #[test]
    fn the_camera_sees_nothing_but_floor() {
        for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
            let ray = camera().ray(x, y, 1.0);
            let point = ray.origin + ray.direction * (-ray.origin.y / ray.direction.y);
            assert!(ray.direction.y < 0.0 && point.abs().max_element() < 0.95, "{point}");
        }
    }

    /// The mean of sixteen fine pixels is the coarse pixel.
    #[test]
    fn quadrature_over_pixels_agrees_with_finer_pixels() {
        let (coarse, fine) = (picture(8), picture(32));
        for (i, &mean) in coarse.means().iter().enumerate() {
            let (x, y) = (i % 8, i / 8);
            let parts = (0..16).map(|j| fine.means()[(4 * y + j / 4) * 32 + 4 * x + j % 4].g);
            assert!((parts.sum::<f64>() / 16.0 - mean.g).abs() < 1e-9, "pixel ({x}, {y})");
        }
    }
}
