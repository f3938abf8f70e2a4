//! OpenEXR files of one part, whose channels are named as Blender, Nuke and tev name them: `LAYER.CHANNEL`, and
//! radiance without a layer.

use crate::IoError;
use crate::picture::data::PictureData;
use crate::picture::setting_names;
use exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, read::read};
use exr::math::Vec2;
use exr::meta::attribute::{AttributeValue, IntegerBounds, Text};
use exr::meta::header::{Header, ImageAttributes, LayerAttributes};
use exr::prelude::{ReadChannels as _, ReadLayers as _, WritableImage as _};
use globillum_integrator::{Estimates, FirstHit, FirstHits, PathReuse, Settings};
use globillum_material::Rgb;
use std::collections::BTreeMap;
use std::error::Error as StdError;
use std::fs;
use std::io::Cursor;
use std::path::Path;

type Error = Box<dyn StdError + Send + Sync>;

/// The program that wrote a file, as the attribute `software` has it.
const SOFTWARE: &str = concat!("globillum ", env!("CARGO_PKG_VERSION"));
/// What the names of attributes begin with.
const PREFIX: &str = "globillum.";
const COMPONENTS: [&str; 3] = ["R", "G", "B"];
/// Errors of the means of blocks, each in all pixels of its block.
const BLOCK_ERRORS: &str = "blockerr.";
/// Pixels along a side of a block.
const BLOCK: usize = Estimates::BLOCK_SIDE as usize;
const SAMPLES: &str = "samples.X";
const OBSERVATIONS: &str = "observations.X";
/// The index of nothing.
const NO_INDEX: u32 = u32::MAX;
/// The most that a byte of a file can become: DEFLATE writes 258 bytes with 2 bits.
const MAX_EXPANSION: u64 = 1032;

/// The file of a picture. Equal pictures have equal bytes.
pub(crate) fn encode(data: &PictureData) -> Result<Vec<u8>, Error> {
    let Estimates { width, height, means, standard_errors, samples, observations, block_errors, .. } =
        &data.estimates;
    check_window(&data.estimates)?;
    check_range(data)?;
    let mut channels = triple("", means);
    if data.estimates.has_errors() || samples.iter().any(|&count| count > 0) {
        channels.extend(triple("stderr.", standard_errors));
        let of_pixel = |at: usize| block_errors[block_of(at, *width as usize)];
        channels.extend(triple(BLOCK_ERRORS, &(0..means.len()).map(of_pixel).collect::<Vec<Rgb>>()));
        channels.push(AnyChannel::new(SAMPLES, FlatSamples::U32(samples.clone())));
        channels.push(AnyChannel::new(OBSERVATIONS, FlatSamples::U32(observations.clone())));
    }
    channels.extend(data.first_hits.iter().flat_map(first_hit_channels));
    let size = (*width as usize, *height as usize);
    let channels = AnyChannels::sort(channels.into_iter().collect());
    let layer = Layer::new(size, layer_attributes(data)?, Encoding::SMALL_LOSSLESS, channels);
    let [display_width, display_height] = data.estimates.full_size.map(|length| length as usize);
    let image = Image::new(ImageAttributes::with_size((display_width, display_height)), layer);
    let mut file = Cursor::new(Vec::new());
    image.write().non_parallel().to_buffered(&mut file)?;
    let mut bytes = file.into_inner();
    sort_attributes(&mut bytes);
    Ok(bytes)
}

/// Refuses a crop that does not lie within its picture.
fn check_window(estimates: &Estimates) -> Result<(), Error> {
    let Estimates { width, height, full_size, origin, .. } = *estimates;
    let is_within =
        |axis: usize, length: u32| origin[axis].checked_add(length).is_some_and(|end| end <= full_size[axis]);
    if is_within(0, width) && is_within(1, height) {
        return Ok(());
    }
    let ([x, y], [full_width, full_height]) = (origin, full_size);
    Err(format!("{width} x {height} pixels from ({x}, {y}) on exceed {full_width} x {full_height}").into())
}

