use super::lines::{self, write};
use super::source::{Source, Statement};
use crate::error::Result;
use crate::losses::Losses;
use globillum_material::{Bsdf, Emission, Material, MaterialError, Reflectance, Rgb, Sides};
use std::str::FromStr;

/// One material of a library, as tobj reads it.
pub(super) struct Description<'a> {
    /// The statement that begins it.
    pub(super) begin: Statement<'a>,
    losses: Losses,
    read: tobj::Material,
}

/// The albedo of a diffuse surface without `Kd`.
const GREY: Rgb = Rgb { r: 0.5, g: 0.5, b: 0.5 };

/// The roughness of a material with `Pm` and without `Pr`, as in Blender.
const DEFAULT_ROUGHNESS: f32 = 0.5;

/// The illumination model of an ideal mirror without transparency.
const MIRROR: u8 = 3;

/// The illumination models of glass.
const GLASS: [u8; 4] = [4, 6, 7, 9];

/// The materials of a library, in order. `begin` checks the statement that begins each.
pub(super) fn read<'a>(
    library: &'a Source,
    mut begin: impl FnMut(&Statement<'a>) -> Result<()>,
) -> Result<impl Iterator<Item = Description<'a>>> {
    let mut begun: Vec<(Statement<'a>, Losses)> = Vec::new();
    let pass = |statement: &Statement<'a>, line: &mut String| {
        if statement.keyword != "newmtl" {
            return begun.last_mut().map_or(Ok(()), |(_, losses)| pass(statement, losses, line));
        }
        statement.name()?;
        begin(statement)?;
        begun.push((*statement, Losses::default()));
        // A name may consist of characters that tobj trims.
        line.push_str("newmtl m\n");
        Ok(())
    };
    let (materials, _) = lines::read(library, pass, |lines| tobj::load_mtl_buf(lines))?;
    let all = begun.into_iter().zip(materials);
    Ok(all.map(|((begin, losses), read)| Description { begin, losses, read }))
}

/// Checks a statement of a material, and writes the line that tobj reads for it or notes what is lost.
fn pass(statement: &Statement<'_>, losses: &mut Losses, line: &mut String) -> Result<()> {
    match statement.keyword {
        "Kd" | "Ks" | "Ke" if statement.words().next() == Some("spectral") => losses.spectral = true,
        "Kd" | "Ks" | "Ke" => colour(statement, line)?,
        "illum" => number::<u8>(statement, line)?,
        "Pm" | "Pr" => number::<f32>(statement, line)?,
        "d" | "Tr" => losses.transparent |= is_transparent(statement),
        "bump" | "decal" | "disp" | "norm" | "refl" => losses.textured = true,
        map if map.starts_with("map_") => {
            losses.textured = true;
            if map == "map_Kd" {
                line.push_str("map_Kd m\n");
            }
        }
        _ => {}
    }
    Ok(())
}

impl Description<'_> {
    /// The material by the table in docs/scenes.md. It emits from the front.
    pub(super) fn material(&self) -> Result<Material, MaterialError> {
        let material = match self.mirror() {
            Some(reflectance) => Material::mirror(reflectance)?,
            None => Material::lambert(self.base().unwrap_or(GREY))?,
        };
        let emitted = rgb(self.read.emissive).unwrap_or_default();
        Ok(material.emitting(Emission::new(emitted, Sides::Front)?))
    }

    /// The properties that its [`material`](Description::material) does not have.
    pub(super) fn losses(self) -> Losses {
        let visible = |colour: Option<Rgb>| colour.is_some_and(|colour| !colour.is_black());
        let is_glass = self.read.illumination_model.is_some_and(|model| GLASS.contains(&model));
        Losses {
            transparent: self.losses.transparent || is_glass,
            approximated: visible(self.base()) && visible(rgb(self.read.specular)),
            is_mirror: self.mirror().is_some(),
            ..self.losses
        }
    }

    /// The colour of the diffuse surface or the metal.
    fn base(&self) -> Option<Rgb> {
        let of_texture = self.read.diffuse_texture.is_some().then_some(GREY);
        rgb(self.read.diffuse).or(of_texture)
    }

    /// Its reflectance if it becomes a mirror.
    fn mirror(&self) -> Option<Rgb> {
        let base = self.base();
        if let Some(metallic) = self.parameter("Pm") {
            let roughness = self.parameter("Pr").unwrap_or(DEFAULT_ROUGHNESS);
            return (metallic > roughness).then_some(base.unwrap_or(GREY));
        }
        let specular = rgb(self.read.specular)?;
        let reflects = self.read.illumination_model == Some(MIRROR) && !specular.is_black();
        let is_mirror = reflects || base.is_none();
        let metal = rgb(self.read.diffuse).filter(|&metal| !outshines(specular, metal));
        is_mirror.then_some(metal.unwrap_or(specular))
    }

    /// A number of the extension for physically based materials.
    fn parameter(&self, keyword: &str) -> Option<f32> {
        self.read.unknown_param.get(keyword)?.parse().ok()
    }
}

/// The material of faces without a defined material: Lambertian with an albedo of one half.
pub(super) fn default_material() -> Material {
    Material { bsdf: Bsdf::Lambert(Reflectance::new(GREY).unwrap_or_default()), emission: Emission::NONE }
}

/// Whether `Ks` is the colour of a mirror rather than `Kd`. Exporters write the colour of a metal as `Kd`, and
/// a `Ks` of one half for all materials.
fn outshines(specular: Rgb, base: Rgb) -> bool {
    let (specular, base) = (specular.max_component(), base.max_component());
    base == 0.0 || (specular > 0.5 && specular > 2.0 * base)
}

/// Passes `r g b`, or one number for a grey, which tobj does not expect.
fn colour(statement: &Statement<'_>, line: &mut String) -> Result<()> {
    for word in statement.words() {
        let number: f64 = statement.number(word)?;
        if statement.keyword == "Ke" && number != 0.0 && number as f32 == 0.0 {
            return Err(statement.malformed(&format!("`{word}` is too small for `f32`")));
        }
    }
    if !matches!(statement.words().count(), 1 | 3) {
        return Err(statement.malformed("expected 1 or 3 numbers"));
    }
    write(line, statement.keyword, statement.words().cycle().take(3));
    Ok(())
}

/// Passes a number of type `T`.
fn number<T: FromStr>(statement: &Statement<'_>, line: &mut String) -> Result<()> {
    let word = statement.words().next().unwrap_or_default();
    statement.number::<T>(word)?;
    write(line, statement.keyword, [word].into_iter());
    Ok(())
}

/// Whether `d` is below 1 or `Tr` above 0. The opacity of a halo is `d -halo factor`.
fn is_transparent(statement: &Statement<'_>) -> bool {
    let number = statement.words().find(|word| *word != "-halo").and_then(|word| word.parse::<f64>().ok());
    number.is_some_and(|number| if statement.keyword == "d" { number < 1.0 } else { number > 0.0 })
}

/// A colour that tobj reads.
fn rgb<T: Into<f64>>(colour: Option<[T; 3]>) -> Option<Rgb> {
    colour.map(|colour| colour.map(T::into).into())
}
