//! Named hard cases, listed in docs/testing.md.

use super::aim::ray_at;
use super::compare::{Tally, Violation, compare};
use super::oracle;
use super::source::{Seeded, Source};
use crate::shapes::{icosphere, quad, statue};
use crate::{Accel, GeomError, Ray, Triangle, Triangles};
use glam::{DVec3, Vec3};
use std::f64;

/// A scene, rays, and what is known in advance about their hits.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Case {
    /// The name of the case.
    pub name: &'static str,
    /// The scene.
    pub triangles: Vec<Triangle>,
    /// The rays, each with what is known about its hits.
    pub rays: Vec<(Ray, Known)>,
}

/// What is known about a ray's hits, in addition to their equality with the oracle's.
#[derive(Clone, Debug, PartialEq)]
pub enum Known {
    /// Nothing else.
    Unspecified,
    /// The ray hits nothing.
    Miss,
    /// The closest hit has exactly this `t`.
    At(f64),
    /// All hits, sorted, have exactly these `t`.
    All(Vec<f64>),
}

impl Case {
    fn new(
        name: &'static str,
        triangles: Vec<Triangle>,
        rays: impl IntoIterator<Item = (Ray, Known)>,
    ) -> Self {
        Self { name, triangles, rays: rays.into_iter().collect() }
    }

    /// Checks the accelerator that `build` makes of the scene.
    ///
    /// # Errors
    /// The first [`Violation`] found.
    pub fn check<A: Accel>(
        &self,
        build: impl Fn(&Triangles) -> Result<A, GeomError>,
    ) -> Result<Tally, Violation> {
        let refused = |error: GeomError| Violation::of_building(self.name, &self.triangles, &error);
        let triangles = Triangles::new(self.triangles.clone()).map_err(refused)?;
        let accel = build(&triangles).map_err(refused)?;
        for (ray, known) in &self.rays {
            let mut found: Vec<f64> = oracle::hits(&self.triangles, ray).iter().map(|h| h.t).collect();
            found.sort_by(f64::total_cmp);
            let as_known = match known {
                Known::Unspecified => true,
                Known::Miss => found.is_empty(),
                Known::At(t) => found.first() == Some(t),
                Known::All(ts) => found == *ts,
            };
            if !as_known {
                return Err(Violation {
                    what: self.name.to_owned(),
                    triangles: self.triangles.clone(),
                    ray: Some(Box::new(*ray)),
                    expected: format!("{known:?}"),
                    actual: format!("{found:?}"),
                });
            }
        }
        let rays: Vec<Ray> = self.rays.iter().map(|(ray, _)| *ray).collect();
        compare(self.name, &accel, &self.triangles, &rays)
    }
}

/// All cases, in the order of docs/testing.md.
pub fn all() -> Vec<Case> {
    vec![
        along_a_face_diagonal(),
        signed_zeros_and_origins_on_the_boundary(),
        within_the_plane_of_a_face(),
        along_an_edge(),
        through_opposite_vertices(),
        directions_close_to_an_axis(),
        a_lattice_of_shared_vertices(),
        origins_on_every_plane_through_a_vertex(),
        rays_within_planes_that_hold_triangles(),
        origins_on_a_triangle(),
        origins_outside_inside_and_behind(),
        directions_of_any_length(),
        zero_nan_and_infinite_rays(),
        empty_ranges(),
        ranges_are_open(),
        grazing_a_long_plane(),
        origins_far_away(),
        no_triangles(),
        duplicate_triangles(),
        excluded_triangles(),
        a_scene_flat_in_x(),
        a_scene_flat_in_y(),
        a_scene_flat_in_z(),
        degenerate_triangles(),
        aimed_rays_at_aligned_offset_thin_and_round_scenes(),
    ]
}

fn p(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// The unit cube: two triangles per face, split along the diagonal from `(0, 0)` to `(1, 1)`.
fn cube() -> Vec<Triangle> {
    let face = |at: &dyn Fn(f64, f64) -> DVec3| quad(at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0));
    let mut faces = Vec::new();
    for side in [0.0, 1.0] {
        faces.extend(face(&|a, b| p(side, a, b)));
        faces.extend(face(&|a, b| p(a, side, b)));
        faces.extend(face(&|a, b| p(a, b, side)));
    }
    faces
}

fn at(origin: DVec3, direction: DVec3, t: f64) -> (Ray, Known) {
    (Ray::new(origin, direction), Known::At(t))
}

/// A ray that hits the diagonal shared by both triangles of a face.
pub fn along_a_face_diagonal() -> Case {
    let ray = Ray::new(p(0.5, 0.5, -1.0), DVec3::Z);
    Case::new("along a face diagonal", cube(), [(ray, Known::All(vec![1.0, 1.0, 2.0, 2.0]))])
}