/// Refuses finite radiance, or a finite error of it, that is infinite as `f32`. What is infinite is not known.
fn check_range(data: &PictureData) -> Result<(), Error> {
    let Estimates { width, origin, means, standard_errors, .. } = &data.estimates;
    for (what, pixels) in [("radiance", means), ("standard error", standard_errors)] {
        for (at, pixel) in pixels.iter().enumerate() {
            let is_lost = |value: &f64| value.is_finite() && (*value as f32).is_infinite();
            if let Some(value) = pixel.to_array().into_iter().find(is_lost) {
                let [x, y] = [at as u32 % width + origin[0], at as u32 / width + origin[1]];
                let most = f32::MAX;
                return Err(format!(
                    "{what} {value:e} of pixel ({x}, {y}) exceeds {most:e}, the most of OpenEXR"
                )
                .into());
            }
        }
    }
    Ok(())
}

/// The block of pixel `at` of a picture of this width.
fn block_of(at: usize, width: usize) -> usize {
    at / width / BLOCK * width.div_ceil(BLOCK) + at % width / BLOCK
}

/// The three components of `pixels`, in a layer.
fn triple(layer: &str, pixels: &[Rgb]) -> Vec<AnyChannel<FlatSamples>> {
    let channel = |c: usize| {
        floats(&format!("{layer}{}", COMPONENTS[c]), pixels.iter().map(|pixel| pixel.to_array()[c]))
    };
    [0, 1, 2].map(channel).into()
}

fn floats(name: &str, values: impl Iterator<Item = f64>) -> AnyChannel<FlatSamples> {
    AnyChannel::new(name, FlatSamples::F32(values.map(|value| value as f32).collect()))
}

fn first_hit_channels(hits: &FirstHits) -> Vec<AnyChannel<FlatSamples>> {
    let of = |name, value: fn(&FirstHit) -> f64| floats(name, hits.pixels.iter().map(value));
    let index = |name: &str, value: fn(&FirstHit) -> Option<u32>| {
        let indices = hits.pixels.iter().map(|hit| value(hit).unwrap_or(NO_INDEX)).collect();
        AnyChannel::new(name, FlatSamples::U32(indices))
    };
    vec![
        of("Depth.Z", |hit| hit.depth),
        of("Normal.X", |hit| hit.normal.x),
        of("Normal.Y", |hit| hit.normal.y),
        of("Normal.Z", |hit| hit.normal.z),
        of("Albedo.R", |hit| hit.albedo.r),
        of("Albedo.G", |hit| hit.albedo.g),
        of("Albedo.B", |hit| hit.albedo.b),
        index("IndexTriangle.X", |hit| hit.triangle),
        index("IndexMA.X", |hit| hit.material),
    ]
}

fn layer_attributes(data: &PictureData) -> Result<LayerAttributes, Error> {
    let text = |text: &str| Text::new_or_none(text).ok_or("an attribute is not in Latin-1");
    let mut attributes = LayerAttributes { software_name: Some(text(SOFTWARE)?), ..Default::default() };
    for (name, value) in &data.attributes {
        let name = text(&format!("{PREFIX}{name}"))?;
        attributes.other.insert(name, AttributeValue::Text(text(value)?));
    }
    let [x, y] = data.estimates.origin.map(|at| at as i32);
    attributes.layer_position = Vec2(x, y);
    if let Some((matrix, fov)) = data.camera {
        attributes.world_to_camera = Some(matrix);
        attributes.vertical_field_of_view = Some(fov);
    }
    Ok(attributes)
}

/// Sorts the attributes of a file of one part by their names, as OpenEXR's own library does: the encoder writes
/// them in another order each time.
fn sort_attributes(bytes: &mut [u8]) {
    // Magic number and version are before the first one; an empty name is after the last one.
    const START: usize = 8;
    let header = &bytes[START..];
    let mut attributes: Vec<&[u8]> = Vec::new();
    let mut at = 0;
    while header.get(at).is_some_and(|&byte| byte != 0) {
        let Some(length) = attribute_length(&header[at..]) else { return };
        attributes.push(&header[at..at + length]);
        at += length;
    }
    attributes.sort_unstable();
    let sorted = attributes.concat();
    bytes[START..START + at].copy_from_slice(&sorted);
}

