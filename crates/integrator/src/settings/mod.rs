//! How a picture is rendered.

mod estimator;
mod pixel_filter;

pub use estimator::Estimator;
pub use pixel_filter::PixelFilter;

use crate::param::Param;
use crate::pixel_rect::SQUARE_SIDE;
use crate::{LightSampling, RenderError, Sampler, Sensor};
use std::ops::Range;

/// How a picture is rendered. With scene and sensor it determines the picture's bits, except for
/// `threads`.
///
/// Made by [`Settings::new`] and then changed, since fields may be added:
///
/// ```
/// use globillum_integrator::{Sampler, Settings};
///
/// let mut settings = Settings::new(640, 480, 256);
/// settings.sampler = Sampler::Independent;
/// settings.max_bounces = Some(1); // direct light only
/// settings.validate()?;
/// # Ok::<(), globillum_integrator::RenderError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// Width in pixels, at least 1.
    pub width: u32,
    /// Height in pixels, at least 1. At most [`Settings::MAX_PIXELS`] in all.
    pub height: u32,
    /// Samples per pixel, at least 1. The render may be [stopped](crate::Stop) before it has all of them.
    ///
    /// With [`Sampler::Sobol`], errors are known from two passes on: with no more samples than those of one pass, margins
    /// are infinite and no goal is met. A picture can be continued if its samples are a multiple of those of a pass.
    pub samples: u32,
    /// Samples per pixel in one pass, a power of two up to `2^16`. The last pass takes what is left of
    /// `samples`.
    ///
    /// With [`Sampler::Sobol`] a pass is also what is stratified together: longer passes make a
    /// smooth picture better and its error, which rests on their number, less certain.
    pub pass_samples: u32,
    /// Where random numbers come from.
    pub sampler: Sampler,
    /// How a pixel weighs the light around its center.
    pub filter: PixelFilter,
    /// Which random numbers are used.
    pub seed: u64,
    /// Worker threads, at most [`Settings::MAX_THREADS`]; 0 for one per processor. Each computation starts its own, also in
    /// a thread pool of the caller; of many at a time, each may have 1.
    pub threads: usize,
    /// The largest number of bounces of a path, at most [`Settings::MAX_BOUNCES`]: 0 is emission only, 1 adds
    /// direct light. A limit biases the picture, since light of more bounces is missing. With `None`,
    /// [`Roulette`] alone ends paths. A [point of irradiance](crate::PathStart::Irradiance) is the first bounce of its
    /// paths: with 0 it measures nothing, with 1 direct irradiance.
    pub max_bounces: Option<u32>,
    /// The technique that finds emission.
    pub estimator: Estimator,
    /// The distribution of light samples on a triangle.
    pub light_sampling: LightSampling,
    /// Light samples at the first diffuse vertex of a path where each is a choice among several. The vertex takes this many
    /// in a light tree: of three triangles or more, or of a delta light and another light. It takes at most this many among
    /// the triangles of small mirrors: of adjacent coplanar triangles whose area is less than a quarter of the mean area of
    /// a cluster of lights (of a distant light, as much as it looks), as in most curved mirrors. A power of two up to
    /// [`Settings::MAX_LIGHT_SAMPLES`]. Elsewhere there is one. This changes the variance, not the mean.
    pub light_samples: u32,
    /// Whether lights are sampled by way of mirrors.
    pub mirror_sampling: MirrorSampling,
    /// Whether the edges of lights are supersampled.
    pub supersampling: Supersampling,
    /// Whether pixels reuse the paths of other pixels of their tile.
    pub path_reuse: PathReuse,
    /// How diffuse surfaces sample the directions of scattered paths.
    pub guiding: Guiding,
    /// Russian roulette.
    pub roulette: Roulette,
}

