use super::source::{Source, Statement};
use crate::IoError;
use globillum_material::{Emission, Material, MaterialError, Rgb, Sides};

/// What a material library says of one material, as far as it is understood.
///
/// Libraries are not left to tobj: its reader panics at `Kd 0.5`, which is a legal grey.
#[derive(Clone, Copy, Default)]
pub(super) struct Description {
    diffuse: Option<Rgb>,
    specular: Option<Rgb>,
    emitted: Rgb,
    illumination_model: u32,
    /// Whether it mentions texture maps.
    pub(super) textured: bool,
}

/// The illumination model that asks for reflected rays.
const MIRROR: u32 = 3;

impl Description {
    /// All materials of a library, each with the statement that begins it.
    pub(super) fn all(library: &Source) -> Result<Vec<(Statement<'_>, Self)>, IoError> {
        let mut all = Vec::new();
        for statement in library.statements() {
            if statement.keyword == "newmtl" {
                statement.name()?;
                all.push((statement, Self::default()));
            } else if let Some((_, description)) = all.last_mut() {
                description.read(&statement)?;
            }
        }
        Ok(all)
    }

    fn read(&mut self, statement: &Statement<'_>) -> Result<(), IoError> {
        match statement.keyword {
            "Kd" => self.diffuse = Some(colour(statement)?),
            "Ks" => self.specular = Some(colour(statement)?),
            "Ke" => self.emitted = colour(statement)?,
            "illum" => self.illumination_model = statement.number(statement.arguments)?,
            "bump" | "decal" | "disp" | "norm" | "refl" => self.textured = true,
            map if map.starts_with("map_") => self.textured = true,
            _ => {}
        }
        Ok(())
    }

    /// A mirror if that is asked for or there is no diffuse colour beside the specular one;
    /// Lambertian otherwise, grey if there is no colour at all.
    pub(super) fn material(&self) -> Result<Material, MaterialError> {
        let wants_mirror = self.illumination_model == MIRROR || self.diffuse.is_none();
        let material = match self.specular {
            Some(specular) if wants_mirror => Material::mirror(specular)?,
            _ => Material::lambert(self.diffuse.unwrap_or(Rgb::splat(0.5)))?,
        };
        Ok(material.emitting(Emission::new(self.emitted, Sides::Front)?))
    }
}

/// `r g b`, or one number for a grey.
fn colour(statement: &Statement<'_>) -> Result<Rgb, IoError> {
    let numbers = statement.words().map(|word| statement.number(word)).collect::<Result<Vec<f64>, _>>()?;
    match numbers[..] {
        [grey] => Ok(Rgb::splat(grey)),
        [r, g, b] => Ok(Rgb::new(r, g, b)),
        _ => Err(statement.malformed("takes 1 or 3 numbers")),
    }
}
