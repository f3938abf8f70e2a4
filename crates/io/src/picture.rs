use crate::IoError;
use crate::atomic::AtomicFile;
use crate::path::extension_of;
use globillum_integrator::Film;
use globillum_material::Rgb;
use image::codecs::openexr::OpenExrEncoder;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageResult};
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// The format of a picture file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PictureFormat {
    /// 8 bits per component, sRGB-encoded, clamped to `[0, 1]`, for viewing.
    Png,
    /// Linear Rec. 709 as `f32`, not clamped, for measuring and further processing.
    Exr,
}

impl PictureFormat {
    /// The format that the file's extension names, in upper or lower case.
    ///
    /// # Errors
    /// [`IoError::UnknownFormat`] for any extension but `png` and `exr`.
    pub fn of(path: &Path) -> Result<Self, IoError> {
        match extension_of(path).to_str() {
            Some("png") => Ok(Self::Png),
            Some("exr") => Ok(Self::Exr),
            _ => Err(IoError::UnknownFormat { path: path.into() }),
        }
    }

    /// The content of a file. `pixels` are row by row from the top.
    fn encode(self, width: u32, height: u32, pixels: impl Iterator<Item = Rgb>) -> ImageResult<Vec<u8>> {
        let mut file = Cursor::new(Vec::new());
        match self {
            Self::Png => {
                let bytes: Vec<u8> = pixels.flat_map(Rgb::to_srgb8).collect();
                PngEncoder::new(&mut file).write_image(&bytes, width, height, ExtendedColorType::Rgb8)?;
            }
            Self::Exr => {
                let components = pixels.flat_map(Rgb::to_array).map(|x| x as f32);
                let bytes: Vec<u8> = components.flat_map(f32::to_ne_bytes).collect();
                let color = ExtendedColorType::Rgb32F;
                OpenExrEncoder::new(&mut file).write_image(&bytes, width, height, color)?;
            }
        }
        Ok(file.into_inner())
    }
}

/// A picture file that is open for writing.
///
/// Create it before rendering, so that a wrong path is reported at once. An existing file does not change
/// until [`PictureFile::write`] has finished.
///
/// ```no_run
/// use globillum_io::{IoError, PictureFile};
///
/// fn save(film: &globillum_integrator::Film) -> Result<(), IoError> {
///     PictureFile::create("picture.png".as_ref())?.exposed(1.0).write(film)?; // twice as bright
///     PictureFile::create("picture.exr".as_ref())?.write(film)
/// }
/// ```
#[derive(Debug)]
pub struct PictureFile {
    format: PictureFormat,
    path: PathBuf,
    file: AtomicFile,
    /// The factor for radiance.
    gain: f64,
}

impl PictureFile {
    /// Chooses the format by the extension of `path` and opens the file as [`AtomicFile::create`] does.
    ///
    /// # Errors
    /// [`IoError::UnknownFormat`] for any extension but `png` and `exr`; [`IoError::Write`] if the folder
    /// is missing or cannot be written to, or if `path` is a directory or a socket.
    pub fn create(path: &Path) -> Result<Self, IoError> {
        let format = PictureFormat::of(path)?;
        Ok(Self { format, path: path.into(), file: AtomicFile::create(path)?, gain: 1.0 })
    }

    /// The same picture with radiance multiplied by two to the power of `stops`, if it is a PNG. An OpenEXR
    /// file is for measuring and does not change.
    #[must_use]
    pub fn exposed(self, stops: f64) -> Self {
        let gain = if self.format == PictureFormat::Png { stops.exp2() } else { 1.0 };
        Self { gain, ..self }
    }

    /// Writes the mean radiance of the film's pixels. A regular file is replaced in one step, so that
    /// readers find the old file or the new one; a FIFO or a device is written through (see
    /// [`AtomicFile`]). The picture is encoded in memory, so the target need not be seekable.
    ///
    /// # Errors
    /// [`IoError::Encode`] or [`IoError::Write`]. Each says what remains of the old file.
    pub fn write(self, film: &Film) -> Result<(), IoError> {
        self.write_pixels(film.width(), film.height(), film.means())
    }

    /// Writes a picture of `width` x `height` pixels, given row by row from the top, as [`PictureFile::write`]
    /// does.
    ///
    /// # Errors
    /// Those of [`PictureFile::write`].
    ///
    /// # Panics
    /// For another number of pixels.
    pub fn write_pixels(
        self,
        width: u32,
        height: u32,
        pixels: impl Iterator<Item = Rgb>,
    ) -> Result<(), IoError> {
        let Self { format, path, file, gain } = self;
        let bytes = format
            .encode(width, height, pixels.map(|pixel| pixel * gain))
            .map_err(|source| IoError::Encode { path, source: source.into() })?;
        file.commit(|writer| writer.write_all(&bytes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_pixels_make_equal_files() {
        let noise = || (0..256 * 256).map(|i| Rgb::splat(f64::from(i % 977)));
        for format in [PictureFormat::Png, PictureFormat::Exr] {
            let encode = || format.encode(256, 256, noise()).unwrap();
            assert_eq!(encode(), encode(), "{format:?}");
        }
    }
}
