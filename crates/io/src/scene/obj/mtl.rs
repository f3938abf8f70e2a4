use super::lines::{self, write};
use super::source::{Source, Statement};
use super::unknown::UnknownStatements;
use crate::Location;
use crate::error::Result;
use crate::scene::losses::{Losses, MEAN_OF_TEXTURE};
use globillum_material::{Bsdf, Emission, Material, MaterialError, Reflectance, Rgb, Sides};

/// One material of a library, as tobj reads it.
pub(super) struct Description<'a> {
    /// The statement that begins it.
    pub(super) begin: Statement<'a>,
    notes: Notes,
    read: tobj::Material,
}

/// What tobj does not return of a material.
#[derive(Default)]
struct Notes {
    losses: Losses,
    lines: StatementLines,
    /// Whether textures say how metallic and rough it is. Numbers beside them are upper bounds.
    has_metal_texture: bool,
}

/// The lines of the last `Kd`, `Ks` and `Ke` of a material, 0 for none.
#[derive(Clone, Copy, Default)]
struct StatementLines {
    diffuse: usize,
    specular: usize,
    emissive: usize,
}

/// A colour and the line of its statement, 0 for a default.
#[derive(Clone, Copy)]
struct Colour {
    value: Rgb,
    line: usize,
    /// Whether a texture multiplies it.
    textured: bool,
}

impl Colour {
    /// The colour with the mean of its texture.
    ///
    /// # Errors
    /// [`MaterialError::Reflectance`] for a component outside [0, 1], with or without a texture.
    fn mean(self) -> Result<Rgb, MaterialError> {
        let value = Reflectance::new(self.value)?.rgb();
        Ok(if self.textured { value * MEAN_OF_TEXTURE } else { value })
    }
}

/// The albedo of a diffuse surface without `Kd`.
const GREY: Rgb = Rgb { r: 0.5, g: 0.5, b: 0.5 };

/// [`GREY`] that no statement gives.
const DEFAULT: Colour = Colour { value: GREY, line: 0, textured: false };

/// The roughness of a material with `Pm` and without `Pr`, as in Blender.
const DEFAULT_ROUGHNESS: f32 = 0.5;

/// The illumination model of an ideal mirror without transparency.
const MIRROR: u8 = 3;

/// The illumination models of glass.
const GLASS: [u8; 4] = [4, 6, 7, 9];

/// The materials of a library, in order. `begin` checks the statement that begins each. Adds the statements that MTL does not
/// define to `unknown`.
pub(super) fn read<'a>(
    library: &'a Source,
    unknown: &mut UnknownStatements<'a>,
    mut begin: impl FnMut(&Statement<'a>) -> Result<()>,
) -> Result<impl Iterator<Item = Description<'a>>> {
    let mut begun: Vec<(Statement<'a>, Notes)> = Vec::new();
    let next = |statement: &Statement<'a>, line: &mut String| {
        if statement.keyword != "newmtl" {
            let Some((_, notes)) = begun.last_mut() else {
                unknown.add(statement);
                return Ok(());
            };
            return pass_property(statement, notes, unknown, line);
        }
        begin(statement)?;
        begun.push((*statement, Notes::default()));
        // A name may consist of characters that tobj trims.
        line.push_str("newmtl m\n");
        Ok(())
    };
    let (materials, _) = lines::read(library, next, |lines| tobj::load_mtl_buf(lines))?;
    let all = begun.into_iter().zip(materials);
    Ok(all.map(|((begin, notes), read)| Description { begin, notes, read }))
}

/// Checks a statement of a material, and writes the line that tobj reads for it or notes what is lost.
fn pass_property<'a>(
    statement: &Statement<'a>,
    notes: &mut Notes,
    unknown: &mut UnknownStatements<'a>,
    line: &mut String,
) -> Result<()> {
    let Notes { losses, lines, has_metal_texture } = notes;
    match statement.keyword {
        "Kd" | "Ks" | "Ke" if statement.words().next() == Some("spectral") => losses.spectral = true,
        "Kd" => lines.diffuse = colour(statement, line)?,
        "Ks" => lines.specular = colour(statement, line)?,
        "Ke" => lines.emissive = colour(statement, line)?,
        "illum" => illumination_model(statement, line)?,
        "Pm" | "Pr" => factor(statement, line)?,
        "d" | "Tr" => losses.transparent |= is_transparent(statement),
        "bump" | "decal" | "disp" | "norm" | "refl" => losses.textured = true,
        "map_Ke" => losses.emission = true,
        map if map.starts_with("map_") => {
            losses.textured = true;
            *has_metal_texture |= matches!(map, "map_Pm" | "map_Pr");
            if map == "map_Kd" {
                line.push_str("map_Kd m\n");
            }
        }
        "Ka" | "Km" | "Ni" | "Ns" | "Pc" | "Pcr" | "Ps" | "Tf" | "aniso" | "anisor" | "sharpness" => {}
        _ => unknown.add(statement),
    }
    Ok(())
}

