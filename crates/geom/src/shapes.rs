//! Triangle meshes of simple shapes, computed in `f64` and rounded once, with the same bits on every platform: sines and
//! cosines are those of `libm`.

use crate::Triangle;
use glam::{DQuat, DVec3};
use libm::{cos, sin};
use std::collections::HashMap;
use std::f64::consts::TAU;

/// A triangle mesh with shared vertices.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// The positions of the vertices.
    pub vertices: Vec<DVec3>,
    /// The vertex indices of each triangle, counter-clockwise from outside.
    pub faces: Vec<[usize; 3]>,
    /// Points inside a closed mesh, each at least `thickness` from the surface.
    pub core: Vec<DVec3>,
    /// A lower bound of the distance from `core` to the surface.
    pub thickness: f64,
}

impl Mesh {
    /// The triangles, in the order of `faces`, with vertices rounded to `f32`.
    pub fn triangles(&self) -> Vec<Triangle> {
        let corner = |i: usize| self.vertices[i].as_vec3();
        self.faces.iter().map(|f| Triangle::new(corner(f[0]), corner(f[1]), corner(f[2]))).collect()
    }

    /// The mesh scaled by `scale > 0` about the origin, then translated by `offset`.
    #[must_use]
    pub fn placed(mut self, scale: f64, offset: DVec3) -> Self {
        for point in self.vertices.iter_mut().chain(&mut self.core) {
            *point = *point * scale + offset;
        }
        self.thickness *= scale;
        self
    }
}

/// The quadrilateral `a b c d` as the triangles `a b c` and `a c d`.
pub fn quad(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> [Triangle; 2] {
    Triangle::quad(a.as_vec3(), b.as_vec3(), c.as_vec3(), d.as_vec3())
}

/// A box around `center` with half sides `half`, rotated by `yaw` radians about the y axis; its front is
/// outside.
pub fn cuboid(center: DVec3, half: DVec3, yaw: f64) -> Vec<Triangle> {
    let (sin, cos) = libm::sincos(0.5 * yaw);
    let turn = DQuat::from_xyzw(0.0, sin, 0.0, cos);
    let corners: Vec<DVec3> = (0..8)
        .map(|i| [i >> 2 & 1, i >> 1 & 1, i & 1].map(|bit| f64::from(2 * bit - 1)))
        .map(|signs| center + turn * (half * DVec3::from(signs)))
        .collect();
    let faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
    faces.into_iter().flat_map(|f| quad(corners[f[0]], corners[f[1]], corners[f[2]], corners[f[3]])).collect()
}

/// The triangles with front and back swapped.
pub fn inside_out(triangles: impl IntoIterator<Item = Triangle>) -> Vec<Triangle> {
    let flip = |t: Triangle| {
        let [a, b, c] = t.vertices;
        Triangle::new(a, c, b)
    };
    triangles.into_iter().map(flip).collect()
}

/// An icosahedron whose faces are subdivided `levels` times, with vertices on the unit sphere: a closed mesh
/// of `20 * 4^levels` triangles.
pub fn icosphere(levels: u32) -> Mesh {
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let mut mesh = Mesh { core: vec![DVec3::ZERO], thickness: 0.7, ..Mesh::default() };
    for axis in 0..3 {
        for (a, b) in [(1.0, golden), (-1.0, golden), (1.0, -golden), (-1.0, -golden)] {
            let mut v = [0.0; 3];
            (v[axis], v[(axis + 1) % 3]) = (a, b);
            mesh.vertices.push(DVec3::from(v).normalize());
        }
    }
    // Any three vertices at mutual distances of one edge are a face.
    let edge = 2.0 / (1.0 + golden * golden).sqrt();
    let near = |i: usize, j: usize| (mesh.vertices[i].distance(mesh.vertices[j]) - edge).abs() < 1e-9;
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                if near(i, j) && near(j, k) && near(i, k) {
                    let [a, b, c] = [i, j, k].map(|n| mesh.vertices[n]);
                    let outward = (b - a).cross(c - a).dot(a) > 0.0;
                    mesh.faces.push(if outward { [i, j, k] } else { [i, k, j] });
                }
            }
        }
    }
    for _ in 0..levels {
        mesh = subdivide(&mesh);
    }
    mesh
}