/// The bytes of the attribute that `bytes` begin with: name and type, each ended by a zero, the length of the value,
/// and the value.
fn attribute_length(bytes: &[u8]) -> Option<usize> {
    let end_of = |bytes: &[u8]| Some(bytes.iter().position(|&byte| byte == 0)? + 1);
    let name = end_of(bytes)?;
    let value = name + end_of(&bytes[name..])? + 4;
    let length = u32::from_le_bytes(*bytes.get(..value)?.last_chunk()?);
    let end = value + length as usize;
    (end <= bytes.len()).then_some(end)
}

impl PictureData {
    /// Reads the OpenEXR file at `path`, written by any program.
    ///
    /// Radiance is the channels `R`, `G` and `B`, else those of the layer `Combined`, else of the only layer that
    /// has them. Standard errors, samples and observations of a file without them are unknown. A data window within the
    /// display window is a crop ([`Estimates::is_crop`]); any other is read as if it were the picture.
    ///
    /// # Errors
    /// [`IoError::Read`] if the file cannot be read; [`IoError::Decode`] if it is not an OpenEXR file, is damaged,
    /// has no such channels, too many pixels ([`Settings::MAX_PIXELS`]), or a radiance that is not finite or an
    /// error that is not a number.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, IoError> {
        let path = path.as_ref();
        let bytes = fs::read(path).map_err(|source| IoError::Read { path: path.into(), source })?;
        decode(&bytes).map_err(|source| IoError::Decode { path: path.into(), source })
    }
}

/// How every OpenEXR file begins.
const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// The picture in a file.
fn decode(bytes: &[u8]) -> Result<PictureData, Error> {
    if !bytes.starts_with(&MAGIC) {
        return Err("is no OpenEXR picture".into());
    }
    let chunks = exr::block::read(Cursor::new(bytes), false)?;
    chunks.headers().iter().try_for_each(|header| check_size(header, bytes.len()))?;
    let layers = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer();
    let image = layers.all_attributes().non_parallel().from_chunks(chunks)?;
    let display = image.attributes.display_window;
    let Layer { channel_data, attributes, size, .. } = image.layer_data;
    let channels =
        Channels(channel_data.list.into_iter().map(|c| (c.name.to_string(), c.sample_data)).collect());
    let (width, pixels) = (size.width(), size.width() * size.height());
    let layer = channels.layer_of_radiance().ok_or("has no channels R, G and B")?;
    let mut estimates = Estimates::unknown(width as u32, size.height() as u32);
    estimates.means = channels.triple(&layer, pixels).ok_or("has subsampled channels")?;
    if let Some(at) = estimates.means.iter().position(|mean| !mean.is_finite()) {
        return Err(format!("pixel ({}, {}) is not finite", at % width, at / width).into());
    }
    if let Some(errors) = channels.errors("stderr.", width, pixels)? {
        estimates.standard_errors = errors;
    }
    if let Some(errors) = channels.errors(BLOCK_ERRORS, width, pixels)? {
        for (at, error) in errors.into_iter().enumerate() {
            estimates.block_errors[block_of(at, width)] = error;
        }
    }
    let known = [(SAMPLES, &mut estimates.samples), (OBSERVATIONS, &mut estimates.observations)];
    for (name, counts) in known {
        if let Some(FlatSamples::U32(values)) = channels.get(name, pixels) {
            counts.clone_from(values);
        }
    }
    let attributes_by_name = texts(&attributes);
    if attributes_by_name
        .get("path_reuse")
        .is_some_and(|kind| kind == setting_names::path_reuse(PathReuse::Tiles))
    {
        estimates.path_reuse = PathReuse::Tiles;
    }
    let window = IntegerBounds::new(attributes.layer_position, size);
    if display.contains(window) {
        let from = window.position - display.position;
        estimates.origin = [from.x(), from.y()].map(|at| at as u32);
        estimates.full_size = [display.size.width(), display.size.height()].map(|length| length as u32);
    }
    let camera = attributes.world_to_camera.zip(attributes.vertical_field_of_view);
    let first_hits = channels.first_hits(estimates.width, estimates.height);
    Ok(PictureData { attributes: attributes_by_name, camera, first_hits, ..PictureData::new(estimates) })
}

