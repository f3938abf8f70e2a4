use super::openexr;
use crate::IoError;
use crate::atomic::AtomicFile;
use crate::path::extension_of;
use crate::picture::data::PictureData;
use globillum_integrator::{Estimates, Film};
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use std::error::Error;
use std::path::{Path, PathBuf};

/// The format of a picture file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PictureFormat {
    /// 8 bits per component, sRGB-encoded, clamped to `[0, 1]`, for viewing.
    Png,
    /// Linear Rec. 709 as `f32`, not clamped, with the errors of pixels, for measuring and further processing
    /// ([`PictureData`]).
    Exr,
}

impl PictureFormat {
    /// The format that the file's extension names, in upper or lower case.
    ///
    /// # Errors
    /// [`IoError::UnknownFormat`] for any extension but `png` and `exr`.
    pub fn of(path: impl AsRef<Path>) -> Result<Self, IoError> {
        let path = path.as_ref();
        match extension_of(path).to_str() {
            Some("png") => Ok(Self::Png),
            Some("exr") => Ok(Self::Exr),
            _ => Err(IoError::UnknownFormat { path: path.into() }),
        }
    }

    /// The content of a file, with radiance multiplied by `gain` if it is a PNG.
    ///
    /// # Errors
    /// What the encoder cannot write: a radiance beyond [`f32::MAX`] in OpenEXR, lists of other lengths than the
    /// [`Estimates`] say.
    pub fn encode(self, data: &PictureData, gain: f64) -> Result<Vec<u8>, Box<dyn Error + Send + Sync>> {
        let Estimates { width, height, means, .. } = &data.estimates;
        match self {
            Self::Exr => openexr::encode(data),
            Self::Png => {
                let bytes: Vec<u8> = means.iter().flat_map(|&mean| (mean * gain).to_srgb8()).collect();
                let mut file = Vec::new();
                PngEncoder::new(&mut file).write_image(&bytes, *width, *height, ExtendedColorType::Rgb8)?;
                Ok(file)
            }
        }
    }
}

/// A picture file that is open for writing.
///
/// Create it before rendering, so that a wrong path is reported at once. An existing file does not change
/// until [`PictureFile::write`] or [`PictureFile::write_data`] has finished.
///
/// ```no_run
/// use globillum_io::{IoError, PictureFile};
///
/// fn save(film: &globillum_integrator::Film) -> Result<(), IoError> {
///     PictureFile::create("picture.png")?.exposed(1.0).write(film)?; // twice as bright
///     PictureFile::create("picture.exr")?.write(film)
/// }
/// ```
#[derive(Debug)]
pub struct PictureFile {
    format: PictureFormat,
    path: PathBuf,
    file: AtomicFile,
    /// The factor for radiance of a PNG.
    gain: f64,
}

impl PictureFile {
    /// Chooses the format by the extension of `path` and opens the file as [`AtomicFile::create`] does.
    ///
    /// # Errors
    /// [`IoError::UnknownFormat`] for any extension but `png` and `exr`; [`IoError::Write`] if the folder
    /// is missing or cannot be written to, or if `path` is a directory or a socket.
    pub fn create(path: impl AsRef<Path>) -> Result<Self, IoError> {
        let path = path.as_ref();
        let format = PictureFormat::of(path)?;
        Ok(Self { format, path: path.into(), file: AtomicFile::create(path)?, gain: 1.0 })
    }

    /// The same picture with radiance multiplied by two to the power of `stops`, if it is a PNG. An OpenEXR
    /// file is for measuring and does not change.
    #[must_use]
    pub fn exposed(self, stops: f64) -> Self {
        Self { gain: stops.exp2(), ..self }
    }

    /// Writes the film's pixels: [`PictureData::of`] it. The key, seed, settings and camera, by which pictures are compared
    /// later, are in [`PictureData::of_render`].
    ///
    /// # Errors
    /// Those of [`PictureFile::write_data`].
    pub fn write(self, film: &Film) -> Result<(), IoError> {
        self.write_data(&PictureData::of(film))
    }

    /// Writes a picture, its means alone if it is a PNG. A regular file is replaced in one step, so that readers
    /// find the old file or the new one; a FIFO or a device is written through (see [`AtomicFile`]). The picture
    /// is encoded in memory, so the target need not be seekable.
    ///
    /// # Errors
    /// [`IoError::Encode`] or [`IoError::Write`]. Each says what remains of the old file.
    pub fn write_data(self, data: &PictureData) -> Result<(), IoError> {
        let Self { format, path, file, gain } = self;
        let bytes = format.encode(data, gain).map_err(|source| IoError::Encode { path, source })?;
        file.commit(|writer| writer.write_all(&bytes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use globillum_material::Rgb;

    #[test]
    fn equal_pictures_make_equal_files() {
        let mut data = PictureData::new(Estimates::unknown(256, 256));
        data.estimates.means = (0..256 * 256).map(|i| Rgb::splat(f64::from(i % 977))).collect();
        (0..20).for_each(|i| data.set(&format!("name {i}"), i));
        for format in [PictureFormat::Png, PictureFormat::Exr] {
            let encode = || format.encode(&data, 1.0).unwrap_or_default();
            let first = encode();
            assert!(!first.is_empty() && (0..4).all(|_| encode() == first), "{format:?}");
        }
    }
}
