//! The meshes with their cameras and lights.

use crate::{apartment, procedural};
use anyhow::{Result, ensure};
use globillum::geom::{Aabb, Triangle, Triangles};
use globillum::glam::{DVec3, Vec3};
use globillum::io::load_obj;
use globillum_testkit::shapes;
use std::collections::HashMap;
use std::path::Path;

/// A mesh with a camera and lights. Lights are the targets of shadow rays and not part of the mesh.
pub(crate) struct Scene {
    pub(crate) name: String,
    pub(crate) triangles: Triangles,
    pub(crate) view: View,
    /// At least one. Only the first is the target of [`Kind::Shadow`](crate::rays::Kind::Shadow).
    pub(crate) lights: Vec<Light>,
    /// Whether camera and lights are inside, so that it is traced by an integrator's rays as well.
    pub(crate) is_interior: bool,
}

/// A pinhole camera.
pub(crate) struct View {
    pub(crate) eye: DVec3,
    /// The point in the middle of the picture.
    pub(crate) target: DVec3,
    /// The side of the square around the target that the picture shows.
    pub(crate) width: f64,
}

impl View {
    /// A camera with a full angle of view, in degrees.
    pub(crate) fn of_angle(eye: DVec3, target: DVec3, degrees: f64) -> Self {
        Self { eye, target, width: 2.0 * eye.distance(target) * (degrees.to_radians() / 2.0).tan() }
    }
}

/// A parallelogram.
#[derive(Clone, Copy)]
pub(crate) struct Light {
    pub(crate) center: DVec3,
    pub(crate) edges: [DVec3; 2],
}

impl Light {
    /// A horizontal rectangle of some width and depth.
    pub(crate) fn facing_down(center: DVec3, [width, depth]: [f64; 2]) -> Self {
        Self { center, edges: [width * DVec3::X, depth * DVec3::Z] }
    }
}

/// The procedural scenes, by name.
pub(crate) const PROCEDURAL: [&str; 5] = ["room", "kitchen", "living-room", "terrain", "statue"];

/// The folder of scanned meshes, which are traced by default if they exist.
const SHARED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/meshes");

/// The default meshes: the procedural scenes, and the scanned meshes that exist.
pub(crate) fn defaults() -> Vec<String> {
    let scanned = ["bunny.obj", "dragon.obj"].map(|file| format!("{SHARED}/{file}"));
    let scanned = scanned.into_iter().filter(|file| Path::new(file).exists());
    PROCEDURAL.map(str::to_owned).into_iter().chain(scanned).collect()
}

impl Scene {
    /// The procedural scene of that name, or the OBJ file of that path.
    pub(crate) fn load(name: &str) -> Result<Self> {
        match name {
            "room" => procedural::room(),
            "kitchen" => apartment::kitchen(),
            "living-room" => apartment::living_room(),
            "terrain" => procedural::terrain(708),
            "statue" => around("statue", shapes::statue(70_000).triangles()),
            path => {
                let file = Path::new(path);
                let name = file.file_stem().unwrap_or(file.as_os_str()).to_string_lossy();
                around(&name, load_obj(file)?.model.triangles().to_vec())
            }
        }
    }

    /// The same mesh with a camera and a light of one's own inside.
    pub(crate) fn seen_from(self, view: View, light: Light) -> Self {
        Self { view, lights: vec![light], is_interior: true, ..self }
    }

    /// The largest coordinate in magnitude, of the mesh, the eye and the lights.
    pub(crate) fn reach(&self) -> f64 {
        let Aabb { min, max } = self.triangles.bounds();
        let points = [min.as_dvec3(), max.as_dvec3(), self.view.eye];
        let lights = self.lights.iter().map(|light| light.center);
        points.into_iter().chain(lights).map(|p| p.abs().max_element()).fold(0.0, f64::max)
    }
}

/// A mesh seen from outside, lit from above.
fn around(name: &str, triangles: Vec<Triangle>) -> Result<Scene> {
    let triangles = Triangles::new(triangles)?;
    ensure!(!triangles.live().is_empty(), "{name} has no triangles");
    let bounds = triangles.bounds();
    let middle = (bounds.min.as_dvec3() + bounds.max.as_dvec3()) / 2.0;
    let size = bounds.extent().max_element();
    let eye = middle + DVec3::new(0.3, 0.2, 1.5) * size;
    Ok(Scene {
        name: name.to_owned(),
        triangles,
        view: View { eye, target: middle, width: size },
        lights: vec![Light::facing_down(middle + 1.5 * size * DVec3::Y, [size, size])],
        is_interior: false,
    })
}

/// A mesh with shared vertices, for peers that require it.
pub(crate) struct Indexed {
    pub(crate) vertices: Vec<[f32; 3]>,
    pub(crate) faces: Vec<[u32; 3]>,
}

impl Indexed {
    /// The same triangles in the same order. Vertices with equal bits are shared.
    pub(crate) fn new(triangles: &Triangles) -> Self {
        let mut vertices = Vec::new();
        let mut indices = HashMap::new();
        let mut index = |v: Vec3| {
            let bits = v.to_array().map(f32::to_bits);
            *indices.entry(bits).or_insert_with(|| {
                vertices.push(v.to_array());
                vertices.len() as u32 - 1
            })
        };
        let faces = triangles.as_slice().iter().map(|t| t.vertices.map(&mut index)).collect();
        Self { vertices, faces }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shared_vertices_make_the_same_triangles() {
        let triangles = Triangles::new(shapes::statue(1000).triangles()).expect("the mesh is good");
        let indexed = Indexed::new(&triangles);
        assert!(indexed.vertices.len() < triangles.len());
        for (triangle, face) in triangles.as_slice().iter().zip(&indexed.faces) {
            assert_eq!(triangle.vertices.map(|v| v.to_array()), face.map(|i| indexed.vertices[i as usize]));
        }
    }
}
