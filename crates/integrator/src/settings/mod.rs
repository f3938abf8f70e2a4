//! How a picture is rendered.

mod estimator;
mod pixel_filter;

pub use estimator::Estimator;
pub use pixel_filter::PixelFilter;

use crate::{LightSampling, RenderError, Sampler};
use std::ops::Range;

/// How a picture is rendered. Together with scene and camera it decides the picture's bits,
/// `threads` excepted.
///
/// New settings may come, so they are made by [`Settings::new`] and then changed:
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
    /// Samples for each pixel, at least 1, unless something ends the render before.
    pub samples: u32,
    /// Samples of each pixel in one pass, a power of two up to `2^16`. A picture is made of whole
    /// passes, but for the last, which takes what is left of `samples`.
    ///
    /// With [`Sampler::Sobol`] a pass is also what is stratified together: longer passes make a
    /// smooth picture better and its error, which rests on their number, less certain.
    pub pass_samples: u32,
    /// Where random numbers come from.
    pub sampler: Sampler,
    /// How a pixel weighs the light around its centre.
    pub filter: PixelFilter,
    /// Which random numbers are used.
    pub seed: u64,
    /// Worker threads, at most [`Settings::MAX_THREADS`]; 0 for as many as the machine offers.
    pub threads: usize,
    /// Most bounces of a path: 0 is emitted light only, 1 adds direct light. A limit biases the
    /// picture: light of more bounces is missing. `None` leaves the end to [`Roulette`] alone. At
    /// most [`Settings::MAX_BOUNCES`].
    pub max_bounces: Option<u32>,
    /// How light is found.
    pub estimator: Estimator,
    /// How points on lights are chosen.
    pub light_sampling: LightSampling,
    /// Whether lights are looked for in plane mirrors.
    pub mirror_sampling: MirrorSampling,
    /// Whether neighbouring pixels share what their paths find.
    pub path_reuse: PathReuse,
    /// When paths may be ended at random, and how likely.
    pub roulette: Roulette,
}

/// Whether neighbouring pixels share what their paths find. The mean is right with either; the variance,
/// and what it says of pixels together, differ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum PathReuse {
    /// No: each pixel rests on its own paths, and pixels are independent.
    Off = 0,
    /// In each pass every pixel is in a group with three others of its block of 4 x 4, and another group in
    /// the next. Where paths of a group go on from a second diffuse surface, what they find there is dealt
    /// out among all four by the balance heuristic (Bekaert, Sbert and Halton 2002), at three shadow rays a
    /// sample: a pixel then rests on four times as many paths.
    ///
    /// The errors of a group are alike: a mean over many pixels is no better for it, and its variance
    /// is up to four times what it would be if the pixels were independent.
    ///
    /// Paths that roulette might have refused before ([`Roulette::start`]) are not shared.
    #[default]
    Fours = 1,
}

impl PathReuse {
    /// That of a [`code`](PathReuse::code).
    pub(crate) fn of_code(code: u32) -> Option<Self> {
        [Self::Off, Self::Fours].into_iter().find(|kind| kind.code() == code)
    }

    /// A number for it that stays.
    pub(crate) fn code(self) -> u32 {
        self as u32
    }

    /// How many pixels of a pass have errors that depend on each other. By so much at most the
    /// variance of a sum over pixels can exceed the sum of their variances (Cauchy and Schwarz).
    pub fn dependent_pixels(self) -> u32 {
        match self {
            Self::Off => 1,
            Self::Fours => 4,
        }
    }
}

/// Whether next events look for lights in plane mirrors, which throw light on what they face (a
/// caustic). The mean is right with either; the variance differs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum MirrorSampling {
    /// No: light by way of any mirror is found by scattering alone.
    Off,
    /// In ideal mirrors whose triangles lie in at most 64 planes; curved ones are left to scattering.
    ///
    /// A plane counts if it has at least a 64th of the area of all mirrors together, not counting
    /// triangles of less than a 256th. Light that met two mirrors on its way from a light is found by
    /// scattering alone. A scene without such mirrors costs nothing.
    #[default]
    Planes,
}

