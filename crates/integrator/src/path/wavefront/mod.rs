//! The paths of a tile, advanced side by side.

mod numbers;
mod shade;
mod start;
mod supersampling_rays;

use super::caustics::{PhotonRays, SharedCaustics};
use super::counters::Counters;
use super::next_event::{Choices, LargeMirrorRays, SmallMirrorRays};
use super::path_state::Path;
use super::radiance_sums::{Contribution, RadianceSums};
use super::render_context::RenderContext;
use super::reuse::{Prefixes, SuffixSharing};
use super::tile_probes::TileProbes;
use super::tile_samples::TileSamples;
use crate::checked_accel;
use crate::light::{ChosenLight, ChosenMirror};
use crate::sampler::BounceNumbers;
use globillum_geom::{Hit, Ray, SurfacePoint};
use globillum_material::Rgb;
use std::f64::consts::PI;
use std::ops::Range;
use supersampling_rays::SupersamplingRays;

/// All paths of some samples of a tile, advanced together one bounce at a time, so that the accelerator
/// gets many rays at once (Laine, Karras and Aila 2013). Its buffers are reused from tile to tile.
#[derive(Debug, Default)]
pub(crate) struct Wavefront {
    /// Those whose paths were started last.
    pub(super) samples: TileSamples,
    /// The paths that have not ended.
    pub(super) paths: Vec<Path>,
    /// The next ray of each path.
    pub(super) rays: Vec<Ray>,
    /// The paths that begin at a point of irradiance, and these points. They join the others after the first bounce.
    pub(super) from_points: Vec<Path>,
    pub(super) points: Vec<SurfacePoint>,
    pub(super) hits: Vec<Option<Hit>>,
    /// Uniform numbers for the positions of the samples in their pixels.
    position_numbers: Vec<[f64; 2]>,
    /// The cells of the hits in the guide, with some more at the end; none if there is no guide.
    guide_cells: Vec<u32>,
    /// The random numbers of each path's next bounce.
    bounce_numbers: Vec<BounceNumbers>,
    light_choices: Choices<ChosenLight>,
    /// The random numbers by which paths choose small mirrors; empty unless most take one sample of them.
    small_mirror_numbers: Vec<f64>,
    small_mirror_choices: Choices<ChosenMirror>,
    /// The random numbers of each path for a light in a large mirror; empty unless most paths take such a sample.
    large_mirror_numbers: Vec<(f64, [f64; 2])>,
    /// Light samples.
    pub(super) contributions: Vec<Contribution>,
    /// The shadow ray of each contribution.
    pub(super) shadow_rays: Vec<Ray>,
    pub(super) occluded: Vec<bool>,
    large_mirror_rays: LargeMirrorRays,
    pub(super) small_mirror_rays: SmallMirrorRays,
    supersampling_rays: SupersamplingRays,
    pub(super) radiance: RadianceSums,
    pub(super) prefixes: Prefixes,
    pub(super) suffix_sharing: SuffixSharing,
    pub(super) caustics: SharedCaustics,
    photon_rays: PhotonRays,
}

/// Irradiance over the radiance of a white diffuse surface.
pub(super) const IRRADIANCE_PER_RADIANCE: f64 = PI;

impl Wavefront {
    /// Traces these samples of each pixel of the tile; `None` if `cancelled` before the last bounce.
    pub(crate) fn trace(
        &mut self,
        context: &RenderContext<'_>,
        probes: &TileProbes,
        samples: Range<u32>,
        cancelled: impl Fn() -> bool,
    ) -> Option<Counters> {
        self.start(context, probes, samples);
        let mut counters = Counters { camera_rays: self.rays.len() as u64, ..Counters::default() };
        self.advance_to_end(context, &mut counters, cancelled)?;
        let Self { samples, prefixes, radiance, .. } = self;
        let control_variates = &probes.control_variates;
        self.suffix_sharing.share(context, samples, control_variates, prefixes, radiance, &mut counters);
        self.photon_rays.trace(context, samples, prefixes, &mut radiance.samples, &mut counters);
        self.caustics.share(context, samples, prefixes, &mut radiance.samples, &mut counters);
        for path in &self.from_points {
            *radiance.at(path.target) *= IRRADIANCE_PER_RADIANCE;
        }
        counters.camera_rays += self.supersample(context, probes);
        Some(counters)
    }

    /// The radiance of the samples traced last, pixel by pixel.
    pub(crate) fn radiance(&self) -> &[Rgb] {
        &self.radiance.samples
    }

    /// Adds what the rays of supersampling find of the lights at edges. Returns their number.
    fn supersample(&mut self, context: &RenderContext<'_>, probes: &TileProbes) -> u64 {
        let rays = self.supersampling_rays.find(context, &probes.edges, &self.samples);
        for &(sample, emitted) in &self.supersampling_rays.found {
            self.radiance.samples[sample as usize] += emitted;
        }
        rays
    }

    /// What these camera rays have found for a sample.
    pub(super) fn lights_seen_by(&self, sample: u32) -> Rgb {
        let found = self.supersampling_rays.found.iter().find(|&&(of, _)| of == sample);
        found.map_or(Rgb::BLACK, |&(_, emitted)| emitted)
    }

    /// Advances all paths until they have ended; `None` if `cancelled` before.
    pub(super) fn advance_to_end(
        &mut self,
        context: &RenderContext<'_>,
        counters: &mut Counters,
        cancelled: impl Fn() -> bool,
    ) -> Option<()> {
        for bounce in 0.. {
            if cancelled() {
                return None;
            }
            self.advance(context, bounce, counters);
            if self.paths.is_empty() {
                break;
            }
        }
        Some(())
    }

    /// Advances all paths by one bounce.
    pub(super) fn advance(&mut self, context: &RenderContext<'_>, bounce: u32, counters: &mut Counters) {
        self.shade(context, bounce, counters);
        self.trace_light_samples(context);
        let mirror_rays = self.large_mirror_rays.len() + self.small_mirror_rays.len();
        counters.shadow_rays += (mirror_rays + self.shadow_rays.len()) as u64;
        counters.bounce_rays += self.rays.len() as u64;
    }

    /// Adds the light samples of a bounce that are not occluded. Those by way of large mirrors become contributions, which
    /// follow the direct ones; returns the number of these.
    pub(super) fn trace_light_samples(&mut self, context: &RenderContext<'_>) -> usize {
        let direct_count = self.contributions.len();
        self.large_mirror_rays.trace(context, &mut self.shadow_rays, &mut self.contributions);
        self.small_mirror_rays.trace(context);
        checked_accel::occluded(context.scene.accel(), &self.shadow_rays, &mut self.occluded);
        let unoccluded = self.contributions.iter().zip(&self.occluded).filter(|(_, occluded)| !**occluded);
        let contributions = unoccluded.map(|(contribution, _)| contribution);
        for contribution in contributions.chain(&self.small_mirror_rays.found) {
            *self.radiance.at(contribution.target) += contribution.radiance;
        }
        direct_count
    }
}