/// Zeros of either sign in the direction, and origins on the cube's boundary.
pub fn signed_zeros_and_origins_on_the_boundary() -> Case {
    let zeros = [(0.0, 0.0), (-0.0, 0.0), (0.0, -0.0), (-0.0, -0.0)];
    let origins = [p(0.5, 0.5, -1.0), p(0.0, 0.5, -1.0), p(-0.0, 0.5, -1.0), p(0.0, 0.0, -1.0)];
    let rays = origins.into_iter().flat_map(|o| zeros.map(|(x, y)| at(o, p(x, y, 1.0), 1.0)));
    Case::new("signed zeros, origins on the boundary", cube(), rays)
}

/// A ray within the plane of one face hits the adjacent face at its edge.
pub fn within_the_plane_of_a_face() -> Case {
    let rays = [0.0, -0.0].map(|z| at(p(-1.0, 0.3, z), p(1.0, 0.0, z), 1.0));
    Case::new("within the plane of a face", cube(), rays)
}

/// A ray along an edge hits the vertex where the edge begins.
pub fn along_an_edge() -> Case {
    Case::new("along an edge", cube(), [at(p(0.0, 0.0, -1.0), DVec3::Z, 1.0)])
}

/// A ray through two opposite vertices hits all triangles that share either.
pub fn through_opposite_vertices() -> Case {
    let ray = Ray::new(p(-1.0, -1.0, -1.0), DVec3::ONE);
    let all = [[1.0; 6], [2.0; 6]].concat();
    Case::new("through opposite vertices", cube(), [(ray, Known::All(all))])
}

/// Directions with components that are tiny but not zero.
pub fn directions_close_to_an_axis() -> Case {
    let origins = [p(0.5, 0.5, -1.0), p(0.0, 0.0, -1.0), p(0.25, 0.75, -1.0), p(1.0, 1.0, -1.0)];
    let directions = [p(5e-324, 1e-300, 1.0), p(-5e-324, 0.0, 1.0), p(1e-200, -1e-310, 1.0)];
    let rays = origins.into_iter().flat_map(|o| directions.map(|d| at(o, d, 1.0)));
    Case::new("directions close to an axis", cube(), rays)
}

/// Rays at every vertex, edge midpoint and boundary point of 8 x 8 quadrilaterals.
pub fn a_lattice_of_shared_vertices() -> Case {
    let whole: Vec<f64> = (0..=8).map(f64::from).collect();
    let halves: Vec<f64> = (0..8).map(|i| f64::from(i) + 0.5).collect();
    let grid = |xs: &[f64], ys: &[f64]| -> Vec<(f64, f64)> {
        xs.iter().flat_map(|&x| ys.iter().map(move |&y| (x, y))).collect()
    };
    let triangles = grid(&whole[..8], &whole[..8]).into_iter().flat_map(|(x, y)| {
        quad(p(x, y, 0.0), p(x + 1.0, y, 0.0), p(x + 1.0, y + 1.0, 0.0), p(x, y + 1.0, 0.0))
    });
    let points = [grid(&whole, &whole), grid(&halves, &whole), grid(&whole, &halves)];
    let rays = points.concat().into_iter().map(|(x, y)| at(p(x, y, 1.0), -DVec3::Z, 1.0));
    Case::new("a lattice of shared vertices", triangles.collect(), rays)
}

/// Origins exactly on planes through vertices, where accelerators split.
pub fn origins_on_every_plane_through_a_vertex() -> Case {
    let triangles = shelves();
    let mut source = Seeded::new(8);
    let rays = (0..3000).map(|_| {
        let mut origin = p(4.0 * source.unit(), 4.0 * source.unit(), 4.0 * source.unit());
        let axis = source.below(3);
        origin[axis] = f64::from(source.pick(&triangles).vertices[source.below(3)][axis]);
        let mut direction = p(source.signed(), source.signed(), source.signed());
        direction[axis] = source.pick(&[1.0, -1.0, 0.0, -0.0]);
        (Ray::new(origin, direction), Known::Unspecified)
    });
    Case::new("origins on splitting planes", triangles.clone(), rays.collect::<Vec<_>>())
}

