//! What is often wrong with the lights of a scene.

use glam::{DVec2, DVec3, Vec3Swizzles};
use globillum_geom::{Aabb, Triangle};
use globillum_integrator::Model;
use std::collections::HashMap;

/// Planes are told apart to this share of the scene's size, and of a turn.
const RESOLUTION: f64 = 1e-6;

/// Pairs of triangles that are compared for each triangle of the scene, on average, before the
/// search is given up: a warning is not worth an hour.
const PAIRS_PER_TRIANGLE: usize = 16;

/// The triangles that emit light.
pub(crate) fn all(model: &Model) -> Vec<usize> {
    if model.materials().iter().all(|material| material.emission.is_none()) {
        return Vec::new();
    }
    let emitting = (0..model.triangles().len()).filter(|&index| !model.material(index).emission.is_none());
    let mut all = Vec::with_capacity(emitting.clone().count());
    all.extend(emitting);
    all
}

/// How many of the `emitting` triangles overlap another triangle in their own plane.
pub(crate) fn coplanar(model: &Model, emitting: &[usize]) -> usize {
    let bounds = Aabb::around(model.triangles().iter().flat_map(|t| t.vertices));
    let middle = (bounds.min.as_dvec3() + bounds.max.as_dvec3()) / 2.0;
    let planes = Planes { middle, size: bounds.extent().max_element() };
    let mut lights: HashMap<_, Vec<usize>> = HashMap::new();
    for &index in emitting {
        lights.entry(planes.key(&model.triangles()[index])).or_default().push(index);
    }
    let mut pairs_left = PAIRS_PER_TRIANGLE * model.triangles().len();
    let mut count = 0;
    for (index, triangle) in model.triangles().iter().enumerate() {
        let Some(neighbours) = lights.get_mut(&planes.key(triangle)) else { continue };
        neighbours.retain(|&light| {
            pairs_left = pairs_left.saturating_sub(1);
            let found = light != index && pairs_left > 0 && overlap(&model.triangles()[light], triangle);
            count += usize::from(found);
            !found
        });
    }
    count
}

/// Names the plane of a triangle, the same for all triangles in it whichever way they face.
struct Planes {
    middle: DVec3,
    size: f64,
}

impl Planes {
    fn key(&self, triangle: &Triangle) -> [i64; 4] {
        let normal = normal(triangle);
        let first = normal.to_array().into_iter().find(|x| x.abs() > RESOLUTION).unwrap_or(1.0);
        let normal = normal * first.signum();
        let offset = (triangle.vertices[0].as_dvec3() - self.middle).dot(normal) / self.size;
        [normal.x, normal.y, normal.z, offset].map(|x| (x / RESOLUTION).round() as i64)
    }
}

fn normal(triangle: &Triangle) -> DVec3 {
    let [a, b, c] = triangle.vertices.map(|v| v.as_dvec3());
    (b - a).normalize_or_zero().cross((c - a).normalize_or_zero()).normalize_or_zero()
}

/// Whether two triangles of one plane share more than an edge: no edge of either separates them.
fn overlap(a: &Triangle, b: &Triangle) -> bool {
    let normal = normal(a).abs();
    // Seen along the axis that the plane faces most, nothing collapses.
    let flat = |t: &Triangle| {
        t.vertices.map(|v| v.as_dvec3()).map(|v| {
            if normal.x >= normal.y && normal.x >= normal.z {
                v.yz()
            } else if normal.y >= normal.z {
                v.xz()
            } else {
                v.xy()
            }
        })
    };
    let (a, b) = (flat(a), flat(b));
    !separated(a, b) && !separated(b, a)
}

/// Whether `b` lies beyond one of the edges of `a`, or on it.
fn separated(a: [DVec2; 3], b: [DVec2; 3]) -> bool {
    let turn = (a[1] - a[0]).perp_dot(a[2] - a[0]).signum();
    (0..3).any(|i| {
        let edge = a[(i + 1) % 3] - a[i];
        b.iter().all(|&p| {
            let side = turn * edge.perp_dot(p - a[i]);
            side <= RESOLUTION * edge.length() * (p - a[i]).length()
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use globillum_material::{Material, Rgb};

    fn square(x: f32, y: f32, half: f32) -> [Triangle; 2] {
        let p = |dx: f32, dz: f32| Vec3::new(x + dx * half, y, dz * half);
        let [a, b, c, d] = [p(-1.0, -1.0), p(1.0, -1.0), p(1.0, 1.0), p(-1.0, 1.0)];
        [Triangle::new(a, b, c), Triangle::new(a, c, d)]
    }

    fn found(light: [Triangle; 2]) -> usize {
        let mut model = Model::default();
        model.add(Material::lambert(Rgb::splat(0.5)).unwrap(), square(0.0, 1.0, 1.0));
        model.add(Material::lambert(Rgb::splat(0.5)).unwrap(), square(0.0, -1.0, 1.0));
        model.add(Material::light(Rgb::WHITE).unwrap(), light);
        coplanar(&model, &all(&model))
    }

    #[test]
    fn a_light_in_the_ceilings_plane_is_found() {
        assert_eq!(found(square(0.1, 1.0, 0.3)), 2);
    }

    #[test]
    fn a_light_below_the_ceiling_or_beside_it_is_fine() {
        assert_eq!(found(square(0.1, 0.995, 0.3)), 0);
        assert_eq!(found(square(2.0, 1.0, 1.0)), 0);
    }
}
