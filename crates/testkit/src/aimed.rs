//! Rays aimed at triangles, at slivers, and at the edges and vertices of a closed mesh. An index determines each
//! ray.

use crate::precision::Precision;
use crate::shapes::icosphere;
use glam::{DVec3, Vec3};
use globillum_geom::conformance::Target;
use globillum_geom::{Ray, Triangle};
use globillum_integrator::Stream;

/// A ray and the triangle it is aimed at.
#[derive(Clone, Copy, Debug)]
pub struct Aimed {
    /// The ray; the aimed-at point is at `t = 1`.
    pub ray: Ray,
    /// The triangle.
    pub triangle: Triangle,
}

/// The stream of random numbers of each family of cases.
#[derive(Clone, Copy)]
enum Family {
    Ordinary,
    Sliver,
    Mesh,
}

impl Family {
    fn stream(self, seed: u64, index: u32) -> Stream {
        Stream::new(seed, u64::from(index), self as u32)
    }
}

/// A triangle with corners anywhere in the cube of half side one, and a ray from the cube of half
/// side two toward a point of it. A few such triangles are slim or seen edge-on.
///
/// All numbers are representable in `f32`, so that every intersector gets the same input.
pub fn ordinary(seed: u64, index: u32) -> Aimed {
    let random = Family::Ordinary.stream(seed, index);
    let triangle = Triangle { vertices: [0, 3, 6].map(|d| in_cube(&random, d).as_vec3()) };
    let origin = (2.0 * in_cube(&random, 9)).as_vec3().as_dvec3();
    let (u, v) = Triangle::sample_uniform(random.uniform_pair(12));
    Aimed { ray: Precision::Single.round(&toward(interpolate(&triangle, u, v), origin)), triangle }
}

/// A needle of unit length and of the given `width`, and a ray from the cube of half side two
/// toward its centroid.
///
/// The needle's short side lies next to the world's origin, where `f32` numbers are dense enough
/// to represent it.
pub fn sliver(width: f64, seed: u64, index: u32) -> Aimed {
    let random = Family::Sliver.stream(seed, index);
    let tip = in_cube(&random, 0).normalize();
    let across = tip.cross(in_cube(&random, 3)).normalize();
    let half = 0.5 * width * across;
    let triangle = Triangle { vertices: [-half, half, tip].map(|v| v.as_vec3()) };
    let centroid = interpolate(&triangle, 1.0 / 3.0, 1.0 / 3.0);
    Aimed { ray: toward(centroid, 2.0 * in_cube(&random, 6)), triangle }
}

/// The triangle of the [ordinary] case, and a ray toward its centroid at `elevation` radians above
/// its plane.
pub fn edge_on(elevation: f64, seed: u64, index: u32) -> Aimed {
    let Aimed { ray, triangle } = ordinary(seed, index);
    let normal = triangle.normal();
    let in_plane = ray.direction.reject_from_normalized(normal).normalize();
    let direction = elevation.cos() * in_plane - elevation.sin() * normal;
    Aimed { ray: Ray::new(interpolate(&triangle, 1.0 / 3.0, 1.0 / 3.0) - direction, direction), triangle }
}

/// A closed mesh of 1280 triangles around a ball, from which no ray should escape.
#[derive(Clone, Debug)]
pub struct Ball {
    /// The mesh, vertices rounded to `f32`.
    pub triangles: Vec<Triangle>,
    center: DVec3,
    radius: f64,
}

impl Ball {
    /// The ball of this `center` and `radius`.
    pub fn new(center: DVec3, radius: f64) -> Self {
        let triangles = icosphere(3).placed(radius, center).triangles();
        Self { triangles, center, radius }
    }

    /// A ray from inside the ball toward an edge or vertex. Its origin is representable in `f32`.
    pub fn ray_at(&self, target: Target, seed: u64, index: u32) -> Ray {
        let random = Family::Mesh.stream(seed, index);
        // The cube's corners are 0.87 radii from the center, the mesh is never nearer than 0.98.
        let origin = (self.center + 0.5 * self.radius * in_cube(&random, 0)).as_vec3().as_dvec3();
        let triangle = &self.triangles[choose(&random, 3, self.triangles.len())];
        let first = choose(&random, 4, 3);
        let [a, b] = [first, (first + 1) % 3].map(|i| triangle.vertices[i].as_dvec3());
        let at = match target {
            Target::Edges => a.lerp(b, random.uniform(5)),
            Target::Vertices => a,
        };
        toward(at, origin)
    }
}

/// A point of the cube from -1 to 1, from three dimensions of `random`.
fn in_cube(random: &Stream, dimension: u32) -> DVec3 {
    DVec3::from([0, 1, 2].map(|i| 2.0 * random.uniform(dimension + i) - 1.0))
}

fn choose(random: &Stream, dimension: u32, count: usize) -> usize {
    (random.uniform(dimension) * count as f64) as usize
}

/// The ray from `origin` that is at `target` when `t = 1`, without end.
fn toward(target: DVec3, origin: DVec3) -> Ray {
    Ray::new(origin, target - origin)
}

/// The point of `triangle` with barycentrics `u` and `v`.
pub fn interpolate(triangle: &Triangle, u: f64, v: f64) -> DVec3 {
    let [v0, v1, v2] = triangle.vertices.map(|v: Vec3| v.as_dvec3());
    (1.0 - u - v) * v0 + u * v1 + v * v2
}
