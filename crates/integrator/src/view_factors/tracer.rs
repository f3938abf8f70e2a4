use super::row::{Entry, Row};
use super::{FactorSettings, Patches};
use crate::checked_accel;
use crate::sampler::{Member, SobolPoint};
use glam::DVec3;
use globillum_geom::{Accel, Frame, Hit, Ray, SimdLevel, Triangle, Triangles};
use globillum_material::Sides;
use globillum_material::warp::CosineHemisphere;

/// Traces the rays of patches.
#[derive(Debug)]
pub(super) struct Tracer<'a, A: ?Sized> {
    triangles: &'a Triangles,
    accel: &'a A,
    patches: &'a Patches,
    settings: &'a FactorSettings,
    /// The normal of each triangle; NaN for a degenerate one, which is never hit.
    normals: Vec<DVec3>,
    /// The faces of all patches, one patch after the other.
    faces: Vec<Face>,
    /// Where the faces of each patch begin, and where the last ones end.
    starts: Vec<usize>,
    simd: SimdLevel,
}

/// A side of a triangle from which rays leave.
#[derive(Clone, Copy, Debug)]
struct Face {
    triangle: u32,
    is_back: bool,
    /// The area of this face and of those before it in its patch.
    area_sum: f64,
}

/// Buffers of a worker thread.
#[derive(Debug, Default)]
pub(super) struct Buffers {
    rays: Vec<Ray>,
    hits: Vec<Option<Hit>>,
    /// Hits of each column in the current pass; 0 in all columns but those of `touched`.
    counts: Vec<u64>,
    touched: Vec<u32>,
}

/// Rays in a batch.
const RAYS_AT_ONCE: u32 = 1024;
/// Rays whose random numbers are computed at once.
const NUMBERS_AT_ONCE: usize = 8;

impl<'a, A: Accel + ?Sized> Tracer<'a, A> {
    /// A tracer for patches that are those of `triangles`, none of which is empty.
    pub(super) fn new(
        triangles: &'a Triangles,
        accel: &'a A,
        patches: &'a Patches,
        settings: &'a FactorSettings,
    ) -> Self {
        let mut sorted = triangles.live().to_vec();
        sorted.sort_by_key(|&triangle| patches.ids()[triangle as usize]);
        let (mut faces, mut starts) = (Vec::new(), Vec::new());
        for patch in sorted.chunk_by(|&a, &b| patches.ids()[a as usize] == patches.ids()[b as usize]) {
            starts.push(faces.len());
            let mut area_sum = 0.0;
            for &triangle in patch {
                let area = triangles.get(triangle).area();
                area_sum += area;
                faces.push(Face { triangle, is_back: false, area_sum });
                if settings.sides == Sides::Both {
                    area_sum += area;
                    faces.push(Face { triangle, is_back: true, area_sum });
                }
            }
        }
        starts.push(faces.len());
        let normals = triangles.as_slice().iter().map(Triangle::normal).collect();
        Self { triangles, accel, patches, settings, normals, faces, starts, simd: SimdLevel::best() }
    }

    /// The hits of the rays of one pass of a patch.
    pub(super) fn trace(&self, patch: u32, pass: u32, buffers: &mut Buffers) -> Row {
        let Buffers { rays, hits, counts, touched } = buffers;
        counts.resize(self.patches.len() + 2, 0);
        let pass_rays = self.settings.pass_rays;
        for first in (0..pass_rays).step_by(RAYS_AT_ONCE as usize) {
            rays.clear();
            self.spawn(patch, pass, first..pass_rays.min(first + RAYS_AT_ONCE), rays);
            checked_accel::intersect(self.accel, rays, hits);
            for (ray, hit) in rays.iter().zip(hits.iter()) {
                let column = self.column(ray, hit.as_ref());
                let count = &mut counts[column as usize];
                if *count == 0 {
                    touched.push(column);
                }
                *count += 1;
            }
        }
        touched.sort_unstable();
        let entry = |column: u32| {
            let hits = std::mem::take(&mut counts[column as usize]);
            Entry { column, hits, squares: hits * hits }
        };
        touched.drain(..).map(entry).collect()
    }

    /// Appends the rays of these samples of a pass.
    fn spawn(&self, patch: u32, pass: u32, samples: std::ops::Range<u32>, rays: &mut Vec<Ray>) {
        let digits = self.settings.pass_rays.trailing_zeros();
        let member = Member::alone(patch.into());
        let faces = &self.faces[self.starts[patch as usize]..self.starts[patch as usize + 1]];
        self.simd.run(
            #[inline(always)]
            || {
                for first in samples.clone().step_by(NUMBERS_AT_ONCE) {
                    let point = SobolPoint::new(self.settings.seed, member, pass, first, digits);
                    let numbers = point.hypercube::<NUMBERS_AT_ONCE>();
                    for i in 0..NUMBERS_AT_ONCE.min((samples.end - first) as usize) {
                        rays.push(self.ray(faces, numbers.map(|axis| axis[i])));
                    }
                }
            },
        );
    }

    /// The ray of the random numbers `u` in `[0, 1)^4`, from a point that is uniform on the faces, in a direction
    /// distributed by the cosine.
    #[inline(always)]
    fn ray(&self, faces: &[Face], u: [f64; 4]) -> Ray {
        let (face, chosen) = choose(faces, u[2]);
        let (v, w) = Triangle::sample_uniform([chosen, u[3]]);
        let front = self.normals[face.triangle as usize];
        let normal = if face.is_back { -front } else { front };
        let direction = Frame::around(normal).to_world(CosineHemisphere::sample([u[0], u[1]]));
        self.triangles.surface_point_with_normal(face.triangle, front, v, w).spawn_ray(direction)
    }

    /// The column in which a ray is counted.
    fn column(&self, ray: &Ray, hit: Option<&Hit>) -> u32 {
        let patches = self.patches.len() as u32;
        let Some(hit) = hit else { return patches };
        let meets_front = self.normals[hit.triangle as usize].dot(ray.direction) < 0.0;
        let radiates = meets_front || self.settings.sides == Sides::Both;
        if radiates { self.patches.ids()[hit.triangle as usize] } else { patches + 1 }
    }
}

/// The face that `u` in `[0, 1)` chooses with a probability in proportion to its area, and what is left of `u`, again
/// uniform in `[0, 1)`. Unlike an alias table this keeps the order of `u`, and so its stratification.
#[inline(always)]
fn choose(faces: &[Face], u: f64) -> (Face, f64) {
    let last = faces.len() - 1;
    let target = u * faces[last].area_sum;
    let index = faces.partition_point(|face| face.area_sum <= target).min(last);
    let below = if index == 0 { 0.0 } else { faces[index - 1].area_sum };
    let left = (target - below) / (faces[index].area_sum - below);
    (faces[index], left.min(1.0_f64.next_down()))
}
