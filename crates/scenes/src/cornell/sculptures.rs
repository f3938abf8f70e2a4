//! Two closed meshes with any number of triangles: a trefoil knot and a pine cone.

use glam::DVec3;
use globillum_geom::Triangle;
use libm::{cos, log, pow, sin, sincos, tan};
use std::f64::consts::{PI, TAU};

/// A twisted ribbon tied into a trefoil knot that stands upright: a closed mesh of about `triangles`
/// triangles, at least 18, that face outward.
pub fn knot(triangles: usize) -> Vec<Triangle> {
    // Six times as long as it is wide around, so six times as many cuts that way.
    let across = ((triangles as f64 / 12.0).sqrt() as usize).max(3);
    let around = (triangles / (2 * across)).max(3);
    let core = |u: f64| {
        let radius = 2.0 + cos(3.0 * u);
        DVec3::new(radius * sin(2.0 * u), radius * cos(2.0 * u), 1.3 * sin(3.0 * u))
    };
    let point = |i: usize, j: usize| {
        let [u, v] = [(i, around), (j, across)].map(|(k, n)| TAU * k as f64 / n as f64);
        let tangent = (core(u + 1e-4) - core(u - 1e-4)).normalize();
        let side = tangent.cross(DVec3::Z).normalize();
        let up = side.cross(tangent);
        let (twist_sin, twist_cos) = sincos(3.0 * u);
        let (wide, narrow) = (0.7 * rounded(cos(v)), 0.26 * rounded(sin(v)));
        let (a, b) = (wide * twist_cos - narrow * twist_sin, wide * twist_sin + narrow * twist_cos);
        core(u) + side * a + up * b
    };
    sheet(around, across, &point)
}

/// One coordinate of a circle, drawn towards the square around it: a superellipse of exponent 3.
fn rounded(x: f64) -> f64 {
    x.signum() * pow(x.abs(), 2.0 / 3.0)
}

/// A pine cone with scales along spirals, smaller towards both ends: a closed mesh of about `triangles`
/// triangles, at least 24, that face outward.
pub fn pine_cone(triangles: usize) -> Vec<Triangle> {
    let around = ((triangles as f64 / 1.4).sqrt() as usize).max(3);
    let along = (triangles / (2 * around)).max(3);
    // The numbers of spirals in either direction are neighbours in Fibonacci's sequence.
    let (p, q) = (13.0, 8.0);
    let point = |i: usize, j: usize| {
        let angle = TAU * j as f64 / around as f64;
        // The ends are a little open to one another: no ring shrinks to a point.
        let polar = PI * (i as f64 + 0.5) / (along as f64 + 1.0);
        // Mercator's projection keeps angles, so that scales keep their shape wherever they are.
        let height = -log(tan(polar / 2.0));
        let [one, other] = [p * angle + q * height, q * angle - p * height];
        let product = cos(one / 2.0) * cos(other / 2.0);
        let scale = pow(product * product, 0.35);
        // Wider below the middle, and every scale lifts its upper rim.
        let radius = sin(polar) * (0.62 - 0.16 * cos(polar));
        let relief = 0.16 * sin(polar) * scale;
        DVec3::new(
            (radius + relief) * sin(angle),
            0.95 * cos(polar) + 0.4 * relief,
            (radius + relief) * cos(angle),
        )
    };
    let mut mesh = strip(along, around, &point);
    for (ring, flip) in [(0, false), (along, true)] {
        let rim: Vec<_> = (0..around).map(|j| point(ring, j)).collect();
        let middle = rim.iter().sum::<DVec3>() / around as f64;
        for j in 0..around {
            let (a, b) = (rim[j], rim[(j + 1) % around]);
            mesh.push(if flip { triangle(middle, b, a) } else { triangle(middle, a, b) });
        }
    }
    mesh
}

/// The quadrilaterals between `rows + 1` rings of `columns` points each.
fn strip(rows: usize, columns: usize, point: &impl Fn(usize, usize) -> DVec3) -> Vec<Triangle> {
    let ring = |i: usize| (0..columns).map(|j| point(i, j)).collect::<Vec<_>>();
    let mut mesh = Vec::with_capacity(2 * rows * columns);
    let mut above = ring(0);
    for i in 1..=rows {
        let below = ring(i);
        for j in 0..columns {
            let k = (j + 1) % columns;
            mesh.push(triangle(above[j], below[j], below[k]));
            mesh.push(triangle(above[j], below[k], above[k]));
        }
        above = below;
    }
    mesh
}

/// Likewise, the last ring being the first.
fn sheet(rows: usize, columns: usize, point: &impl Fn(usize, usize) -> DVec3) -> Vec<Triangle> {
    strip(rows, columns, &|i, j| point(i % rows, j))
}

fn triangle(a: DVec3, b: DVec3, c: DVec3) -> Triangle {
    Triangle::new(a.as_vec3(), b.as_vec3(), c.as_vec3())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    /// Every directed edge has its opposite exactly once, and the faces look outward.
    fn assert_closed(mesh: &[Triangle]) {
        let mut edges = HashMap::new();
        let mut volume = 0.0;
        for t in mesh {
            let corners = t.vertices.map(|v| v.to_array().map(f32::to_bits));
            for i in 0..3 {
                *edges.entry((corners[i], corners[(i + 1) % 3])).or_insert(0) += 1;
            }
            let [a, b, c] = t.vertices.map(|v| v.as_dvec3());
            volume += a.dot(b.cross(c)) / 6.0;
        }
        assert!(edges.iter().all(|(&(a, b), &n)| n == 1 && edges.get(&(b, a)) == Some(&1)));
        assert!(volume > 0.1, "{volume}");
    }

    #[test]
    fn sculptures_are_closed_and_of_the_size_asked_for() {
        for sculpture in [knot, pine_cone] {
            let mesh = sculpture(20_000);
            assert_closed(&mesh);
            assert!(mesh.len().abs_diff(20_000) < 1000, "{}", mesh.len());
        }
    }
}