/// Whether pixels reuse the paths of other pixels of their tile, and whether their samples are stratified together. This
/// changes the variance and the correlation of pixels, not the mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum PathReuse {
    /// Pixels are independent.
    Off = 0,
    /// Groups of sixteen pixels share the suffixes of their paths, weighted by the balance heuristic (Bekaert, Sbert and
    /// Halton 2002). A suffix begins at the second diffuse vertex of a path, if it follows the first one directly or by way
    /// of one mirror. It takes up to fifteen more shadow rays per sample, or thirty by way of a mirror. The pixels of a group
    /// are apart: one in each block of 4 x 4 pixels of a tile of 16 x 16. The groups change with each pass.
    ///
    /// A path that leaves the scene after its first diffuse vertex has the environment for a suffix. Where most do, as some
    /// paths at fixed places of each tile find, the environment is a control variate instead: it is taken to arrive from all
    /// directions, and suffixes are what differs from it. A sample may then be negative.
    ///
    /// With [`Sampler::Sobol`] the samples of a tile in a pass are one set of points (Ahmed and Wonka 2020), of which
    /// those of a group, and those of a pixel, are well distributed by themselves.
    ///
    /// The errors of a group are correlated positively. The pixels of a block are in different groups, and its mean has a
    /// variance of its own, which is measured ([`Film::block_variances_of_mean`]). Tiles are independent of each other.
    ///
    /// Light that a path finds after its first diffuse vertex by way of up to eight mirrors is shared by all pixels of the
    /// tile, if some paths at fixed places find little such light. It takes a query for each of these pixels.
    ///
    /// A prefix that Russian roulette could have ended ([`Roulette::start`]) is not shared. In a scene without mirrors,
    /// nothing is shared if suffixes bring less than half of a pixel's variance, as some paths at fixed places find.
    ///
    /// [`Film::block_variances_of_mean`]: crate::Film::block_variances_of_mean
    #[default]
    Tiles = 2,
}

impl PathReuse {
    /// The inverse of [`code`](PathReuse::code).
    pub(crate) fn of_code(code: u32) -> Option<Self> {
        [Self::Off, Self::Tiles].into_iter().find(|kind| kind.code() == code)
    }

    /// A number that is the same in all versions. 1 stands for groups that no version has any more.
    pub(crate) fn code(self) -> u32 {
        self as u32
    }

    /// Pixels along each side of the tiles within which errors depend on each other: a
    /// [crop](crate::Render::crop) begins at multiples of it.
    pub fn tile_side(self) -> u32 {
        match self {
            Self::Off => 1,
            Self::Tiles => SQUARE_SIDE,
        }
    }

    /// The number of pixels whose errors depend on each other. The variance of a sum over pixels is at most
    /// this many times the sum of their variances (Cauchy-Schwarz inequality).
    pub fn dependent_pixels(self) -> u32 {
        self.tile_side() * self.tile_side()
    }
}

/// Whether next event estimation samples triangles that emit by way of mirrors, whose caustics it then finds.
/// This changes the variance, not the mean. Light from delta lights by way of a mirror is never found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum MirrorSampling {
    /// Scattering alone finds light by way of mirrors.
    Off,
    /// By way of all ideal mirrors, plane or of many triangles. A scene without mirrors costs nothing.
    ///
    /// Light by way of more than one mirror is found by scattering. If pixels share caustics ([`PathReuse::Tiles`]) and the
    /// estimator samples lights, it is also looked for where photons left mirrors: half of the first diffuse vertices send
    /// a ray there (after Jensen 1995). For this, each render traces eight paths from the lights for each pixel of the
    /// whole picture, at least `2^14` and at most `2^20`, which take up to 100 MB. They are not counted; their time is.
    #[default]
    Images,
}

/// Whether pixels take more camera rays where they may see the edge of a light. This changes the variance, not the mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Supersampling {
    /// Each sample has one camera ray.
    Off,
    /// Where neighbouring pixels see different emission, directly or by way of mirrors, or a pixel sees a small light
    /// ([`Sensor::project`](crate::Sensor::project)), each sample has sixteen more camera rays, or 32 if its pixel sees a
    /// curved mirror. They follow mirrors up to eight times and find emission only; the sample's path leaves it out.
    #[default]
    Lights,
}

