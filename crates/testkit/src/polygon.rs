//! What part of a point's light comes from polygons, in closed form.

use glam::DVec3;
use globillum_geom::Triangle;
use std::f64::consts::TAU;

/// The form factor from `point`, on a surface of unit normal `normal`, to those of `triangles` that show
/// it their front: the irradiance that they cause at radiance 1, over pi. All of them must lie above the
/// point's horizon, and none hide another.
///
/// Lambert's formula (1760): half the sum over the sides of the angle that each subtends, times the
/// cosine between the normal of its plane with the point and the receiver's.
pub fn form_factor(point: DVec3, normal: DVec3, triangles: &[Triangle]) -> f64 {
    let facing = |t: &&Triangle| t.normal().dot(t.vertices[0].as_dvec3() - point) < 0.0;
    triangles.iter().filter(facing).map(|t| of_one(point, normal, t)).sum()
}

fn of_one(point: DVec3, normal: DVec3, triangle: &Triangle) -> f64 {
    let corners = triangle.vertices.map(|v| v.as_dvec3() - point);
    let side = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        let across = a.cross(b);
        if across == DVec3::ZERO {
            return 0.0;
        }
        across.length().atan2(a.dot(b)) * across.normalize().dot(normal)
    };
    (0..3).map(side).sum::<f64>().abs() / TAU
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::disc;
    use crate::shapes::icosphere;

    /// The form factor of a square light above a floor.
    #[test]
    fn a_rectangle_is_two_triangles() {
        let p = DVec3::new;
        let [a, b] =
            crate::shapes::quad(p(-1.0, 1.0, -1.0), p(1.0, 1.0, -1.0), p(1.0, 1.0, 1.0), p(-1.0, 1.0, 1.0));
        assert!((form_factor(DVec3::ZERO, DVec3::Y, &[a, b]) - 0.554_126_424).abs() < 1e-9);
    }

    /// The error falls by four each time the number of sides doubles.
    #[test]
    fn polygons_converge_to_discs_and_spheres() {
        // On the axis at heights 1 and 2, and at height 1 beside it, by Howell's catalogue.
        let beside: f64 = 0.5 * (1.0 - (1.0 + 4.0 - 1.0) / ((1.0_f64 + 4.0 + 1.0).powi(2) - 16.0).sqrt());
        for (height, offset, truth) in [(1.0, 0.0, 0.5), (2.0, 0.0, 0.2), (1.0, 2.0, beside)] {
            let error = |sides| {
                let point = DVec3::new(offset, 0.0, 0.0);
                form_factor(point, DVec3::Y, &disc(height, sides, true)) - truth
            };
            let ratio = error(64) / error(128);
            assert!(error(128).abs() < 1e-3 && (ratio - 4.0).abs() < 0.05, "{height} {offset}: {ratio}");
        }
        for normal in [DVec3::Y, DVec3::new(0.75_f64.sqrt(), 0.5, 0.0)] {
            let error = |levels| {
                let sphere = icosphere(levels).placed(1.0, DVec3::new(0.0, 3.0, 0.0)).triangles();
                form_factor(DVec3::ZERO, normal, &sphere) - normal.y / 9.0
            };
            let ratio = error(3) / error(4);
            assert!(error(4).abs() < 1e-3 && (ratio - 4.0).abs() < 0.3, "{normal}: {ratio}");
        }
    }
}
