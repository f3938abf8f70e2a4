//! A hall with two rows of statues, a mirror as its right wall, a tiled floor, and two strings of lights.

use super::{CLAY, GREEN, RED, SILVER, WHITE, stand};
use glam::DVec3;
use globillum_geom::Triangle;
use globillum_geom::shapes::{cuboid, icosphere, quad};
use globillum_integrator::{Model, PinholeCamera, RenderError};
use globillum_material::{Material, MaterialError, Rgb};

const LOW: DVec3 = DVec3::new(-2.0, 0.0, -8.0);
const HIGH: DVec3 = DVec3::new(2.0, 2.6, 2.5);

/// Side of a tile of the floor, and its two colours.
const TILE: f64 = 0.5;
const TILES: [Rgb; 2] = [Rgb::splat(0.75), Rgb::new(0.16, 0.15, 0.17)];

/// Where rows of statues stand, from the entrance on.
const ROWS: [f64; 4] = [-0.6, -2.5, -4.4, -6.3];
/// What statues are made of, in turn; the last is a mirror.
const CLAYS: [Rgb; 3] = [CLAY, Rgb::new(0.35, 0.45, 0.6), Rgb::new(0.65, 0.6, 0.3)];

/// A string of lights on each side of the aisle: how many, and how far they are apart.
const LIGHTS: usize = 12;
const SPACING: f64 = 0.8;
const LIGHT_RADIUS: f64 = 0.1;
const WARM: Rgb = Rgb::new(11.0, 6.6, 2.9);
const COOL: Rgb = Rgb::new(3.6, 6.0, 9.9);

/// The camera of [`hall_with_statues`](super::hall_with_statues), at the entrance: it looks down the aisle.
///
/// # Errors
/// Never: all constants are in range. The type is that of [`PinholeCamera::look_at`].
pub fn camera() -> Result<PinholeCamera, RenderError> {
    PinholeCamera::look_at(DVec3::new(-0.35, 1.2, 2.45), DVec3::new(0.3, 0.9, -2.0), DVec3::Y, 0.95)
}

/// A hall with eight statues, which are copies of `meshes` in turn (none if there are no meshes), a mirror as
/// its right wall, and 7,680 light triangles in 24 small spheres. It reaches from z = 2.5 to z = -8. The meshes
/// must [have an extent](super::has_extent).
///
/// # Errors
/// Never: all constants are in range. The type is that of the materials' constructors.
pub fn with_statues(meshes: &[Vec<Triangle>]) -> Result<Model, MaterialError> {
    let mut model = walls()?;
    lay_tiles(&mut model)?;
    for (x, radiance) in [(-0.62, WARM), (0.62, COOL)] {
        hang_lights(&mut model, x, radiance)?;
    }
    let places = ROWS.iter().flat_map(|&z| [-1.2, 1.2].map(|x| DVec3::new(x, 0.0, z)));
    for ((number, place), mesh) in places.enumerate().zip(meshes.iter().cycle()) {
        let pedestal = cuboid(place + DVec3::Y * 0.2, DVec3::new(0.35, 0.2, 0.35), 0.0);
        model.add(Material::lambert(WHITE)?, pedestal);
        let material = match CLAYS.get(number % (CLAYS.len() + 1)) {
            Some(&albedo) => Material::lambert(albedo)?,
            None => Material::mirror(SILVER)?,
        };
        model.add(material, stand(mesh, 1.0, place + DVec3::Y * 0.4, 0.7 * number as f64));
    }
    Ok(model)
}

fn walls() -> Result<Model, MaterialError> {
    let corner = |x: bool, y: bool, z: bool| {
        let pick = |high, low: f64, up: f64| if high { up } else { low };
        DVec3::new(pick(x, LOW.x, HIGH.x), pick(y, LOW.y, HIGH.y), pick(z, LOW.z, HIGH.z))
    };
    let (o, i) = (false, true);
    let mut model = Model::default();
    let mut wall = |material, [a, b, c, d]: [DVec3; 4]| model.add(material, quad(a, b, c, d));
    let ceiling = [corner(o, i, o), corner(i, i, o), corner(i, i, i), corner(o, i, i)];
    let back = [corner(o, o, o), corner(i, o, o), corner(i, i, o), corner(o, i, o)];
    let front = [corner(i, o, i), corner(o, o, i), corner(o, i, i), corner(i, i, i)];
    let left = [corner(o, o, i), corner(o, o, o), corner(o, i, o), corner(o, i, i)];
    let right = [corner(i, o, o), corner(i, o, i), corner(i, i, i), corner(i, i, o)];
    wall(Material::lambert(WHITE)?, ceiling);
    wall(Material::lambert(GREEN)?, back);
    wall(Material::lambert(WHITE)?, front);
    wall(Material::lambert(RED)?, left);
    wall(Material::mirror(SILVER)?, right);
    Ok(model)
}

/// The floor, light and dark as a chessboard.
fn lay_tiles(model: &mut Model) -> Result<(), MaterialError> {
    let [columns, rows] = [HIGH.x - LOW.x, HIGH.z - LOW.z].map(|length| (length / TILE) as usize);
    for (colour, albedo) in TILES.into_iter().enumerate() {
        let mine = (0..rows * columns).filter(|i| (i / columns + i % columns) % 2 == colour);
        let tiles = mine.flat_map(|i| {
            let near = DVec3::new(LOW.x, 0.0, HIGH.z)
                + TILE * DVec3::new((i % columns) as f64, 0.0, -((i / columns) as f64));
            let (x, z) = (TILE * DVec3::X, TILE * DVec3::NEG_Z);
            quad(near, near + x, near + x + z, near + z)
        });
        model.add(Material::lambert(albedo)?, tiles);
    }
    Ok(())
}

/// A string of little spheres along the hall.
fn hang_lights(model: &mut Model, x: f64, radiance: Rgb) -> Result<(), MaterialError> {
    let sphere = icosphere(2);
    for number in 0..LIGHTS {
        // The string sags between its ends, about as a chain does.
        let share = number as f64 / (LIGHTS - 1) as f64;
        let sag = 1.4 * share * (1.0 - share);
        let place = DVec3::new(x, 2.3 - sag, 1.2 - SPACING * number as f64);
        model.add(Material::light(radiance)?, sphere.clone().placed(LIGHT_RADIUS, place).triangles());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cornell::knot;

    #[test]
    fn the_hall_has_as_many_light_triangles_as_it_says() {
        let model = with_statues(&[knot(1000)]).unwrap();
        let emits = |id: &u32| !model.materials()[*id as usize].emission.is_black();
        assert_eq!(model.material_ids().iter().filter(|id| emits(id)).count(), 7680);
    }
}