/// How diffuse surfaces sample the directions of scattered paths. This changes the variance, not the mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Guiding {
    /// By the cosine.
    #[default]
    Off = 0,
    /// Half by the cosine, half by what training paths found (path guiding, after Müller, Gross and Novák 2017): for light
    /// that most directions miss, such as that through a door ajar. A sample takes 1.3 to 1.6 times as long.
    ///
    /// There are about 50,000 to `2^18` training paths, more for a long list of points: at least four for each pixel of tiles
    /// that are spread over the whole picture, whatever the crop. They are dropped, and not counted; their time is. Each
    /// render trains: one that resumes too, and each part of a picture. Training takes up to some 100 MB.
    Trained = 1,
}

/// Russian roulette: ends paths at random and divides the throughput of the others by their probability
/// of surviving, which keeps the mean (Arvo and Kirk 1990).
///
/// A path survives with probability `min(t / threshold, MAX_SURVIVE_PROB)`, where `t` is the largest
/// component of its throughput, as it would be without [`Guiding`].
///
/// With [`PathReuse::Tiles`], a shared suffix has one `t` for all its prefixes: the largest component of the suffix's
/// throughput times the largest throughput, component by component, of the prefixes of its group that end at the same
/// bounce. Roulette does not end a path at the mirrors, up to eight, that follow its prefix directly.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Roulette {
    /// The number of bounces before roulette begins. Without a limit on bounces, at most
    /// [`Settings::MAX_BOUNCES`].
    pub start: u32,
    /// The throughput of survivors, in `[2^-20, 1]`. A lower one gives less variance and longer paths.
    pub threshold: f64,
}

impl Roulette {
    /// The largest probability of surviving, so that paths between perfect mirrors end too, after 1000 bounces on average.
    /// Let `a` be the albedo of a closed room and `h` the share of directions that leave it: if `a^2 (1 - h)` is larger
    /// than this, the variance is infinite.
    pub const MAX_SURVIVE_PROB: f64 = 0.999;

    /// The smallest threshold: `2^-20`.
    pub const MIN_THRESHOLD: f64 = 1.0 / (1 << 20) as f64;
}

impl Settings {
    /// The most pixels of a picture: `2^27`.
    pub const MAX_PIXELS: u64 = 1 << 27;
    /// The most worker threads.
    pub const MAX_THREADS: usize = 1024;
    /// The largest number of bounces that can be asked for: `2^20`.
    pub const MAX_BOUNCES: u32 = 1 << 20;

    /// The most light samples of each kind at a vertex.
    pub const MAX_LIGHT_SAMPLES: u32 = Sampler::MAX_PARTS;

    /// `width` x `height` pixels of `samples` samples each, with these defaults: Sobol' sampler in passes of
    /// 16, box filter, seed 0, all threads, no limit on bounces, multiple importance sampling, four light samples at
    /// the first diffuse vertex where lights are chosen in a tree and up to four of small mirrors
    /// ([`Settings::light_samples`]), mirror sampling, supersampling of lights, path reuse, no guiding, roulette from the
    /// third bounce at a threshold of 0.2.
    pub fn new(width: u32, height: u32, samples: u32) -> Self {
        Self {
            width,
            height,
            samples,
            pass_samples: 16,
            sampler: Sampler::Sobol,
            filter: PixelFilter::Box,
            seed: 0,
            threads: 0,
            max_bounces: None,
            estimator: Estimator::Mis,
            light_sampling: LightSampling::default(),
            light_samples: 4,
            mirror_sampling: MirrorSampling::default(),
            supersampling: Supersampling::default(),
            path_reuse: PathReuse::default(),
            guiding: Guiding::default(),
            roulette: Roulette { start: 2, threshold: 0.2 },
        }
    }

