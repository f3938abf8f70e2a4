//! The mirror triangles of a scene as facets and closed bodies.

use super::facet::Facet;
use glam::{DVec3, Vec3};
use globillum_geom::{Aabb, Triangles};
use rayon::prelude::*;
use std::cmp::Reverse;

/// The facets of all mirrors, and the bounds of closed bodies.
#[derive(Debug, Default)]
pub(super) struct Facets {
    pub(super) facets: Vec<Facet>,
    pub(super) bodies: Vec<Aabb>,
}

/// The places of the triangles that share each of a triangle's edges, `None` where not exactly one does, in the
/// opposite direction.
pub(super) type Neighbours = [Option<u32>; 3];

impl Facets {
    /// The most bodies that count as closed, since a node of the tree has a bit for each.
    const MAX_BODIES: usize = 31;

    /// Of the triangles with the indices `mirrors`. Adjacent triangles that are coplanar share a facet.
    pub(super) fn of(triangles: &Triangles, mirrors: &[u32]) -> Self {
        let neighbours = neighbours(triangles, mirrors);
        let bodies = closed_bodies(triangles, mirrors, &neighbours);
        let mut body_of = vec![None; mirrors.len()];
        for (number, body) in (0_u32..).zip(&bodies) {
            body.places.iter().for_each(|&place| body_of[place as usize] = Some((number, body.is_inverted)));
        }
        let facet = |places: Vec<u32>| {
            let index = mirrors[places[0] as usize];
            let mut facet = Facet::of(index, triangles.get(index));
            facet.triangles = places.iter().map(|&place| mirrors[place as usize]).collect();
            if let Some((body, is_inverted)) = body_of[places[0] as usize] {
                facet.body = Some(body);
                facet.normal *= if is_inverted { -1.0 } else { 1.0 };
            }
            facet
        };
        let facets = coplanar_groups(triangles, mirrors, &neighbours).into_iter().map(facet).collect();
        Self { facets, bodies: bodies.into_iter().map(|body| body.bounds).collect() }
    }
}

/// Triangles that enclose a part of space.
struct ClosedBody {
    /// The places of the triangles.
    places: Vec<u32>,
    bounds: Aabb,
    /// Whether the fronts are on the inner side.
    is_inverted: bool,
}

/// The first [`Facets::MAX_BODIES`] groups of connected triangles whose every edge is shared by exactly one other, in the
/// opposite direction.
fn closed_bodies(triangles: &Triangles, mirrors: &[u32], neighbours: &[Neighbours]) -> Vec<ClosedBody> {
    let is_closed =
        |body: &Vec<u32>| body.iter().all(|&place| neighbours[place as usize].iter().all(Option::is_some));
    let body = |places: Vec<u32>| {
        let members = || places.iter().map(|&place| triangles.get(mirrors[place as usize]).vertices);
        let (bounds, is_inverted) = (Aabb::around(members().flatten()), volume(members()) < 0.0);
        ClosedBody { places, bounds, is_inverted }
    };
    let all = connected(neighbours, |_, _| true, 0..mirrors.len() as u32);
    all.into_iter().filter(is_closed).take(Facets::MAX_BODIES).map(body).collect()
}

/// The groups of adjacent coplanar triangles, by their places. The first triangle of each is its largest.
fn coplanar_groups(triangles: &Triangles, mirrors: &[u32], neighbours: &[Neighbours]) -> Vec<Vec<u32>> {
    let triangle = |place: u32| triangles.get(mirrors[place as usize]);
    // Larger triangles determine their plane more precisely.
    let mut by_area: Vec<_> = (0..mirrors.len() as u32).collect();
    // The bits of areas, which are not negative, are in the order of the areas.
    by_area.par_sort_by_cached_key(|&place| Reverse(triangle(place).area().to_bits()));
    let normals: Vec<_> = mirrors.par_iter().map(|&index| triangles.get(index).normal()).collect();
    let is_coplanar = |first: u32, other: u32| {
        let [a, b] = [first, other].map(|place| normals[place as usize]);
        Facet::is_parallel(a, b)
            && Facet::of(mirrors[first as usize], triangle(first)).is_close(triangle(other))
    };
    connected(neighbours, is_coplanar, by_area)
}

/// The groups of triangles that are connected by shared edges. Each grows from the first of `seeds` that is in none,
/// by all triangles for which `belongs`, asked with the seed, holds.
pub(super) fn connected(
    neighbours: &[Neighbours],
    belongs: impl Fn(u32, u32) -> bool,
    seeds: impl IntoIterator<Item = u32>,
) -> Vec<Vec<u32>> {
    let mut is_taken = vec![false; neighbours.len()];
    let mut groups = Vec::new();
    for seed in seeds {
        if std::mem::replace(&mut is_taken[seed as usize], true) {
            continue;
        }
        let mut group = vec![seed];
        let mut next = 0;
        while let Some(&place) = group.get(next) {
            next += 1;
            for &other in neighbours[place as usize].iter().flatten() {
                if !is_taken[other as usize] && belongs(seed, other) {
                    is_taken[other as usize] = true;
                    group.push(other);
                }
            }
        }
        groups.push(group);
    }
    groups
}

