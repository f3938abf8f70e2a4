//! Files that are open before the render begins, so that a mistyped name costs no time.

use crate::console;
use crate::failures::Failures;
use crate::flags::PictureOutput;
use anyhow::{Result, ensure};
use globillum::io::{AtomicFile, IoError, PictureData, PictureFile, PictureFormat};
use std::io::{IsTerminal, stdout};
use std::path::{Path, PathBuf};

/// The name of standard output as a file.
pub(crate) const STDOUT: &str = "-";

/// Where pictures and figures go.
#[derive(Debug)]
pub(crate) struct Outputs {
    pictures: Vec<Target<PictureFile>>,
    stats: Option<TextOutput>,
    exposure: f64,
}

#[derive(Debug)]
enum Target<F> {
    /// A file and its name.
    File(PathBuf, F),
    StandardOutput,
}

impl Outputs {
    /// Opens what can be opened; nothing is written yet.
    pub(crate) fn open(pictures: &PictureOutput, stats: Option<&Path>) -> Result<Self> {
        let exposure = pictures.exposure;
        let names = || pictures.out.iter().map(PathBuf::as_path);
        let shown = names().any(|path| path == Path::new(STDOUT)) && stdout().is_terminal();
        ensure!(!shown, "--out -: standard output is a terminal, which shows no pictures");
        let picture = |path: &Path| Ok(PictureFile::create(path)?.exposed(exposure));
        Ok(Self {
            pictures: names().map(|path| Target::open(path, picture)).collect::<Result<_>>()?,
            stats: stats.map(TextOutput::open).transpose()?,
            exposure,
        })
    }

    /// Whether one of them is written to standard output.
    pub(crate) fn use_stdout(&self) -> bool {
        let stats = self.stats.as_ref().is_some_and(TextOutput::is_stdout);
        stats || self.pictures.iter().any(Target::is_stdout)
    }

    /// Whether a picture is written that `--exposure` changes: a PNG.
    pub(crate) fn show_exposed(&self) -> bool {
        self.pictures.iter().any(|picture| match picture {
            Target::File(path, _) => has_format(path, PictureFormat::Png),
            Target::StandardOutput => true,
        })
    }

    /// Whether a picture is to be written.
    pub(crate) fn want_picture(&self) -> bool {
        !self.pictures.is_empty()
    }

    /// Writes the picture wherever it shall go, and then the figures; returns the pictures' files. What cannot be
    /// written is among the `failures`, and the rest is written.
    pub(crate) fn write(
        self,
        data: &PictureData,
        stats: impl FnOnce() -> Result<String>,
        failures: &mut Failures,
    ) -> Vec<PathBuf> {
        let mut written = Vec::new();
        for picture in self.pictures {
            match picture {
                Target::StandardOutput => {
                    let png = PictureFormat::Png.encode(data, self.exposure.exp2());
                    let png = png.map_err(|source| IoError::Encode { path: STDOUT.into(), source }.into());
                    failures.keep(png.and_then(|png| console::print_data(&png)));
                }
                Target::File(path, file) => {
                    written.extend(failures.keep(file.write_data(data)).map(|()| path));
                }
            }
        }
        if let Some(file) = self.stats {
            failures.keep(stats().and_then(|stats| file.write(&stats)));
        }
        written
    }
}

/// A file of text, or standard output.
#[derive(Debug)]
pub(crate) struct TextOutput(Target<AtomicFile>);

impl TextOutput {
    /// Opens the file; nothing is written yet.
    pub(crate) fn open(path: &Path) -> Result<Self> {
        Target::open(path, |path| Ok(AtomicFile::create(path)?)).map(Self)
    }

    pub(crate) fn is_stdout(&self) -> bool {
        self.0.is_stdout()
    }

    pub(crate) fn write(self, text: &str) -> Result<()> {
        match self.0 {
            Target::StandardOutput => console::print_data(text.as_bytes()),
            Target::File(_, file) => Ok(file.commit(|writer| writer.write_all(text.as_bytes()))?),
        }
    }
}

impl<F> Target<F> {
    fn open(path: &Path, create: impl FnOnce(&Path) -> Result<F>) -> Result<Self> {
        if path == Path::new(STDOUT) {
            return Ok(Self::StandardOutput);
        }
        Ok(Self::File(path.into(), create(path)?))
    }

    fn is_stdout(&self) -> bool {
        matches!(self, Self::StandardOutput)
    }
}

/// Whether the extension of a picture's file is that of `format`.
pub(crate) fn has_format(path: &Path, format: PictureFormat) -> bool {
    PictureFormat::of(path).is_ok_and(|of| of == format)
}