impl Description<'_> {
    /// The material by the table in docs/scenes.md. It emits from the front.
    ///
    /// # Errors
    /// The statement's location, and why its colour is refused.
    pub(super) fn material(&self) -> Result<Material, (Location, MaterialError)> {
        let at = |line: usize| if line == 0 { self.begin.at() } else { self.begin.at_line(line) };
        let (material, line) = match self.mirror() {
            Some(colour) => (colour.mean().and_then(Material::mirror), colour.line),
            None => {
                let colour = self.base().unwrap_or(DEFAULT);
                (colour.mean().and_then(Material::lambert), colour.line)
            }
        };
        let material = material.map_err(|error| (at(line), error))?;
        if self.notes.losses.emission {
            return Ok(material);
        }
        let emitted = rgb(self.read.emissive).unwrap_or_default();
        let emission = Emission::new(emitted, Sides::Front);
        Ok(material.emitting(emission.map_err(|error| (at(self.notes.lines.emissive), error))?))
    }

    /// The properties that its [`material`](Description::material) does not have.
    pub(super) fn losses(self) -> Losses {
        let visible = |colour: Option<Colour>| colour.is_some_and(|colour| !colour.value.is_black());
        let is_glass = self.read.illumination_model.is_some_and(|model| GLASS.contains(&model));
        Losses {
            transparent: self.notes.losses.transparent || is_glass,
            approximated: match self.metal() {
                Some(metal) => {
                    let is_ideal = matches!(metal, (0.0, 1.0) | (1.0, 0.0)) && !self.notes.has_metal_texture;
                    !is_ideal && visible(self.base().or(Some(DEFAULT)))
                }
                None => visible(self.base()) && visible(self.specular()),
            },
            emission: self.notes.losses.emission && rgb(self.read.emissive) != Some(Rgb::BLACK),
            is_mirror: self.mirror().is_some(),
            ..self.notes.losses
        }
    }

    /// `Kd`.
    fn diffuse(&self) -> Option<Colour> {
        let textured = self.read.diffuse_texture.is_some();
        rgb(self.read.diffuse).map(|value| Colour { value, line: self.notes.lines.diffuse, textured })
    }

    /// `Ks`.
    fn specular(&self) -> Option<Colour> {
        rgb(self.read.specular).map(|value| Colour {
            value,
            line: self.notes.lines.specular,
            textured: false,
        })
    }

    /// The colour of the diffuse surface or the metal.
    fn base(&self) -> Option<Colour> {
        // The mean of a texture alone.
        let of_texture = self.read.diffuse_texture.is_some().then_some(DEFAULT);
        self.diffuse().or(of_texture)
    }

    /// Its reflectance if it becomes a mirror.
    fn mirror(&self) -> Option<Colour> {
        let base = self.base();
        if let Some((metallic, roughness)) = self.metal() {
            let is_mirror = metallic > roughness && !self.notes.has_metal_texture;
            return is_mirror.then_some(base.unwrap_or(DEFAULT));
        }
        let specular = self.specular()?;
        let reflects = self.read.illumination_model == Some(MIRROR) && !specular.value.is_black();
        let is_mirror = reflects || base.is_none();
        let metal = self.diffuse().filter(|metal| !outshines(specular.value, metal.value));
        is_mirror.then_some(metal.unwrap_or(specular))
    }

    /// How metallic and how rough it is, by the extension for physically based materials. It is ideally diffuse for 0 and 1,
    /// an ideal mirror for 1 and 0.
    fn metal(&self) -> Option<(f32, f32)> {
        Some((self.parameter("Pm")?, self.parameter("Pr").unwrap_or(DEFAULT_ROUGHNESS)))
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

/// Passes `r g b`, or one number for a grey, which tobj does not expect. Returns the statement's line.
fn colour(statement: &Statement<'_>, line: &mut String) -> Result<usize> {
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
    Ok(statement.line)
}

/// Passes the number of an illumination model.
fn illumination_model(statement: &Statement<'_>, line: &mut String) -> Result<()> {
    let word = statement.words().next().unwrap_or_default();
    statement.number::<u8>(word)?;
    write(line, statement.keyword, [word].into_iter());
    Ok(())
}

/// Passes a number within [0, 1].
fn factor(statement: &Statement<'_>, line: &mut String) -> Result<()> {
    let word = statement.words().next().unwrap_or_default();
    if !(0.0..=1.0).contains(&statement.number::<f32>(word)?) {
        return Err(statement.malformed(&format!("`{word}` is not within [0, 1]")));
    }
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
