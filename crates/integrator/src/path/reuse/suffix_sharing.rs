//! Path reuse between pixels of a tile (Bekaert, Sbert and Halton 2002).
//!
//! A path's *prefix* ends at its first diffuse vertex `x`; its *suffix* begins at the next vertex `y`. If `y`
//! is diffuse, the radiance of the suffix leaves `y` equally in all directions, so each prefix of a group
//! of pixels could have found it. It is shared among these prefixes by the balance heuristic. If `y` is on a mirror, the
//! suffix begins at the diffuse vertex that the mirror shows, and prefixes find it by way of the same triangle. A path that
//! leaves the scene after its prefix has the environment for a suffix.
//!
//! Light that a suffix finds by way of mirrors is rare and bright where light samples hardly ever find it. If
//! [`RenderContext::shares_caustics`], all prefixes of the square share it.
//!
//! In the open, most paths leave the scene after their prefix. There the radiance of the environment is a control variate:
//! it is taken to arrive at prefixes from all directions, and suffixes are what differs from it.

use super::connection::Connection;
use super::prefixes::Prefixes;
use crate::batch_queries;
use crate::path::counters::Counters;
use crate::path::radiance_sums::RadianceSums;
use crate::path::render_context::RenderContext;
use crate::path::tile_samples::TileSamples;
use globillum_geom::Ray;
use globillum_material::Rgb;
use std::ops::Range;

/// Radiance that arrives along a suffix, and is divided among prefixes.
#[derive(Clone, Copy, Debug)]
struct SharedRadiance {
    radiance: Rgb,
    /// How many connections divide it.
    connections: usize,
}

/// Suffixes and the prefixes that share them. Its buffers are reused.
#[derive(Debug, Default)]
pub(in crate::path) struct SuffixSharing {
    shared: Vec<SharedRadiance>,
    /// Those of all shared radiance, in order, each with how many rays must be unoccluded: two by way of a mirror, none for the
    /// connection of a suffix to its own prefix, which is first.
    connections: Vec<(Connection, usize)>,
    /// The segments of all connections, in order.
    rays: Vec<Ray>,
    occluded: Vec<bool>,
}

impl SuffixSharing {
    /// Adds the radiance of all suffixes to that of the samples of a tile whose prefixes can be continued by them.
    pub(in crate::path) fn share(
        &mut self,
        context: &RenderContext<'_>,
        (samples, control_variates): (&TileSamples, &[Rgb]),
        prefixes: &Prefixes,
        radiance: &mut RadianceSums,
        counters: &mut Counters,
    ) {
        if !context.reuses_paths() {
            return;
        }
        self.shared.clear();
        self.connections.clear();
        self.rays.clear();
        context.simd.run(
            #[inline(always)]
            || {
                let control_variate = |sample: u32| control_variates[sample as usize / samples.per_square()];
                self.connect_groups(context, prefixes, &radiance.after_prefixes, control_variate);
            },
        );
        // Those of caustics, to the prefixes of their squares.
        for &caustic @ (sample, _) in &radiance.suffix_caustics {
            self.connect(context, prefixes, caustic, samples.of_square(sample));
        }
        batch_queries::occluded(context.scene.accel(), &self.rays, &mut self.occluded);
        counters.shadow_rays += self.rays.len() as u64;
        self.combine(prefixes, &mut radiance.samples);
        for (i, &control_variate) in control_variates.iter().enumerate() {
            let of_square = i * samples.per_square()..samples.count().min((i + 1) * samples.per_square());
            add_control_variate(control_variate, prefixes, of_square, &mut radiance.samples);
        }
    }

    /// Connects each suffix to the prefixes of its group, which share what it differs from the control variate.
    #[inline(always)]
    fn connect_groups(
        &mut self,
        context: &RenderContext<'_>,
        prefixes: &Prefixes,
        suffixes: &[Rgb],
        control_variate: impl Fn(u32) -> Rgb,
    ) {
        for group in prefixes.groups() {
            for sample in group.iter().copied().flatten() {
                let difference = suffixes[sample as usize] - control_variate(sample);
                if !difference.is_black() {
                    self.connect(context, prefixes, (sample, difference), group.iter().copied().flatten());
                }
            }
        }
    }

    /// Connects the suffix of a sample to its own prefix and to those of `samples`, which share this radiance.
    #[inline(always)]
    fn connect(
        &mut self,
        context: &RenderContext<'_>,
        prefixes: &Prefixes,
        (sample, radiance): (u32, Rgb),
        samples: impl Iterator<Item = u32>,
    ) {
        let Self { shared, connections, rays, .. } = self;
        let Some(own) = prefixes.of(sample) else { return };
        let before = connections.len();
        // A radiance that is not finite stays with its own sample, so that an error names that one.
        let suffix = own.suffix.as_ref().filter(|_| radiance.is_finite());
        let found = suffix.and_then(|suffix| own.end.density_at(suffix));
        let density = found.map_or(1.0, |(density, _)| density);
        connections.push((Connection::new(sample, density, own.guide_ratio), 0));
        if let Some(suffix) = suffix.filter(|_| found.is_some()) {
            for (other_sample, other) in prefixes.others_like(sample, samples) {
                let Some((density, direction)) = other.end.density_at(suffix) else { continue };
                let added = other.end.push_rays(context.scene.triangles(), suffix, direction, rays);
                if added > 0 {
                    let guide_ratio = other.end.guide_ratio(context.guide, direction);
                    connections.push((Connection::new(other_sample, density, guide_ratio), added));
                }
            }
        }
        shared.push(SharedRadiance { radiance, connections: connections.len() - before });
    }

    /// Divides all shared radiance among the prefixes with an unoccluded connection.
    fn combine(&mut self, prefixes: &Prefixes, samples: &mut [Rgb]) {
        let mut occluded = self.occluded.iter();
        for (connection, rays) in &mut self.connections {
            if occluded.by_ref().take(*rays).fold(false, |any, &is_occluded| any | is_occluded) {
                *connection = connection.occluded();
            }
        }
        let mut rest = &*self.connections;
        for &SharedRadiance { radiance, connections } in &self.shared {
            let (connections, others) = rest.split_at(connections);
            rest = others;
            let connections = connections.iter().map(|(connection, _)| (connection, radiance));
            Connection::divide(connections, prefixes, samples);
        }
    }
}

/// Adds what is taken to arrive at the ends of the prefixes of these samples from all directions.
fn add_control_variate(
    control_variate: Rgb,
    prefixes: &Prefixes,
    of_square: Range<usize>,
    samples: &mut [Rgb],
) {
    if control_variate.is_black() {
        return;
    }
    for sample in of_square {
        let throughput = prefixes.of(sample as u32).map_or(Rgb::BLACK, |prefix| prefix.throughput);
        samples[sample] += throughput * control_variate;
    }
}
