use super::kinds::FilterKind;
use crate::parse;
use serde::Serialize;

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
    /// Pixel filter: how radiance around a pixel's centre is weighted
    #[arg(long, value_enum, default_value_t = FilterKind::Box)]
    pub(crate) filter: FilterKind,
}

impl PictureFlags {
    /// Width over height of the picture.
    pub(crate) fn aspect(&self) -> f64 {
        f64::from(self.width) / f64::from(self.height)
    }
}
