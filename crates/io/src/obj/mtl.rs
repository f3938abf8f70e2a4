use super::source::{Source, Statement};
use crate::error::Result;
use crate::losses::Losses;
use globillum_material::{Bsdf, Emission, Material, MaterialError, Reflectance, Rgb, Sides};

/// The supported properties of one material in a library.
///
/// The reader of tobj is not used, since it panics on `Kd 0.5`, which is a valid grey.
#[derive(Clone, Copy, Default)]
pub(super) struct Description {
    diffuse: Option<Rgb>,
    specular: Option<Rgb>,
    emitted: Rgb,
    illumination_model: u32,
    /// Whether it has texture maps.
    textured: bool,
    /// Whether it has an opacity below 1.
    transparent: bool,
    /// Whether a colour is a spectral curve.
    spectral: bool,
}

/// The illumination model of an ideal mirror without transparency.
const MIRROR: u32 = 3;

/// The illumination models of glass.
const GLASS: [u32; 4] = [4, 6, 7, 9];

impl Description {
    /// Calls `visit` for each complete material of a library, with the statement that begins it.
    pub(super) fn each<'a>(
        library: &'a Source,
        mut visit: impl FnMut(&Statement<'a>, &Self) -> Result<()>,
    ) -> Result<()> {
        let mut current: Option<(Statement<'a>, Self)> = None;
        for statement in library.statements() {
            if statement.keyword == "newmtl" {
                statement.name()?;
                if let Some((begin, description)) = current.replace((statement, Self::default())) {
                    visit(&begin, &description)?;
                }
            } else if let Some((_, description)) = &mut current {
                description.read(&statement)?;
            }
        }
        current.map_or(Ok(()), |(begin, description)| visit(&begin, &description))
    }

    fn read(&mut self, statement: &Statement<'_>) -> Result<()> {
        match statement.keyword {
            "Kd" => self.diffuse = self.colour(statement)?,
            "Ks" => self.specular = self.colour(statement)?,
            "Ke" => self.emitted = self.colour(statement)?.unwrap_or_default(),
            "illum" => self.illumination_model = first_number(statement)?,
            "d" => self.transparent |= first_number::<f64>(statement).is_ok_and(|opacity| opacity < 1.0),
            "Tr" => self.transparent |= first_number::<f64>(statement).is_ok_and(|share| share > 0.0),
            "bump" | "decal" | "disp" | "norm" | "refl" => self.textured = true,
            map if map.starts_with("map_") => self.textured = true,
            _ => {}
        }
        Ok(())
    }

    /// `r g b`, or one number for a grey. `None` for a spectral curve, which is not supported.
    fn colour(&mut self, statement: &Statement<'_>) -> Result<Option<Rgb>> {
        if statement.words().next() == Some("spectral") {
            self.spectral = true;
            return Ok(None);
        }
        let (mut rgb, mut count) = ([0.0; 3], 0);
        for word in statement.words() {
            let number = statement.number(word)?;
            if let Some(component) = rgb.get_mut(count) {
                *component = number;
            }
            count += 1;
        }
        match count {
            1 => Ok(Some(Rgb::splat(rgb[0]))),
            3 => Ok(Some(rgb.into())),
            _ => Err(statement.malformed("expected 1 or 3 numbers")),
        }
    }

    /// A mirror if the material has `Ks`, and also `illum 3` or no `Kd`. Otherwise Lambertian, with an
    /// albedo of one half if there is no `Kd`.
    pub(super) fn material(&self) -> Result<Material, MaterialError> {
        let wants_mirror = self.illumination_model == MIRROR || self.diffuse.is_none();
        let material = match self.specular {
            Some(specular) if wants_mirror => Material::mirror(specular)?,
            _ => Material::lambert(self.diffuse.unwrap_or(Rgb::splat(0.5)))?,
        };
        Ok(material.emitting(Emission::new(self.emitted, Sides::Front)?))
    }

    /// The properties that its [`material`](Description::material) does not have.
    pub(super) fn losses(&self) -> Losses {
        let visible = |colour: Option<Rgb>| colour.is_some_and(|colour| !colour.is_black());
        Losses {
            textured: self.textured,
            transparent: self.transparent || GLASS.contains(&self.illumination_model),
            spectral: self.spectral,
            approximated: visible(self.diffuse) && visible(self.specular),
            is_mirror: self.illumination_model == MIRROR,
        }
    }
}

/// The material of faces without a defined material: Lambertian with an albedo of one half.
pub(super) fn default_material() -> Material {
    let half = Rgb::splat(0.5);
    Material { bsdf: Bsdf::Lambert(Reflectance::new(half).unwrap_or_default()), emission: Emission::NONE }
}

fn first_number<T: std::str::FromStr>(statement: &Statement<'_>) -> Result<T> {
    // The opacity of a halo is `d -halo factor`.
    statement.number(statement.words().find(|word| *word != "-halo").unwrap_or_default())
}
