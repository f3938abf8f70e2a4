//! Brute force, implemented independently: the answers that every accelerator must return.
//!
//! It shares no code with the accelerators or with [`decide`](crate::decide), but for
//! [`Triangle::is_degenerate`], which defines the triangles that are never hit. It evaluates the same formulas in
//! the same order, since the answers must be equal to the bit.

use crate::{Hit, Ray, Triangle};

/// The closest hit of `ray` among `triangles`; the smallest index breaks ties. `None` if there is none.
pub fn closest(triangles: &[Triangle], ray: &Ray) -> Option<Hit> {
    let mut all = hits(triangles, ray);
    all.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle)));
    all.first().copied()
}

/// Every hit of `ray` among `triangles`, by index.
pub fn hits(triangles: &[Triangle], ray: &Ray) -> Vec<Hit> {
    let (o, d) = (ray.origin.to_array(), ray.direction.to_array());
    let fastest = d.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let finite = o.iter().chain(&d).all(|x| x.is_finite());
    let in_domain = o.iter().all(|x| x.abs() <= Ray::MAX_ORIGIN) && Ray::DIRECTION_DOMAIN.contains(&fastest);
    if !finite || !in_domain || ray.t_min.is_nan() || ray.t_max.is_nan() {
        return Vec::new();
    }
    let hit = |(triangle, t): (u32, &Triangle)| -> Option<Hit> {
        let (t, u, v) = meet(o, d, t)?;
        (ray.t_min < t && t < ray.t_max && !ray.excluded.contains(&triangle)).then_some(Hit {
            t,
            u,
            v,
            triangle,
        })
    };
    (0..).zip(triangles).filter_map(hit).collect()
}

/// `t`, `u` and `v` where the line `o + t d` intersects the triangle.
fn meet(o: [f64; 3], d: [f64; 3], triangle: &Triangle) -> Option<(f64, f64, f64)> {
    if triangle.is_degenerate() {
        return None;
    }
    // The axis of the largest component; the first of equal ones.
    let k = (0..3).rev().max_by(|&a, &b| d[a].abs().total_cmp(&d[b].abs()))?;
    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
    let tiny = |x: f64| if x.abs() < 2.0_f64.powi(-200) { 0.0 } else { x };
    let (slope_i, slope_j) = (tiny(d[i] / d[k]), tiny(d[j] / d[k]));
    let mut p = [[0.0; 3]; 3];
    for (projected, vertex) in p.iter_mut().zip(triangle.vertices) {
        let v = vertex.to_array().map(f64::from);
        let depth = v[k] - tiny(o[k]);
        *projected = [v[i] - tiny(o[i]) - slope_i * depth, v[j] - tiny(o[j]) - slope_j * depth, depth];
    }
    let [a, b, c] = p;
    let e = [edge(c, b), edge(a, c), edge(b, a)];
    let positive = e.iter().all(|&x| x >= 0.0);
    let negative = e.iter().all(|&x| x <= 0.0);
    let sum = e[0] + e[1] + e[2];
    if !(positive || negative) || sum == 0.0 {
        return None;
    }
    let depth = (e[0] * a[2] + e[1] * b[2] + e[2] * c[2]) / sum;
    // Adding zero makes negative zeros positive.
    Some((depth / d[k] + 0.0, e[1] / sum + 0.0, e[2] / sum + 0.0))
}

/// `p.x q.y - p.y q.x`, by Kahan's algorithm.
fn edge(p: [f64; 3], q: [f64; 3]) -> f64 {
    let product = p[1] * q[0];
    let remainder = f64::mul_add(-p[1], q[0], product);
    f64::mul_add(p[0], q[1], -product) + remainder
}
