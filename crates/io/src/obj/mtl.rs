use super::source::{Source, Statement};
use crate::{IoError, WarningKind};
use globillum_material::{Bsdf, Emission, Material, MaterialError, Reflectance, Rgb, Sides};

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
    textured: bool,
    /// Whether it lets light through.
    transparent: bool,
    /// Whether a colour is given as a spectral curve.
    spectral: bool,
}

/// The illumination models that reflect as an ideal mirror does, without transparency.
const MIRROR: u32 = 3;

/// The illumination models of glass.
const GLASS: [u32; 4] = [4, 6, 7, 9];

impl Description {
    /// Hands out the materials of a library, each with the statement that begins it, when it has been
    /// read to its end.
    pub(super) fn each<'a>(
        library: &'a Source,
        mut visit: impl FnMut(&Statement<'a>, &Self) -> Result<(), IoError>,
    ) -> Result<(), IoError> {
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

    fn read(&mut self, statement: &Statement<'_>) -> Result<(), IoError> {
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

    /// `r g b`, or one number for a grey; `None` for a spectral curve, which is not read.
    fn colour(&mut self, statement: &Statement<'_>) -> Result<Option<Rgb>, IoError> {
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

    /// What of it is not in its [`material`](Description::material).
    pub(super) fn passed_over(&self, name: &str) -> impl Iterator<Item = WarningKind> {
        let transparent = self.transparent || GLASS.contains(&self.illumination_model);
        let dropped_highlight =
            self.diffuse.is_some_and(|kd| !kd.is_black()) && self.specular.is_some_and(|ks| !ks.is_black());
        let by =
            if self.illumination_model == MIRROR { "an ideal mirror" } else { "an ideal diffuse surface" };
        // Names may be long: one copy at a time.
        type Kind = fn(String, &'static str) -> WarningKind;
        let kinds: [(bool, Kind); 4] = [
            (self.textured, |name, _| WarningKind::TexturesIgnored { name }),
            (transparent, |name, _| WarningKind::TransparencyIgnored { name }),
            (self.spectral, |name, _| WarningKind::SpectrumIgnored { name }),
            (dropped_highlight, |name, by| WarningKind::Approximated { name, by }),
        ];
        kinds.into_iter().filter(|(is_lost, _)| *is_lost).map(move |(_, kind)| kind(name.to_owned(), by))
    }
}

/// The material of faces without one, and of those whose material is not defined: a grey of one half.
pub(super) fn default_material() -> Material {
    let half = Rgb::splat(0.5);
    Material { bsdf: Bsdf::Lambert(Reflectance::new(half).unwrap_or_default()), emission: Emission::NONE }
}

fn first_number<T: std::str::FromStr>(statement: &Statement<'_>) -> Result<T, IoError> {
    // A halo's opacity is written `d -halo factor`.
    statement.number(statement.words().find(|word| *word != "-halo").unwrap_or_default())
}
