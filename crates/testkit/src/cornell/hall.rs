//! A hall twice as wide as it is high, with statues in two rows, a mirror for its right wall, and
//! lamps hanging in the aisle.

use super::{CLAY, GREEN, RED, SILVER, WHITE, stand};
use crate::shapes::{cuboid, icosphere, quad};
use glam::DVec3;
use globillum_geom::Triangle;
use globillum_integrator::{Camera, Model, RenderError};
use globillum_material::{Material, MaterialError, Rgb};

const LOW: DVec3 = DVec3::new(-2.0, 0.0, -8.0);
const HIGH: DVec3 = DVec3::new(2.0, 2.0, 2.0);

/// Where rows of statues stand, from the entrance on.
const ROWS: [f64; 4] = [0.0, -1.9, -3.8, -5.7];
/// What statues are made of, in turn; the last is a mirror.
const CLAYS: [Rgb; 3] = [CLAY, Rgb::new(0.35, 0.45, 0.6), Rgb::new(0.65, 0.6, 0.3)];

/// A string of lamps: how many, and how far they are apart.
const LAMPS: usize = 24;
const SPACING: f64 = 0.33;
const LAMP_RADIUS: f64 = 0.11;
const WARM: Rgb = Rgb::new(7.0, 4.4, 2.0);
const COOL: Rgb = Rgb::new(2.4, 4.0, 6.6);

/// The camera at the entrance, which looks down the aisle.
///
/// # Errors
/// None in fact; the type is that of [`Camera::look_at`].
pub fn camera() -> Result<Camera, RenderError> {
    Camera::look_at(DVec3::new(-0.7, 1.0, 1.95), DVec3::new(0.15, 0.75, -2.0), DVec3::Y, 0.95)
}

/// The hall with copies of `meshes`, in turn, and 7,680 emitting triangles.
///
/// # Errors
/// None in fact; the type is that of the materials' constructors.
pub fn with_statues(meshes: &[Vec<Triangle>]) -> Result<Model, MaterialError> {
    let mut model = walls()?;
    hang_lamps(&mut model)?;
    let places = ROWS.iter().flat_map(|&z| [-1.15, 1.15].map(|x| DVec3::new(x, 0.0, z)));
    for ((number, place), mesh) in places.enumerate().zip(meshes.iter().cycle()) {
        let pedestal = cuboid(place + DVec3::Y * 0.2, DVec3::new(0.35, 0.2, 0.35), 0.0);
        model.add(Material::lambert(WHITE)?, pedestal);
        let material = match CLAYS.get(number % (CLAYS.len() + 1)) {
            Some(&albedo) => Material::lambert(albedo)?,
            None => Material::mirror(SILVER)?,
        };
        model.add(material, stand(mesh, 0.9, place + DVec3::Y * 0.4, 0.7 * number as f64));
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
    let floor = [corner(o, o, i), corner(i, o, i), corner(i, o, o), corner(o, o, o)];
    let ceiling = [corner(o, i, o), corner(i, i, o), corner(i, i, i), corner(o, i, i)];
    let back = [corner(o, o, o), corner(i, o, o), corner(i, i, o), corner(o, i, o)];
    let front = [corner(i, o, i), corner(o, o, i), corner(o, i, i), corner(i, i, i)];
    let left = [corner(o, o, i), corner(o, o, o), corner(o, i, o), corner(o, i, i)];
    let right = [corner(i, o, o), corner(i, o, i), corner(i, i, i), corner(i, i, o)];
    wall(Material::lambert(WHITE)?, floor);
    wall(Material::lambert(WHITE)?, ceiling);
    wall(Material::lambert(GREEN)?, back);
    wall(Material::lambert(WHITE)?, front);
    wall(Material::lambert(RED)?, left);
    wall(Material::mirror(SILVER)?, right);
    Ok(model)
}

/// Little spheres along the aisle, warm and cool in turn.
fn hang_lamps(model: &mut Model) -> Result<(), MaterialError> {
    let sphere = icosphere(2);
    for number in 0..LAMPS {
        let radiance = if number % 2 == 0 { WARM } else { COOL };
        // The string sags between its ends as a chain does, about.
        let share = number as f64 / (LAMPS - 1) as f64;
        let sag = 0.3 * share * (1.0 - share);
        let place = DVec3::new(0.25 * (4.0 * share).sin(), 1.8 - sag, 0.2 - SPACING * number as f64);
        model.add(Material::lamp(radiance)?, sphere.clone().placed(LAMP_RADIUS, place).triangles());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cornell::statue;

    #[test]
    fn the_hall_has_as_many_lamps_as_it_says() {
        let model = with_statues(&[statue(1000)]).unwrap();
        let emits = |id: &u32| !model.materials()[*id as usize].emission.is_none();
        assert_eq!(model.material_ids().iter().filter(|id| emits(id)).count(), 7680);
    }
}