    /// The number of passes for all samples.
    ///
    /// # Panics
    /// If `pass_samples` is 0, which [`Settings::validate`] refuses.
    pub fn passes(&self) -> u32 {
        self.samples.div_ceil(self.pass_samples)
    }

    /// The number of pixels.
    pub(crate) fn pixel_count(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }

    /// The index of a pixel, row by row.
    #[inline(always)]
    pub(crate) fn pixel_index(&self, x: u32, y: u32) -> u64 {
        u64::from(y) * u64::from(self.width) + u64::from(x)
    }

    /// The indices of the samples of each pixel in `passes`.
    pub(crate) fn samples_of(&self, passes: Range<u32>) -> Range<u32> {
        let first = |pass: u32| u64::from(pass) * u64::from(self.pass_samples);
        let [start, end] = [passes.start, passes.end].map(|pass| first(pass).min(self.samples.into()) as u32);
        start..end
    }

    /// The number of the pass that `sample` belongs to.
    pub(crate) fn pass_of(&self, sample: u32) -> u32 {
        sample / self.pass_samples
    }

    /// The number of bounces that roulette cannot prevent.
    fn certain_bounces(&self) -> u32 {
        self.max_bounces.unwrap_or(self.roulette.start)
    }

    /// The settings, checked, as they are in effect for a render with `sensor`.
    pub(crate) fn for_sensor(&self, sensor: &dyn Sensor) -> Result<Self, RenderError> {
        self.validate()?;
        let settings = [self.width, self.height];
        if let Some(sensor) = sensor.size().filter(|&size| size != settings) {
            return Err(RenderError::SensorSize { settings, sensor });
        }
        Ok(self.in_effect(sensor))
    }

    /// The settings as they are in effect for a render with `sensor`.
    pub(crate) fn in_effect(&self, sensor: &dyn Sensor) -> Self {
        let alone = Self { path_reuse: PathReuse::Off, supersampling: Supersampling::Off, ..*self };
        if sensor.has_neighbours() { *self } else { alone }
    }

    /// A number of samples or rays that are stratified together in a pass.
    pub(crate) fn pass_param(name: &'static str, count: u32) -> Param {
        let is_valid = count.is_power_of_two() && count <= Sampler::MAX_PASS;
        Param::new(is_valid, name, count, "the powers of two in [1, 2^16]")
    }

    /// A number of worker threads.
    pub(crate) fn threads_param(threads: usize) -> Param {
        Param::new(threads <= Self::MAX_THREADS, "threads", threads as f64, "[0, 1024]")
    }

    /// Checks every setting against its range; [`render`](crate::render) does so too.
    ///
    /// # Errors
    /// [`RenderError::Param`] for the first one outside.
    pub fn validate(&self) -> Result<(), RenderError> {
        let (pixels, threshold) = (self.pixel_count(), self.roulette.threshold);
        let is_count = self.light_samples.is_power_of_two() && self.light_samples <= Self::MAX_LIGHT_SAMPLES;
        let bounces = self.certain_bounces();
        let is_threshold = (Roulette::MIN_THRESHOLD..=1.0).contains(&threshold);
        Param::check([
            Param::new(self.width >= 1, "width", self.width, "[1, inf)"),
            Param::new(self.height >= 1, "height", self.height, "[1, inf)"),
            Param::new(pixels <= Self::MAX_PIXELS, "width x height", pixels as f64, "[1, 2^27]"),
            Param::new(self.samples >= 1, "samples", self.samples, "[1, inf)"),
            Self::pass_param("pass_samples", self.pass_samples),
            Param::new(is_count, "light_samples", self.light_samples, "the powers of two in [1, 16]"),
            Self::threads_param(self.threads),
            Param::new(bounces <= Self::MAX_BOUNCES, "bounces", bounces, "[0, 2^20]"),
            Param::new(is_threshold, "threshold of roulette", threshold, "[2^-20, 1]"),
        ])
    }
}
