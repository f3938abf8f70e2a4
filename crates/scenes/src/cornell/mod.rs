//! The Cornell box: a white room with a red and a green wall under a warm light.
//!
//! The room is 2 units wide, high and deep around the origin, and open towards +z, from where
//! [`camera`] looks in; +y is up. Lights emit downward only. [`hall_with_statues`] is a larger scene for
//! measurements, with a camera of its own. Radiance and albedo are linear Rec. 709.

mod hall;
mod sculptures;
mod statues;

use glam::{DQuat, DVec3};
use globillum_geom::shapes::{cuboid, quad};
use globillum_geom::{Aabb, Triangle};
use globillum_integrator::{Model, PinholeCamera, RenderError};
use globillum_material::{Material, MaterialError, Rgb};

pub use hall::{camera as hall_camera, with_statues as hall_with_statues};
pub use sculptures::{knot, pine_cone};
pub use statues::with_two;

const WHITE: Rgb = Rgb::splat(0.73);
const RED: Rgb = Rgb::new(0.63, 0.065, 0.05);
const GREEN: Rgb = Rgb::new(0.14, 0.45, 0.091);
const LIGHT: Rgb = Rgb::new(17.0, 12.0, 4.0);

/// The albedo of a diffuse mesh in the box.
pub const CLAY: Rgb = Rgb::new(0.6, 0.5, 0.4);
/// The reflectance of mirrors in the box.
pub const SILVER: Rgb = Rgb::splat(0.95);

/// The camera in front of the box, with a vertical field of view of 39.3 degrees: in a square picture the
/// box fills the view.
///
/// # Errors
/// Never: all constants are in range. The type is that of [`PinholeCamera::look_at`].
pub fn camera() -> Result<PinholeCamera, RenderError> {
    PinholeCamera::look_at(DVec3::new(0.0, 0.0, 3.9), DVec3::ZERO, DVec3::Y, 39.3_f64.to_radians())
}

/// The empty box: five walls and the light.
///
/// # Errors
/// Never: all constants are in range. The type is that of the materials' constructors.
pub fn room() -> Result<Model, MaterialError> {
    let mut model = walls()?;
    model.add(Material::light(LIGHT)?, light(DVec3::new(0.0, 0.995, 0.0), 0.25, 0.2));
    Ok(model)
}

/// A rectangle around `center` that faces down, given its half sides along x and z.
fn light(center: DVec3, x: f64, z: f64) -> [Triangle; 2] {
    let corner = |dx: f64, dz: f64| center + DVec3::new(dx * x, 0.0, dz * z);
    quad(corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0))
}

fn walls() -> Result<Model, MaterialError> {
    let p = DVec3::new;
    let mut model = Model::default();
    let mut wall = |albedo, a, b, c, d| -> Result<(), MaterialError> {
        model.add(Material::lambert(albedo)?, quad(a, b, c, d));
        Ok(())
    };
    let (lo, hi) = (-1.0, 1.0);
    wall(WHITE, p(lo, lo, hi), p(hi, lo, hi), p(hi, lo, lo), p(lo, lo, lo))?; // floor
    wall(WHITE, p(lo, hi, lo), p(hi, hi, lo), p(hi, hi, hi), p(lo, hi, hi))?; // ceiling
    wall(WHITE, p(lo, lo, lo), p(hi, lo, lo), p(hi, hi, lo), p(lo, hi, lo))?; // back
    wall(RED, p(lo, lo, hi), p(lo, lo, lo), p(lo, hi, lo), p(lo, hi, hi))?; // left
    wall(GREEN, p(hi, lo, lo), p(hi, lo, hi), p(hi, hi, hi), p(hi, hi, lo))?; // right
    Ok(model)
}

/// The box with a tall block, which is a mirror if `specular`, and a short one.
///
/// # Errors
/// Never: all constants are in range. The type is that of the materials' constructors.
pub fn with_blocks(specular: bool) -> Result<Model, MaterialError> {
    let mut model = room()?;
    let tall = cuboid(DVec3::new(-0.33, -0.4, -0.28), DVec3::new(0.3, 0.6, 0.3), 0.32);
    model.add(object_material(specular, WHITE)?, tall);
    let short = cuboid(DVec3::new(0.335, -0.7, 0.38), DVec3::splat(0.3), -0.3);
    model.add(Material::lambert(WHITE)?, short);
    Ok(model)
}

/// The box with `mesh` standing on its floor, 1.1 units along the longest side and turned by 0.3 radians;
/// an ideal mirror if `specular`. The mesh must [have an extent](has_extent).
///
/// # Errors
/// Never: all constants are in range. The type is that of the materials' constructors.
pub fn with_mesh(mesh: &[Triangle], specular: bool) -> Result<Model, MaterialError> {
    let mut model = room()?;
    let placed = stand(mesh, 1.1, DVec3::new(0.0, -1.0, 0.0), 0.3);
    model.add(object_material(specular, CLAY)?, placed);
    Ok(model)
}

fn object_material(specular: bool, albedo: Rgb) -> Result<Material, MaterialError> {
    if specular { Material::mirror(SILVER) } else { Material::lambert(albedo) }
}

/// Whether `mesh` has a size that [`stand`] can scale: two vertices at least are different points.
pub fn has_extent(mesh: &[Triangle]) -> bool {
    Aabb::around(mesh.iter().flat_map(|t| t.vertices)).extent().max_element() > 0.0
}

/// Places a copy of `mesh`: scaled to `size` along the longest side of its bounds, turned by `yaw` radians
/// about the y axis, its middle above `place` and its lowest point at the height of `place`.
///
/// The mesh must [have an extent](has_extent): otherwise vertices are not finite.
pub fn stand(mesh: &[Triangle], size: f64, place: DVec3, yaw: f64) -> Vec<Triangle> {
    let bounds = Aabb::around(mesh.iter().flat_map(|t| t.vertices));
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let (middle, scale) = ((min + max) / 2.0, size / (max - min).max_element());
    // `libm` gives the same bits on every platform.
    let (sin, cos) = libm::sincos(0.5 * yaw);
    let turn = DQuat::from_xyzw(0.0, sin, 0.0, cos);
    let lift = place + DVec3::Y * (scale * (middle.y - min.y));
    let at = |v: glam::Vec3| (lift + turn * ((v.as_dvec3() - middle) * scale)).as_vec3();
    mesh.iter().map(|t| Triangle { vertices: t.vertices.map(at) }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// FNV-1a over the bits of all vertices.
    fn hash(model: &Model) -> u64 {
        let numbers = model.triangles().iter().flat_map(|t| t.vertices).flat_map(|v| v.to_array());
        let bytes = numbers.flat_map(|x| x.to_bits().to_le_bytes());
        bytes
            .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
    }

    /// The scenes are made with `libm` and not with the platform's functions, so their bits are the same everywhere.
    #[test]
    fn scenes_have_the_same_bits_on_every_platform() {
        let scenes = [
            with_blocks(false).unwrap(),
            with_mesh(&knot(100_000), false).unwrap(),
            with_two(&knot(50_000), &knot(50_000)).unwrap(),
            with_mesh(&pine_cone(100_000), true).unwrap(),
            hall_with_statues(&[knot(1000), pine_cone(1000)]).unwrap(),
        ];
        let found = scenes.each_ref().map(hash);
        let expected = [
            0xcba1_19a6_bfbd_cabd,
            0xac0e_9bd0_cf1e_be39,
            0x635f_d12c_a69c_b095,
            0x393f_ddda_1bc6_ddca,
            0x6aa1_d07c_7531_acb3,
        ];
        assert_eq!(found, expected, "{found:#018x?}");
    }
}
