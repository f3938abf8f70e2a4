use crate::load::Warnings;
use crate::parse;
use serde::{Serialize, Serializer};
use std::path::PathBuf;

/// Where pictures go.
#[derive(clap::Args, Clone, Debug, Default, Serialize)]
#[command(next_help_heading = "Output")]
pub(crate) struct PictureOutput {
    /// Write the picture to FILE, as PNG or OpenEXR by its extension; `-` is standard output, as PNG
    ///
    /// May be given several times. PNG has 8 bits per component in sRGB, for looking at; OpenEXR has linear
    /// radiance in Rec. 709 primaries as 32-bit floats, and in the layer `stderr` its standard error, for
    /// measuring. A file appears when it is complete.
    #[arg(long, value_name = "FILE")]
    #[serde(serialize_with = "paths_as_text")]
    pub(crate) out: Vec<PathBuf>,
    /// Brighten PNG pictures by this number of stops, each of which doubles radiance
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, value_parser = parse::finite)]
    #[arg(allow_negative_numbers = true)]
    pub(crate) exposure: f64,
}

/// Where the figures go, and what is said.
#[derive(clap::Args, Clone, Debug, Serialize)]
#[command(next_help_heading = "Output")]
pub(crate) struct ReportFlags {
    /// Write settings and figures of the render to FILE as JSON; `-` is standard output
    ///
    /// Settings have the names of their flags, with underscores. The table goes to standard error if `-` is
    /// given here or to --out.
    #[arg(long, value_name = "FILE")]
    #[serde(serialize_with = "path_as_text")]
    pub(crate) stats: Option<PathBuf>,
    /// List every warning about a scene file, not the first of each kind
    #[arg(long)]
    pub(crate) verbose: bool,
}

/// A path as text, with a replacement character for what is no UTF-8.
pub(super) fn path_as_text<S: Serializer>(path: &Option<PathBuf>, serializer: S) -> Result<S::Ok, S::Error> {
    path.as_ref().map(|path| path.to_string_lossy()).serialize(serializer)
}

/// Paths as text, with a replacement character for what is no UTF-8.
fn paths_as_text<S: Serializer>(paths: &[PathBuf], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(paths.iter().map(|path| path.to_string_lossy()))
}

impl ReportFlags {
    /// Which warnings about scene files are shown.
    pub(crate) fn warnings(&self) -> Warnings {
        if self.verbose { Warnings::All } else { Warnings::FirstOfEachKind }
    }
}