/// The neighbours of each triangle.
pub(super) fn neighbours(triangles: &Triangles, mirrors: &[u32]) -> Vec<Neighbours> {
    // A vertex by its bits, in which both zeros are the same.
    let bits = |v: Vec3| (v + Vec3::ZERO).to_array().map(f32::to_bits);
    let mut edges = Vec::with_capacity(3 * mirrors.len());
    for (place, &index) in (0_u32..).zip(mirrors) {
        let vertices = triangles.get(index).vertices.map(bits);
        for edge in 0..3 {
            let (a, b) = (vertices[edge], vertices[(edge + 1) % 3]);
            edges.push(((a.min(b), a.max(b)), a < b, place, edge));
        }
    }
    edges.par_sort_unstable();
    let mut neighbours = vec![[None; 3]; mirrors.len()];
    for shared in edges.chunk_by(|a, b| a.0 == b.0) {
        if let [(_, false, p, p_edge), (_, true, q, q_edge)] = *shared {
            neighbours[p as usize][p_edge] = Some(q);
            neighbours[q as usize][q_edge] = Some(p);
        }
    }
    neighbours
}

/// Six times the volume within a closed body; negative if its triangles face inward.
fn volume(triangles: impl Iterator<Item = [Vec3; 3]>) -> f64 {
    let mut first = None;
    let volume = |vertices: [Vec3; 3]| {
        let origin: DVec3 = *first.get_or_insert(vertices[0].as_dvec3());
        let [a, b, c] = vertices.map(|v| v.as_dvec3() - origin);
        a.dot(b.cross(c))
    };
    triangles.map(volume).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use globillum_geom::Triangle;
    use globillum_geom::conformance::shapes::{cuboid, icosphere, inside_out, quad};

    /// A square of `n` by `n` squares, each of two triangles, turned so that vertices are rounded.
    fn tiles(n: u32) -> Vec<Triangle> {
        let corner = |i: u32, j: u32| {
            let [x, z] = [i, j].map(|i| f64::from(i) / f64::from(n));
            glam::DQuat::from_rotation_z(0.3) * DVec3::new(x, 0.0, z)
        };
        let tile = |i, j| quad(corner(i, j + 1), corner(i + 1, j + 1), corner(i + 1, j), corner(i, j));
        (0..n).flat_map(|i| (0..n).flat_map(move |j| tile(i, j))).collect()
    }

    /// A concave mirror of `n` strips, each turned by `step` from the one before.
    fn strips(n: u32, step: f64) -> Vec<Triangle> {
        let width = 1.0 / f64::from(n);
        let mut edge = DVec3::ZERO;
        let strip = |i: u32| {
            let (sin, cos) = (step * f64::from(i)).sin_cos();
            let next = edge + width * DVec3::new(cos, sin, 0.0);
            let strip = quad(edge + DVec3::Z, next + DVec3::Z, next, edge);
            edge = next;
            strip
        };
        (0..n).flat_map(strip).collect()
    }

    /// Both sides of the sheet reflect, as the fronts of a closed body.
    #[test]
    fn a_triangle_and_its_reversed_twin_are_two_facets() {
        let front = Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y);
        let triangles = Triangles::new([vec![front], inside_out([front])].concat()).unwrap();
        let Facets { facets, bodies } = Facets::of(&triangles, triangles.live());
        assert_eq!(bodies.len(), 1);
        let mut normals: Vec<_> = facets.iter().map(|facet| (facet.normal.z, facet.triangles[0])).collect();
        normals.sort_by_key(|&(_, index)| index);
        assert_eq!(normals, [(1.0, 0), (-1.0, 1)]);
    }

    #[test]
    fn coplanar_neighbours_share_a_facet_and_closed_bodies_are_found() {
        let block = || cuboid(DVec3::new(0.3, 0.1, -0.2), DVec3::new(0.3, 0.6, 0.4), 0.32).to_vec();
        let ball = || icosphere(2).placed(0.5, DVec3::new(3.0, 0.0, 0.0)).triangles();
        let cases = [
            ("a block", block(), 6, 1),
            ("a block without a side", block()[..10].to_vec(), 5, 0),
            ("a block and a ball inside out", [block(), inside_out(ball())].concat(), 6 + 320, 2),
            ("a body twice", [block(), block()].concat(), 24, 0),
            ("tiles", tiles(16), 1, 0),
            ("a mirror all but plane", strips(32, 1.2e-4), 32, 0),
        ];
        for (what, mirrors, facets, bodies) in cases {
            let triangles = Triangles::new(mirrors).unwrap();
            let found = Facets::of(&triangles, triangles.live());
            assert_eq!((found.facets.len(), found.bodies.len()), (facets, bodies), "{what}");
            let mut members: Vec<_> = found.facets.iter().flat_map(|facet| &facet.triangles).collect();
            members.sort_unstable();
            assert!(members.into_iter().eq(triangles.live()), "{what}: each triangle once");
            for facet in found.facets.iter().filter(|facet| facet.body.is_some()) {
                let point = triangles.surface_point(facet.triangles[0], 0.3, 0.3).position;
                let body = found.bodies[facet.body.unwrap() as usize];
                let middle = 0.5 * (body.min + body.max).as_dvec3();
                assert!(facet.normal.dot(point - middle) > 0.0, "{what}: a normal points inward");
            }
        }
    }
}
