use super::{CLAY, SILVER, light, stand, walls};
use glam::DVec3;
use globillum_geom::Triangle;
use globillum_integrator::Model;
use globillum_material::{Material, MaterialError, Rgb};

const WARM: Rgb = Rgb::new(24.0, 13.0, 4.0);
const COOL: Rgb = Rgb::new(5.0, 11.0, 22.0);

/// The box with two meshes under a warm and a cool light: `left` is diffuse, `right` an ideal mirror. Both
/// must [have an extent](super::has_extent).
///
/// # Errors
/// Never: all constants are in range. The type is that of the materials' constructors.
pub fn with_two(left: &[Triangle], right: &[Triangle]) -> Result<Model, MaterialError> {
    let mut model = walls()?;
    model.add(Material::light(WARM)?, light(DVec3::new(-0.5, 0.995, 0.1), 0.15, 0.2));
    model.add(Material::light(COOL)?, light(DVec3::new(0.5, 0.995, 0.1), 0.15, 0.2));
    model.add(Material::lambert(CLAY)?, stand(left, 0.85, DVec3::new(-0.42, -1.0, 0.25), 0.5));
    model.add(Material::mirror(SILVER)?, stand(right, 0.95, DVec3::new(0.42, -1.0, -0.3), -0.4));
    Ok(model)
}