/// Refuses a header that promises more than its file can hold.
fn check_size(header: &Header, length: usize) -> Result<(), Error> {
    let pixels = header.layer_size.width() as u64 * header.layer_size.height() as u64;
    let channels = header.channels.list.len() as u64;
    if pixels > Settings::MAX_PIXELS || pixels * channels > MAX_EXPANSION * length as u64 {
        return Err("has more pixels than it can hold".into());
    }
    Ok(())
}

/// The text attributes of this library, by their names without the prefix.
fn texts(attributes: &LayerAttributes) -> BTreeMap<String, String> {
    let own = |(name, value): (&Text, &AttributeValue)| match value {
        AttributeValue::Text(text) => Some((name.to_string().strip_prefix(PREFIX)?.into(), text.to_string())),
        _ => None,
    };
    attributes.other.iter().filter_map(own).collect()
}

/// Channels by their names.
struct Channels(BTreeMap<String, FlatSamples>);

impl Channels {
    /// A channel of one value for each pixel.
    fn get(&self, name: &str, pixels: usize) -> Option<&FlatSamples> {
        self.0.get(name).filter(|samples| samples.len() == pixels)
    }

    /// What the names of the three channels of radiance begin with.
    fn layer_of_radiance(&self) -> Option<String> {
        let is_layer = |layer: &&str| COMPONENTS.iter().all(|c| self.0.contains_key(&format!("{layer}{c}")));
        let layers: Vec<&str> =
            self.0.keys().filter_map(|name| name.strip_suffix('R')).filter(is_layer).collect();
        let is_main = |layer: &&&str| layer.is_empty() || layer.ends_with("Combined.");
        let main = layers.iter().find(is_main).or(if layers.len() == 1 { layers.first() } else { None });
        main.map(ToString::to_string)
    }

    /// The first hits, if all their channels are there.
    fn first_hits(&self, width: u32, height: u32) -> Option<FirstHits> {
        let mut hits = FirstHits::nothing(width, height);
        let pixels = hits.pixels.len();
        let mut set = |name: &str, field: fn(&mut FirstHit) -> &mut f64| {
            let values = self.get(name, pixels)?.values_as_f32();
            hits.pixels.iter_mut().zip(values).for_each(|(hit, value)| *field(hit) = value.into());
            Some(())
        };
        set("Depth.Z", |hit| &mut hit.depth)?;
        set("Normal.X", |hit| &mut hit.normal.x)?;
        set("Normal.Y", |hit| &mut hit.normal.y)?;
        set("Normal.Z", |hit| &mut hit.normal.z)?;
        set("Albedo.R", |hit| &mut hit.albedo.r)?;
        set("Albedo.G", |hit| &mut hit.albedo.g)?;
        set("Albedo.B", |hit| &mut hit.albedo.b)?;
        let mut set = |name: &str, field: fn(&mut FirstHit) -> &mut Option<u32>| {
            let FlatSamples::U32(indices) = self.get(name, pixels)? else { return None };
            let indices = indices.iter().map(|&index| (index != NO_INDEX).then_some(index));
            hits.pixels.iter_mut().zip(indices).for_each(|(hit, index)| *field(hit) = index);
            Some(())
        };
        set("IndexTriangle.X", |hit| &mut hit.triangle)?;
        set("IndexMA.X", |hit| &mut hit.material)?;
        Some(hits)
    }

    /// The standard errors of a layer.
    fn errors(&self, layer: &str, width: usize, pixels: usize) -> Result<Option<Vec<Rgb>>, Error> {
        let Some(errors) = self.triple(layer, pixels) else { return Ok(None) };
        let is_error = |error: &Rgb| error.to_array().into_iter().all(|x| x >= 0.0);
        match errors.iter().position(|error| !is_error(error)) {
            Some(at) => {
                Err(format!("standard error of pixel ({}, {}) is negative or NaN", at % width, at / width)
                    .into())
            }
            None => Ok(Some(errors)),
        }
    }

    /// The three components of a layer.
    fn triple(&self, layer: &str, pixels: usize) -> Option<Vec<Rgb>> {
        let [r, g, b] = COMPONENTS.map(|c| self.get(&format!("{layer}{c}"), pixels));
        let [r, g, b] = [r?, g?, b?].map(FlatSamples::values_as_f32);
        Some(r.zip(g).zip(b).map(|((r, g), b)| Rgb::new(r.into(), g.into(), b.into())).collect())
    }
}