/// Splits each face in four at the midpoints of its edges, projected to the unit sphere.
fn subdivide(mesh: &Mesh) -> Mesh {
    let mut vertices = mesh.vertices.clone();
    let mut middles = HashMap::new();
    let mut middle = |i: usize, j: usize| {
        *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
            vertices.push((mesh.vertices[i] + mesh.vertices[j]).normalize());
            vertices.len() - 1
        })
    };
    let mut faces = Vec::with_capacity(4 * mesh.faces.len());
    for &[a, b, c] in &mesh.faces {
        let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
        faces.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    Mesh { vertices, faces, ..mesh.clone() }
}

/// A tube around the closed curve `core(u)`: the points `core(u) + wall(u, v)`, with both parameters from 0
/// to 2 pi, as `around` times `across` quadrilaterals.
fn tube(
    [around, across]: [usize; 2],
    thickness: f64,
    core: impl Fn(f64) -> DVec3,
    wall: impl Fn(f64, f64) -> DVec3,
) -> Mesh {
    let mut mesh = Mesh { thickness, ..Mesh::default() };
    let index = |i: usize, j: usize| (i % around) * across + j % across;
    for i in 0..around {
        let u = TAU * i as f64 / around as f64;
        mesh.core.push(core(u));
        for j in 0..across {
            mesh.vertices.push(core(u) + wall(u, TAU * j as f64 / across as f64));
            let corners = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
            mesh.faces.push([corners[0], corners[1], corners[2]]);
            mesh.faces.push([corners[0], corners[2], corners[3]]);
        }
    }
    mesh
}

/// A torus about the y axis with radii 1 and 0.4: a closed mesh of `2 * around * across` triangles.
pub fn torus(around: usize, across: usize) -> Mesh {
    let core = |u: f64| DVec3::new(sin(u), 0.0, cos(u));
    tube([around, across], 0.2, core, |u, v| 0.4 * (cos(v) * core(u) + sin(v) * DVec3::Y))
}

/// A tube around a trefoil knot with a rippled surface, as a stand-in for a scanned statue: a closed mesh of
/// about `triangles` triangles, roughly within the unit ball.
pub fn statue(triangles: usize) -> Mesh {
    // The tube is eight times as long as its circumference.
    let across = ((triangles as f64 / 16.0).sqrt() as usize).max(3);
    let around = (triangles / (2 * across)).max(3);
    let knot =
        |u: f64| DVec3::new(sin(u) + 2.0 * sin(2.0 * u), cos(u) - 2.0 * cos(2.0 * u), -sin(3.0 * u)) / 3.5;
    tube([around, across], 0.05, knot, |u, v| {
        let tangent = (knot(u + 1e-4) - knot(u - 1e-4)).normalize();
        let side = tangent.cross(DVec3::Z).normalize();
        let normal = side.cross(tangent);
        let ripple = 1.0 + 0.08 * sin(24.0 * u) + 0.06 * sin(5.0 * v + 9.0 * u);
        0.17 * ripple * (cos(v) * side + sin(v) * normal)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The hash FNV-1a of all coordinates.
    fn hash(mesh: &Mesh) -> u64 {
        let coordinates = mesh.vertices.iter().chain(&mesh.core).flat_map(|p| p.to_array());
        let bytes = coordinates.flat_map(|x| x.to_bits().to_le_bytes());
        bytes
            .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
    }

    #[test]
    fn round_shapes_have_the_same_bits_on_every_platform() {
        assert_eq!(
            [hash(&torus(48, 24)), hash(&statue(4000))],
            [0x0b7b_b530_0540_e28a, 0xf40d_8933_dbd9_5345]
        );
    }
}
