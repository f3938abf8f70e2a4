//! parry3d: the triangle mesh of a collision library.

use crate::measure::timed;
use crate::peer::{Build, Entry, Family, Found, Peer, Trial, one_by_one};
use crate::rays::RaySet;
use crate::scenes::Indexed;
use anyhow::Result;
use globillum::geom::Ray;
use parry3d::math::Vector;
use parry3d::query::{Ray as ParryRay, RayCast};
use parry3d::shape::{CompositeShapeRef, TriMesh};

pub(crate) fn build(mesh: &Indexed) -> Result<Entry> {
    let vertices: Vec<_> = mesh.vertices.iter().map(|&v| Vector::from_array(v)).collect();
    let faces = mesh.faces.clone();
    let (built, seconds) = timed(|| TriMesh::new(vertices, faces));
    let built = built?;
    let bytes =
        built.bvh().total_memory_size() + size_of_val(built.vertices()) + size_of_val(built.indices());
    Ok(Entry {
        family: Family::RustCrate,
        structure: "parry3d",
        mode: String::new(),
        build: Build { seconds, bytes: Some(bytes) },
        peer: Box::new(Mesh(built)),
    })
}

struct Mesh(TriMesh);

impl Mesh {
    fn nearest(&self, (ray, t_max): &(ParryRay, f32)) -> Found {
        CompositeShapeRef(&self.0).cast_local_ray(ray, *t_max, false)
    }

    /// Reports any hit at `t = 0`, so that the query ends: no hit can be closer.
    fn blocked(&self, (ray, t_max): &(ParryRay, f32)) -> bool {
        let meets = |i, _| self.0.triangle(i).cast_local_ray(ray, *t_max, false).map(|_| 0.0);
        self.0.bvh().cast_ray(ray, *t_max, meets).is_some_and(|(_, t)| t == 0.0)
    }
}

impl Peer for Mesh {
    fn closest<'a>(&'a self, rays: &RaySet) -> Box<dyn Trial + 'a> {
        one_by_one(rays, layout_ray, |ray| self.nearest(ray))
    }

    fn any<'a>(&'a self, rays: &RaySet) -> Box<dyn Trial + 'a> {
        one_by_one(rays, layout_ray, |ray| self.blocked(ray))
    }
}

/// Converts a ray. The crate requires a finite end, so an infinite `t_max` becomes the largest finite number.
fn layout_ray(ray: &Ray) -> (ParryRay, f32) {
    let [origin, direction] = [ray.origin, ray.direction].map(|v| Vector::from_array(v.as_vec3().to_array()));
    (ParryRay::new(origin, direction), (ray.t_max as f32).min(f32::MAX))
}
