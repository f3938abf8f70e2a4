//! bvh: a binary hierarchy, traversed by the crate's own iterator.

use crate::measure::timed;
use crate::obvhs::{layout_ray, layout_triangle};
use crate::peer::{Build, Entry, Family, Found, Peer, Trial, one_by_one};
use crate::rays::RaySet;
use bvh::aabb::{Aabb, Bounded, IntersectsAabb};
use bvh::bounding_hierarchy::BHShape;
use bvh::bvh::{Bvh, BvhNode};
use globillum::geom::{Ray, Triangle, Triangles};
use nalgebra::Point3;
use obvhs::rt_triangle::RtTriangle;
use std::cell::Cell;

pub(crate) fn build(triangles: &Triangles) -> Entry {
    let mut shapes: Vec<_> = (0..).zip(triangles.as_slice()).map(Shape::new).collect();
    let (bvh, seconds) = timed(|| Bvh::build(&mut shapes));
    let bytes = bvh.nodes.len() * size_of::<BvhNode<f32, 3>>() + size_of_val(&*shapes);
    Entry {
        family: Family::RustCrate,
        structure: "bvh",
        mode: String::new(),
        build: Build { seconds, bytes: Some(bytes) },
        peer: Box::new(Tree { bvh, shapes }),
    }
}

struct Tree {
    bvh: Bvh<f32, 3>,
    shapes: Vec<Shape>,
}

/// A triangle. The crate's own triangle test hits front faces only; obvhs's test hits both.
struct Shape {
    triangle: RtTriangle,
    bounds: Aabb<f32, 3>,
    index: u32,
    node: usize,
}

impl Shape {
    fn new((index, triangle): (u32, &Triangle)) -> Self {
        let bounds = triangle.bounds();
        let [low, high] = [bounds.min, bounds.max].map(|v| Point3::from(v.to_array()));
        let triangle = (&layout_triangle(&triangle.vertices)).into();
        Self { triangle, bounds: Aabb::with_bounds(low, high), index, node: 0 }
    }
}

impl Bounded<f32, 3> for Shape {
    fn aabb(&self) -> Aabb<f32, 3> {
        self.bounds
    }
}

impl BHShape<f32, 3> for Shape {
    fn set_bh_node_index(&mut self, node: usize) {
        self.node = node;
    }

    fn bh_node_index(&self) -> usize {
        self.node
    }
}

/// A ray in the layouts of the box test and of the triangle test.
struct BothRays {
    boxes: bvh::ray::Ray<f32, 3>,
    triangles: obvhs::ray::Ray,
}

impl BothRays {
    fn new(ray: &Ray) -> Self {
        let triangles = layout_ray(ray);
        let direction = triangles.direction.to_array().into();
        // The crate's constructor would normalise the direction and so change the unit of t.
        let boxes = bvh::ray::Ray {
            origin: triangles.origin.to_array().into(),
            direction,
            inv_direction: direction.map(|x| 1.0 / x),
        };
        Self { boxes, triangles }
    }
}

/// A ray whose box test ends at the closest hit so far. The crate's iterator has no other way to shorten a ray.
struct Shrinking<'a> {
    ray: &'a bvh::ray::Ray<f32, 3>,
    t_max: Cell<f32>,
}

impl IntersectsAabb<f32, 3> for Shrinking<'_> {
    fn intersects_aabb(&self, aabb: &Aabb<f32, 3>) -> bool {
        self.ray.intersection_slice_for_aabb(aabb).is_some_and(|(enter, _)| enter <= self.t_max.get())
    }
}

impl Tree {
    fn nearest(&self, ray: &BothRays) -> Found {
        let mut found = None;
        let mut rest = ray.triangles;
        let query = Shrinking { ray: &ray.boxes, t_max: rest.tmax.into() };
        for shape in self.bvh.traverse_iterator(&query, &self.shapes) {
            let t = shape.triangle.intersect(&rest);
            if t < rest.tmax {
                rest.tmax = t;
                query.t_max.set(t);
                found = Some((shape.index, t));
            }
        }
        found
    }

    fn blocked(&self, ray: &BothRays) -> bool {
        let query = Shrinking { ray: &ray.boxes, t_max: ray.triangles.tmax.into() };
        let meets = |shape: &Shape| shape.triangle.intersect(&ray.triangles) < ray.triangles.tmax;
        self.bvh.traverse_iterator(&query, &self.shapes).any(meets)
    }
}

impl Peer for Tree {
    fn closest<'a>(&'a self, rays: &RaySet) -> Box<dyn Trial + 'a> {
        one_by_one(rays, BothRays::new, |ray| self.nearest(ray))
    }

    fn any<'a>(&'a self, rays: &RaySet) -> Box<dyn Trial + 'a> {
        one_by_one(rays, BothRays::new, |ray| self.blocked(ray))
    }
}
