//! Checks of a complete scene for common mistakes with its lights.

use crate::WarningKind;
use glam::{DVec2, DVec3, Vec3Swizzles};
use globillum_geom::{Aabb, Triangle};
use globillum_integrator::Model;
use std::collections::HashMap;

/// The resolution of planes: of an offset relative to the scene's size, and of a component of a normal.
const RESOLUTION: f64 = 1e-6;

/// The average number of pairs that are compared for each triangle of the scene. The check ends there, so that
/// it takes linear time.
const PAIRS_PER_TRIANGLE: usize = 16;

/// A warning if the scene has no lights, or if lights overlap another triangle in their plane.
pub(crate) fn check_lights(model: &Model) -> Option<WarningKind> {
    let lights = lights(model);
    if lights.is_empty() {
        return model.delta_lights().is_empty().then_some(WarningKind::NoLight);
    }
    let count = coplanar(model, &lights);
    (count > 0).then_some(WarningKind::CoplanarLights { count })
}

/// The indices of the lights.
fn lights(model: &Model) -> Vec<usize> {
    if model.materials().iter().all(|material| material.emission.is_black()) {
        return Vec::new();
    }
    let emitting = (0..model.triangles().len()).filter(|&index| !model.material(index).emission.is_black());
    let mut all = Vec::with_capacity(emitting.clone().count());
    all.extend(emitting);
    all
}

/// The number of `lights` that overlap another triangle in their plane.
fn coplanar(model: &Model, lights: &[usize]) -> usize {
    let bounds = Aabb::around(model.triangles().iter().flat_map(|t| t.vertices));
    let middle = bounds.center();
    let planes = Planes { middle, size: bounds.extent().max_element() };
    let mut by_plane: HashMap<_, Vec<usize>> = HashMap::new();
    for &index in lights {
        by_plane.entry(planes.key(&model.triangles()[index])).or_default().push(index);
    }
    let mut pairs_left = PAIRS_PER_TRIANGLE * model.triangles().len();
    let mut count = 0;
    for (index, triangle) in model.triangles().iter().enumerate() {
        if pairs_left == 0 {
            break;
        }
        let Some(neighbours) = by_plane.get_mut(&planes.key(triangle)) else { continue };
        neighbours.retain(|&light| {
            pairs_left = pairs_left.saturating_sub(1);
            let found = light != index && pairs_left > 0 && overlap(&model.triangles()[light], triangle);
            count += usize::from(found);
            !found
        });
    }
    count
}

/// Maps a triangle to a key of its plane, equal for all triangles in the plane whichever way they face.
struct Planes {
    middle: DVec3,
    size: f64,
}

impl Planes {
    fn key(&self, triangle: &Triangle) -> [i64; 4] {
        let normal = triangle.normal();
        let first = normal.to_array().into_iter().find(|x| x.abs() > RESOLUTION).unwrap_or(1.0);
        let normal = normal * first.signum();
        let offset = (triangle.vertices[0].as_dvec3() - self.middle).dot(normal) / self.size;
        [normal.x, normal.y, normal.z, offset].map(|x| (x / RESOLUTION).round() as i64)
    }
}

/// Whether two coplanar triangles overlap in more than an edge: no edge of either separates them.
fn overlap(a: &Triangle, b: &Triangle) -> bool {
    let normal = a.normal().abs();
    // The projection along the normal's largest component is not degenerate.
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

/// Whether `b` lies outside one of the edges of `a` or on it.
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
