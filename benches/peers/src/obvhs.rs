//! obvhs: a compressed eight-wide hierarchy and a binary one, both built with the preset that traces fastest.

use crate::measure::timed;
use crate::peer::{Build, Entry, Family, Found, Peer, Trial, one_by_one};
use crate::rays::RaySet;
use globillum::geom::{Ray, Triangles};
use obvhs::BvhBuildParams;
use obvhs::bvh2::{Bvh2, builder::build_bvh2_from_tris};
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh_from_tris};
use obvhs::ray::RayHit;
use obvhs::rt_triangle::RtTriangle;
use obvhs::triangle::Triangle;
use std::time::Duration;

const PRESET: BvhBuildParams = BvhBuildParams::very_slow_build();

pub(crate) fn build(triangles: &Triangles) -> [Entry; 2] {
    let triangles: Vec<_> = triangles.as_slice().iter().map(|t| layout_triangle(&t.vertices)).collect();
    let wide = || Tree::new(build_cwbvh_from_tris(&triangles, PRESET, &mut Duration::default()), &triangles);
    let binary = || Tree::new(build_bvh2_from_tris(&triangles, PRESET, &mut Duration::default()), &triangles);
    [entry("obvhs CWBVH", timed(wide)), entry("obvhs BVH2", timed(binary))]
}

fn entry<B: Hierarchy + 'static>(structure: &'static str, (tree, seconds): (Tree<B>, f64)) -> Entry {
    let bytes = tree.bvh.bytes() + size_of_val(&*tree.leaves);
    let build = Build { seconds, bytes: Some(bytes) };
    Entry { family: Family::RustCrate, structure, mode: String::new(), build, peer: Box::new(tree) }
}

/// The common interface of the crate's two hierarchies, which share no trait.
trait Hierarchy {
    fn indices(&self) -> &[u32];
    fn bytes(&self) -> usize;
    fn nearest(&self, ray: obvhs::ray::Ray, hit: &mut RayHit, leaves: &[RtTriangle]) -> bool;
    fn misses(&self, ray: obvhs::ray::Ray, leaves: &[RtTriangle]) -> bool;
}

macro_rules! impl_hierarchy {
    ($tree:ty) => {
        impl Hierarchy for $tree {
            fn indices(&self) -> &[u32] {
                &self.primitive_indices
            }
            fn bytes(&self) -> usize {
                size_of_val(&*self.nodes) + size_of_val(&*self.primitive_indices)
            }
            fn nearest(&self, ray: obvhs::ray::Ray, hit: &mut RayHit, leaves: &[RtTriangle]) -> bool {
                self.ray_traverse(ray, hit, |ray, i| leaves[i].intersect(ray))
            }
            fn misses(&self, ray: obvhs::ray::Ray, leaves: &[RtTriangle]) -> bool {
                self.ray_traverse_miss(ray, |ray, i| leaves[i].intersect(ray))
            }
        }
    };
}

impl_hierarchy!(CwBvh);
impl_hierarchy!(Bvh2);

struct Tree<B> {
    bvh: B,
    /// In the order of the hierarchy's leaves, which saves an indirection.
    leaves: Vec<RtTriangle>,
}

impl<B: Hierarchy> Tree<B> {
    fn new(bvh: B, triangles: &[Triangle]) -> Self {
        let leaves = bvh.indices().iter().map(|&i| (&triangles[i as usize]).into()).collect();
        Self { bvh, leaves }
    }

    fn nearest(&self, ray: &obvhs::ray::Ray) -> Found {
        let mut hit = RayHit::none();
        let found = self.bvh.nearest(*ray, &mut hit, &self.leaves);
        found.then(|| (self.bvh.indices()[hit.primitive_id as usize], hit.t))
    }
}

impl<B: Hierarchy> Peer for Tree<B> {
    fn closest<'a>(&'a self, rays: &RaySet) -> Box<dyn Trial + 'a> {
        one_by_one(rays, layout_ray, |ray| self.nearest(ray))
    }

    fn any<'a>(&'a self, rays: &RaySet) -> Box<dyn Trial + 'a> {
        one_by_one(rays, layout_ray, |ray| !self.bvh.misses(*ray, &self.leaves))
    }
}

pub(crate) fn layout_triangle(vertices: &[globillum::glam::Vec3; 3]) -> Triangle {
    let [v0, v1, v2] = vertices.map(Into::into);
    Triangle { v0, v1, v2 }
}

pub(crate) fn layout_ray(ray: &Ray) -> obvhs::ray::Ray {
    let [origin, direction] = [ray.origin, ray.direction].map(|v| v.as_vec3a());
    obvhs::ray::Ray::new(origin, direction, ray.t_min as f32, ray.t_max as f32)
}
