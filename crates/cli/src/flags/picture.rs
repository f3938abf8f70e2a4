use super::crop::{Crop, Shown};
use super::kinds::FilterKind;
use crate::{console, parse};
use globillum::integrator::PathReuse;
use serde::Serialize;
use std::ops::Range;

#[derive(clap::Args, Clone, Debug, Serialize)]
#[command(next_help_heading = "Picture")]
pub(crate) struct PictureFlags {
    /// Width of the picture in pixels; at most 2^27 pixels together with the height
    #[arg(long, value_name = "PIXELS", default_value_t = 512, value_parser = parse::integer(1..=u32::MAX))]
    #[arg(allow_negative_numbers = true)]
    pub(crate) width: u32,
    /// Height of the picture in pixels
    #[arg(long, value_name = "PIXELS", default_value_t = 512, value_parser = parse::integer(1..=u32::MAX))]
    #[arg(allow_negative_numbers = true)]
    pub(crate) height: u32,
    /// Pixel filter: how radiance around a pixel's center is weighted
    #[arg(long, value_enum, default_value_t = FilterKind::Box)]
    pub(crate) filter: FilterKind,
    /// Render only the pixels of this rectangle; X and Y count from the upper left corner
    ///
    /// Its pixels have the bits of the whole picture. With path reuse, which shares paths within tiles of 16 x 16 pixels,
    /// tiles are rendered as a whole: the figures and a checkpoint are of all of them. OpenEXR files tell the errors of
    /// blocks of 4 x 4 pixels only if X and Y are multiples of 4, and so are WIDTH and HEIGHT or the rectangle reaches the
    /// border.
    #[arg(long, value_name = "X,Y,WIDTH,HEIGHT", value_parser = Crop::parse, allow_hyphen_values = true)]
    pub(crate) crop: Option<Crop>,
    /// Replace the pictures of --out while they are rendered, for viewers that load a changed file again
    ///
    /// The first time after a second, then at growing intervals, between passes; at most a twentieth of the time goes
    /// to it.
    #[arg(long)]
    pub(crate) preview: bool,
    /// Add depth, normal, albedo, and the indices of triangle and material to OpenEXR pictures
    ///
    /// The first three are means over the pixel, the indices those at its center. Previews do not have them.
    #[arg(long)]
    pub(crate) buffers: bool,
}

impl PictureFlags {
    /// The columns and rows to render; `None` if all.
    pub(super) fn rendered(&self, path_reuse: PathReuse) -> Option<[Range<u32>; 2]> {
        self.crop.map(|crop| crop.rendered(self.width, self.height, path_reuse))
    }

    /// The pixels that are shown, of a film of those that are [rendered](PictureFlags::rendered).
    pub(crate) fn shown(&self) -> Shown {
        Shown(self.crop.unwrap_or(Crop::whole(self.width, self.height)))
    }

    /// Warns if the picture is not `ratio` times as wide as high, for which the camera of a file is meant.
    pub(crate) fn warn_of_aspect(&self, ratio: f64) {
        let Self { width, height, .. } = self;
        if (self.aspect() / ratio - 1.0).abs() > 0.01 {
            let meant = (f64::from(*height) * ratio).round().max(1.0);
            console::warn(format_args!(
                "the file's camera is meant for a picture {ratio:.3} times as wide as high, such as --width {meant} \
                 --height {height}; {width} x {height} pixels keep its vertical field of view"
            ));
        }
    }

    /// Width over height of the picture.
    pub(crate) fn aspect(&self) -> f64 {
        f64::from(self.width) / f64::from(self.height)
    }
}