/// Rays within planes that have triangles on one side, on the other, on both, and in the plane.
pub fn rays_within_planes_that_hold_triangles() -> Case {
    let triangles = shelves();
    let mut source = Seeded::new(9);
    let rays = (0..3000).map(|_| {
        let axis = source.below(3);
        let mut origin = p(source.unit(), source.unit(), source.unit()) * 6.0 - 1.0;
        origin[axis] = source.below(5) as f64;
        let mut direction = p(source.signed(), source.signed(), source.signed());
        direction[axis] = source.pick(&[0.0, -0.0]);
        if source.one_in(2) {
            let other = (axis + 1) % 3;
            direction[other] = source.pick(&[0.0, -0.0]);
            origin[other] = source.below(9) as f64 / 2.0;
        }
        (Ray::new(origin, direction), Known::Unspecified)
    });
    Case::new("rays within planes that hold triangles", triangles, rays.collect::<Vec<_>>())
}

/// A ray does not hit the triangle that it starts on; it hits the next one.
pub fn origins_on_a_triangle() -> Case {
    let level = |z: f64| quad(p(0.0, 0.0, z), p(1.0, 0.0, z), p(1.0, 1.0, z), p(0.0, 1.0, z));
    let starts = [(0.25, 0.5), (0.5, 0.5), (0.0, 0.0), (0.5, 0.0), (1.0, 1.0)];
    let rays = starts
        .into_iter()
        .flat_map(|(x, y)| [at(p(x, y, 0.0), DVec3::Z, 1.0), at(p(x, y, 1.0), -DVec3::Z, 1.0)]);
    let out = starts.map(|(x, y)| (Ray::new(p(x, y, 1.0), DVec3::Z), Known::Miss));
    let rays: Vec<_> = rays.chain(out).collect();
    Case::new("origins on a triangle", [level(0.0), level(1.0)].concat(), rays)
}

/// Origins outside, inside and behind the scene, and rays that touch its bounds at a corner only.
pub fn origins_outside_inside_and_behind() -> Case {
    let corner = |o: DVec3, d: DVec3, known| (Ray::new(o, d), known);
    let rays = [
        at(p(0.5, 0.5, 0.5), DVec3::Z, 0.5),
        at(p(0.5, 0.5, 0.5), -DVec3::X, 0.5),
        at(p(-1.0, 0.5, 0.25), DVec3::X, 1.0),
        corner(p(2.0, 0.5, 0.5), DVec3::X, Known::Miss),
        corner(p(2.0, 2.0, 2.0), DVec3::ONE, Known::Miss),
        // Outside the corner (1, 1, 0), through it, and inside.
        corner(p(0.5, 1.5, -0.5), p(1.0, -1.0, 1.0), Known::At(0.5)),
        corner(p(2.0, 0.0, 0.0), p(-1.0, 1.0, 0.0), Known::At(1.0)),
        corner(p(2.0 + 1e-9, 0.0, 0.5), p(-1.0, 1.0, 0.0), Known::Miss),
    ];
    Case::new("origins outside, inside and behind", cube(), rays)
}

/// Directions whose length is far from 1.
pub fn directions_of_any_length() -> Case {
    let rays = [-500, -100, -30, 0, 30, 100, 500].map(|k| {
        let d = 2.0_f64.powi(k);
        at(p(0.5, 0.25, -1.0), p(0.0, 0.0, d), 1.0 / d)
    });
    Case::new("directions of any length", cube(), rays)
}

/// A zero direction, and NaNs and infinities in each component.
pub fn zero_nan_and_infinite_rays() -> Case {
    let good = Ray::new(p(0.5, 0.25, -1.0), DVec3::Z);
    let mut rays = vec![Ray { direction: DVec3::ZERO, ..good }, Ray { direction: -DVec3::ZERO, ..good }];
    for bad in [f64::NAN, -f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for axis in 0..3 {
            let (mut from, mut along) = (good, good);
            from.origin[axis] = bad;
            along.direction[axis] = bad;
            rays.extend([from, along]);
        }
    }
    rays.extend([good.with_range(f64::NAN, 9.0), good.with_range(0.0, f64::NAN)]);
    let rays = rays.into_iter().map(|ray| (ray, Known::Miss));
    Case::new("zero, NaN and infinite rays", cube(), rays)
}

/// Empty ranges, and an unlimited one.
pub fn empty_ranges() -> Case {
    let ray = Ray::new(p(0.5, 0.25, -1.0), DVec3::Z);
    let inf = f64::INFINITY;
    let empty = [(2.0, 1.0), (1.0, 1.0), (0.0, 0.0), (0.0, -1.0), (inf, inf), (0.0, -inf)];
    let rays = empty.map(|(a, b)| (ray.with_range(a, b), Known::Miss));
    let whole = [(ray.with_range(0.0, inf), Known::At(1.0)), (ray.with_range(-inf, inf), Known::At(1.0))];
    Case::new("empty ranges", cube(), rays.into_iter().chain(whole))
}