/// Russian roulette: ends a path at random, and scales up what survives so that nothing is lost
/// on average (Arvo and Kirk 1990).
///
/// A path whose throughput's largest component is `t` survives with the probability
/// `p = min(t / threshold, MAX_SURVIVE_PROB)`, and its throughput is divided by `p`: what had fallen below
/// the threshold is brought back to it, what is brighter is hardly touched.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Roulette {
    /// How many bounces come before the first one that may be refused. Without a limit on
    /// bounces, at most [`Settings::MAX_BOUNCES`].
    pub start: u32,
    /// The throughput to which survivors are brought back, in `[2^-20, 1]`. A lower one leaves less noise,
    /// and costs more bounces.
    pub threshold: f64,
}

impl Roulette {
    /// The largest probability with which a path goes on: even between perfect mirrors a path
    /// ends.
    pub const MAX_SURVIVE_PROB: f64 = 0.95;

    /// The smallest threshold: `2^-20`.
    pub const MIN_THRESHOLD: f64 = 1.0 / (1 << 20) as f64;
}

impl Settings {
    /// The most pixels of a picture: `2^27`.
    pub const MAX_PIXELS: u64 = 1 << 27;
    /// The most worker threads.
    pub const MAX_THREADS: usize = 1024;
    /// The most bounces that a path can be made to take: `2^20`.
    pub const MAX_BOUNCES: u32 = 1 << 20;

    /// `width` x `height` pixels of `samples` samples each, Sobol' points in passes of 16; box
    /// filter, seed 0, all threads, no limit on bounces, multiple importance sampling, lights looked
    /// for in plane mirrors, paths shared by four pixels, roulette from the third bounce on at a threshold of 0.35.
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
            mirror_sampling: MirrorSampling::default(),
            path_reuse: PathReuse::default(),
            roulette: Roulette { start: 2, threshold: 0.35 },
        }
    }

    /// How many passes make up all samples.
    pub fn passes(&self) -> u32 {
        self.samples.div_ceil(self.pass_samples)
    }

    /// The samples that `passes` take of each pixel, as a range of their indices.
    pub(crate) fn samples_of(&self, passes: Range<u32>) -> Range<u32> {
        let first = |pass: u32| u64::from(pass) * u64::from(self.pass_samples);
        let [start, end] = [passes.start, passes.end].map(|pass| first(pass).min(self.samples.into()) as u32);
        start..end
    }

    /// The samples of the pass to which `sample` belongs.
    pub(crate) fn pass_of(&self, sample: u32) -> Range<u32> {
        let pass = sample / self.pass_samples;
        self.samples_of(pass..pass + 1)
    }

    /// What [`Settings::path_reuse`] comes to: nothing is shared of light of less than two bounces, nor if
    /// roulette may refuse any path.
    pub(crate) fn path_reuse_in_effect(&self) -> PathReuse {
        let shared = self.max_bounces.is_none_or(|max| max >= 2) && self.roulette.start > 0;
        if shared { self.path_reuse } else { PathReuse::Off }
    }

    /// How many bounces a path takes whatever roulette says, if it finds something to bounce off.
    fn certain_bounces(&self) -> u32 {
        self.max_bounces.unwrap_or(self.roulette.start)
    }

    /// Checks every setting against its range; [`render`](crate::render) does so too.
    ///
    /// # Errors
    /// [`RenderError::Param`] for the first one outside.
    pub fn validate(&self) -> Result<(), RenderError> {
        let pixels = u64::from(self.width) * u64::from(self.height);
        let checks = [
            (self.width >= 1, "width", f64::from(self.width), "[1, inf)"),
            (self.height >= 1, "height", f64::from(self.height), "[1, inf)"),
            (pixels <= Self::MAX_PIXELS, "width x height", pixels as f64, "[1, 2^27]"),
            (self.samples >= 1, "samples", f64::from(self.samples), "[1, inf)"),
            (
                self.pass_samples.is_power_of_two() && self.pass_samples <= Sampler::MAX_PASS,
                "pass_samples",
                f64::from(self.pass_samples),
                "the powers of two in [1, 2^16]",
            ),
            (self.threads <= Self::MAX_THREADS, "threads", self.threads as f64, "[0, 1024]"),
            (
                self.certain_bounces() <= Self::MAX_BOUNCES,
                "bounces",
                f64::from(self.certain_bounces()),
                "[0, 2^20]",
            ),
            (
                (Roulette::MIN_THRESHOLD..=1.0).contains(&self.roulette.threshold),
                "threshold of roulette",
                self.roulette.threshold,
                "[2^-20, 1]",
            ),
        ];
        match checks.into_iter().find(|(valid, ..)| !valid) {
            Some((_, name, value, range)) => Err(RenderError::Param { name, value, range }),
            None => Ok(()),
        }
    }
}
