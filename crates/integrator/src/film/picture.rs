use super::Film;
use crate::{CheckpointError, Counters};

/// The passes of a picture rendered so far.
///
/// A picture can be [saved](Picture::to_bytes), continued ([`Render::resume`](crate::Render::resume)), and
/// [merged](Picture::merge) with other passes of the same picture; the bits are those of one run.
///
/// ```
/// use globillum_integrator::{Picture, Render, Settings, render};
/// # use globillum_integrator::{Model, PinholeCamera, Scene};
/// # use glam::{DVec3, Vec3};
/// # use globillum_geom::{KdTree, Triangle};
/// # use globillum_material::{Material, Rgb};
/// # let mut model = Model::default();
/// # let [a, b, c] = [Vec3::new(-9.0, -9.0, -1.0), Vec3::new(9.0, -9.0, -1.0), Vec3::new(0.0, 9.0, -1.0)];
/// # model.add(Material::light(Rgb::WHITE)?, [Triangle::new(a, b, c)]);
/// # let scene = Scene::build(model, KdTree::build)?;
/// # let camera = PinholeCamera::look_at(DVec3::ZERO, -DVec3::Z, DVec3::Y, 0.7)?;
/// let settings = Settings::new(8, 8, 64); // four passes of 16 samples
/// let mut here = Render::new(&scene, &camera, &settings).passes(0..2).run()?;
/// let elsewhere = Render::new(&scene, &camera, &settings).passes(2..4).run()?.to_bytes();
/// here.merge(Picture::from_bytes(&elsewhere)?)?;
/// assert_eq!(here.film, render(&scene, &camera, &settings)?.film);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Picture {
    /// The pixels, with the same number of samples each; of a strip of the picture, if only that was
    /// [rendered](crate::Render::rows). A [crop](crate::Render::crop) is a picture of its own.
    pub film: Film,
    /// Height of the picture or crop in pixels, of which the film may hold a strip.
    pub height: u32,
    /// Counts of rays and ends of paths.
    pub counters: Counters,
    /// Samples of each pixel.
    pub samples: u32,
    /// Samples in a pass; only the last one held may have fewer.
    pub pass_samples: u32,
    /// A hash of all that determines the picture's bits ([`Render::key`](crate::Render::key)).
    pub key: u64,
    /// Why no more samples were taken.
    pub ending: Ending,
}

/// Why a render ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Ending {
    /// Not ended: the picture was passed to a monitor, read from a checkpoint, or merged.
    Open,
    /// All samples asked for were taken.
    Samples,
    /// The goals were met, or with a pilot, the samples planned for them were taken.
    Goals,
    /// The time limit was reached.
    Seconds,
    /// The monitor cancelled it.
    Cancelled,
}

impl Picture {
    pub(crate) fn new(film: Film, height: u32, pass_samples: u32, key: u64) -> Self {
        let (counters, ending) = (Counters::default(), Ending::Open);
        Self { film, height, counters, samples: 0, pass_samples, key, ending }
    }

    /// Adds the passes of `other`, rendered of the same rows of the same scene, camera and settings. The order
    /// of merges does not change the bits. Strips, and many checkpoints, are merged by [`Merge`](crate::Merge).
    ///
    /// # Errors
    /// [`CheckpointError::Mismatch`] if `other` is another picture or has other rows, [`CheckpointError::CutShort`] if one
    /// of them has a pass cut short that is not the last of all, [`CheckpointError::Overlap`] for a pass that both hold.
    /// This picture is then unchanged.
    pub fn merge(&mut self, other: Self) -> Result<(), CheckpointError> {
        if self.key != other.key {
            return Err(CheckpointError::OTHER_PICTURE);
        }
        if self.is_cut_before(&other) || other.is_cut_before(self) {
            return Err(CheckpointError::CutShort);
        }
        let samples = self.samples.checked_add(other.samples);
        let samples = samples.ok_or(CheckpointError::Malformed("number of samples"))?;
        self.film.merge(other.film)?;
        self.counters += other.counters;
        self.samples = samples;
        self.ending = Ending::Open;
        Ok(())
    }

    /// Whether the last pass is cut short, and `other` has one after it.
    fn is_cut_before(&self, other: &Self) -> bool {
        let passes: u64 = self.film.passes().iter().map(|range| range.len() as u64).sum();
        let end = |picture: &Self| picture.film.passes().last().map_or(0, |range| range.end);
        self.film.samples() < passes * u64::from(self.pass_samples) && end(self) < end(other)
    }
}