/// Both ends of a range are excluded, to the last bit.
pub fn ranges_are_open() -> Case {
    let ray = Ray::new(p(0.5, 0.25, -1.0), DVec3::Z);
    let one = 1.0_f64;
    let rays = [
        (ray.with_range(one, f64::INFINITY), Known::At(2.0)),
        (ray.with_range(one, 2.0), Known::Miss),
        (ray.with_range(one.next_down(), f64::INFINITY), Known::At(1.0)),
        (ray.with_range(0.0, one), Known::Miss),
        (ray.with_range(0.0, one.next_up()), Known::At(1.0)),
    ];
    Case::new("ranges are open", cube(), rays)
}

/// Rays at a slope of `10^-k` above a plane of length `10^6`.
pub fn grazing_a_long_plane() -> Case {
    let cells = 16;
    let size = 1e6 / f64::from(cells);
    let triangles = (0..cells * cells).flat_map(|i| {
        let (x, z) = (f64::from(i % cells) * size, f64::from(i / cells) * size);
        quad(p(x, 0.0, z), p(x + size, 0.0, z), p(x + size, 0.0, z + size), p(x, 0.0, z + size))
    });
    let rays = (1..=16).flat_map(|k| {
        let slope = 10.0_f64.powi(-k);
        [p(1.0, -slope, 0.3), p(1.0, -slope, 0.0), p(1.0, slope, 1.0), p(0.7, -slope, 1.0)]
            .map(|d| (Ray::new(p(-1.0, 0.5 * slope.sqrt(), 0.0), d), Known::Unspecified))
    });
    Case::new("grazing a long plane", triangles.collect(), rays)
}

/// Rays at a unit sphere from a distance of `10^12`.
pub fn origins_far_away() -> Case {
    let triangles = icosphere(2).triangles();
    let mut source = Seeded::new(20);
    let rays = (0..500).map(|_| {
        let from = p(source.signed(), source.signed(), source.signed()) * 1e12;
        let target = super::aim::point_of(&source.pick(&triangles), &mut source);
        (Ray::new(from, target - from), Known::Unspecified)
    });
    let rays = rays.collect::<Vec<_>>();
    Case::new("origins far away", triangles, rays)
}

/// A scene without triangles.
pub fn no_triangles() -> Case {
    let rays = [DVec3::X, DVec3::ONE].map(|d| (Ray::new(DVec3::ZERO, d), Known::Miss));
    Case::new("no triangles", Vec::new(), rays)
}

/// One triangle twice: the first copy is hit.
pub fn duplicate_triangles() -> Case {
    let triangle = Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y);
    let rays = [(0.25, 0.25), (0.0, 0.0), (0.5, 0.5)].map(|(x, y)| at(p(x, y, 1.0), -DVec3::Z, 1.0));
    Case::new("duplicate triangles", vec![triangle; 2], rays)
}

/// Rays that exclude triangles of the cube, of two copies of it, and none that there is.
pub fn excluded_triangles() -> Case {
    let triangles = [cube(), cube()].concat();
    let ray = Ray::new(p(0.7, 0.2, -1.0), DVec3::Z);
    let (met, none) = (oracle::hits(&triangles, &ray), Ray::NO_TRIANGLE);
    let [front, back, front_copy, back_copy] =
        [0, 1, 2, 3].map(|place| met.get(place).map_or(none, |hit| hit.triangle));
    let rays = [
        ([none; 2], vec![1.0, 1.0, 2.0, 2.0]),
        ([front, none], vec![1.0, 2.0, 2.0]),
        ([none, front_copy], vec![1.0, 2.0, 2.0]),
        ([front, front_copy], vec![2.0, 2.0]),
        ([front_copy, back], vec![1.0, 2.0]),
        ([back_copy, back], vec![1.0, 1.0]),
        ([triangles.len() as u32, none], vec![1.0, 1.0, 2.0, 2.0]),
    ];
    let rays = rays.map(|(excluded, all)| (ray.excluding(excluded), Known::All(all)));
    // Indices that no triangle has, each a bit away from one that is hit.
    let none_there_is = (0..32).flat_map(|bit| [front, front_copy].map(|index| index ^ 1 << bit));
    let none_there_is = none_there_is.filter(|&index| index as usize >= triangles.len());
    let none_there_is: Vec<_> = none_there_is
        .flat_map(|index| [[index, none], [none, index]])
        .map(|excluded| (ray.excluding(excluded), Known::All(vec![1.0, 1.0, 2.0, 2.0])))
        .collect();
    let segment = Ray::segment(p(0.7, 0.2, -1.0), p(0.7, 0.2, 0.5)).excluding([front, front_copy]);
    Case::new(
        "excluded triangles",
        triangles,
        rays.into_iter().chain(none_there_is).chain([(segment, Known::Miss)]),
    )
}

/// A scene within one plane perpendicular to `axis`, 0 to 2.
fn flat_scene(name: &'static str, axis: usize) -> Case {
    let mut source = Seeded::new(23);
    let mut flat = || {
        let mut corner = Vec3::new(source.unit() as f32, source.unit() as f32, source.unit() as f32);
        corner[axis] = 0.0;
        corner
    };
    let triangles: Vec<Triangle> = (0..64).map(|_| Triangle::new(flat(), flat(), flat())).collect();
    let rays: Vec<_> = (0..500)
        .map(|_| {
            let mut elsewhere = p(source.signed(), source.signed(), source.signed());
            elsewhere[axis] = source.pick(&[0.0, 1.0, -1.0]);
            (ray_at(&triangles, elsewhere, &mut source), Known::Unspecified)
        })
        .collect();
    Case::new(name, triangles, rays)
}

/// A scene within the plane x = 0.
pub fn a_scene_flat_in_x() -> Case {
    flat_scene("a scene flat in x", 0)
}

/// A scene within the plane y = 0.
pub fn a_scene_flat_in_y() -> Case {
    flat_scene("a scene flat in y", 1)
}

/// A scene within the plane z = 0.
pub fn a_scene_flat_in_z() -> Case {
    flat_scene("a scene flat in z", 2)
}

/// Degenerate triangles are never hit.
pub fn degenerate_triangles() -> Case {
    let (a, b) = (Vec3::new(0.25, 0.25, 0.5), Vec3::new(0.5, 0.25, 0.5));
    let flat = [Triangle::new(a, a, b), Triangle::new(a, b, a), Triangle::new(a, a, a)];
    let collinear = Triangle::new(Vec3::ZERO, Vec3::X, Vec3::X * 2.0);
    let rays = [
        at(p(0.25, 0.25, -1.0), DVec3::Z, 1.0),
        at(p(0.375, 0.25, 0.25), DVec3::Z, 0.75),
        at(p(0.5, 0.0, -1.0), DVec3::Z, 1.0),
    ];
    Case::new("degenerate triangles", [&flat[..], &[collinear], &cube()].concat(), rays)
}

/// Aimed, axis-parallel and random rays at shelves, at shelves far from the origin, at slivers and at spheres.
pub fn aimed_rays_at_aligned_offset_thin_and_round_scenes() -> Case {
    let moved = |t: &Triangle, by: Vec3| Triangle { vertices: t.vertices.map(|v| v + by) };
    let mut triangles = shelves();
    triangles.extend(shelves().iter().map(|t| moved(t, Vec3::splat(1000.0))));
    triangles.extend((0..40).map(|i| {
        let x = i as f32 * 0.1;
        Triangle::new(Vec3::new(x, 0.0, 5.0), Vec3::new(x + 1e-4, 4.0, 5.0), Vec3::new(x, 4.0, 5.5))
    }));
    triangles.extend(icosphere(1).triangles());
    triangles.extend(statue(300).triangles());
    let mut source = Seeded::new(37);
    let rays: Vec<_> = (0..6000)
        .map(|_| {
            let around = if source.one_in(2) { 0.0 } else { 1000.0 };
            let elsewhere = around + 8.0 * p(source.signed(), source.signed(), source.signed());
            (ray_at(&triangles, elsewhere, &mut source), Known::Unspecified)
        })
        .collect();
    Case::new("aligned, offset, thin and round", triangles, rays)
}

/// Axis-parallel squares on a lattice, many of them coplanar.
fn shelves() -> Vec<Triangle> {
    let mut triangles = Vec::new();
    for i in 0..4 {
        for j in 0..4 {
            let (a, b) = (f64::from(i), f64::from(j));
            triangles.extend(quad(
                p(a, b, 0.0),
                p(a + 1.0, b, 0.0),
                p(a + 1.0, b + 1.0, 0.0),
                p(a, b + 1.0, 0.0),
            ));
            triangles.extend(quad(
                p(a, 2.0, b),
                p(a + 1.0, 2.0, b),
                p(a + 1.0, 2.0, b + 1.0),
                p(a, 2.0, b + 1.0),
            ));
            triangles.extend(quad(p(b, a, b), p(b, a + 1.0, b), p(b, a + 1.0, b + 1.0), p(b, a, b + 1.0)));
        }
    }
    triangles
}
