//! Path reuse between pixels of a square (Bekaert, Sbert and Halton 2002).
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
use crate::checked_accel;
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
    /// Those of all shared radiance, in order, each with how many rays must be unoccluded: two by way of a mirror, none for
    /// the connection of a suffix to its own prefix, which is first.
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
        samples: &TileSamples,
        control_variates: &[Rgb],
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
        for &(sample, found) in &radiance.suffix_caustics {
            self.connect(context, prefixes, sample, found, samples.of_square(sample));
        }
        checked_accel::occluded(context.scene.accel(), &self.rays, &mut self.occluded);
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
                    self.connect(context, prefixes, sample, difference, group.iter().copied().flatten());
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
        sample: u32,
        radiance: Rgb,
        samples: impl Iterator<Item = u32>,
    ) {
        let Self { shared, connections, rays, .. } = self;
        let Some(own) = prefixes.of(sample) else { return };
        let before = connections.len();
        // A radiance that is not finite stays with its own sample, so that an error names that one.
        let suffix = own.suffix.as_ref().filter(|_| radiance.is_finite());
        let add = |connection, rays| connections.push((connection, rays));
        Connection::connect(context, prefixes, sample, suffix, samples, rays, add);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::Wavefront;
    use crate::path::radiance_sums::Target;
    use crate::path::test_rooms::{advanced, camera, room_with_wall, settings};
    use crate::{MirrorSampling, PathReuse, Roulette, Sampler, Settings};

    /// What a suffix finds by way of mirrors reaches many samples of its number in the square, and no other samples. Its
    /// weights add up to one.
    #[test]
    fn caustics_of_suffixes_are_shared_by_the_square() {
        let (scene, camera) = (room_with_wall(), camera(0.9));
        let (mut more_than_a_group, mut all) = (0, 0);
        for seed in 0..16 {
            let settings = Settings { seed, mirror_sampling: MirrorSampling::Off, ..settings() };
            let context = RenderContext::new(&scene, &camera, &settings);
            let context = RenderContext { shares_caustics: true, ..context };
            let Wavefront { samples, prefixes, mut suffix_sharing, mut radiance, .. } = advanced(&context);
            for (sample, found) in std::mem::take(&mut radiance.suffix_caustics) {
                radiance.after_prefixes.fill(Rgb::BLACK);
                radiance.samples.fill(Rgb::BLACK);
                radiance.suffix_caustics = vec![(sample, found)];
                let counters = &mut Counters::default();
                suffix_sharing.share(&context, &samples, &[Rgb::BLACK], &prefixes, &mut radiance, counters);
                let lit = |number| {
                    let of_number = radiance.samples.iter().skip(number).step_by(4);
                    of_number.filter(|radiance| !radiance.is_black()).count()
                };
                let (own, others) = (lit(sample as usize % 4), (0..4).map(lit).sum::<usize>());
                assert_eq!(own, others, "{sample}");
                let arriving = (0..).zip(&radiance.samples).filter(|(_, radiance)| !radiance.is_black());
                let arriving =
                    arriving.map(|(i, radiance)| radiance.g / prefixes.of(i).map_or(1.0, |p| p.throughput.g));
                assert!((arriving.sum::<f64>() - found.g).abs() <= 1e-12 * found.g, "{sample}");
                more_than_a_group += usize::from(own > 16);
                all += 1;
            }
        }
        assert!(all > 100 && 3 * more_than_a_group > all, "{more_than_a_group} of {all}");
    }

    /// What a path finds by itself is what it finds if none are shared, also if its suffix finds a caustic.
    #[test]
    fn sharing_keeps_what_a_path_finds_alone() {
        let (scene, camera) = (room_with_wall(), camera(0.9));
        let roulette = Roulette { start: 8, threshold: 0.2 };
        let settings = Settings { roulette, max_bounces: Some(8), ..settings() };
        let settings = Settings { sampler: Sampler::Independent, ..settings };
        let settings = Settings { mirror_sampling: MirrorSampling::Off, ..settings };
        let mut caustics = 0;
        for seed in 0..8 {
            let settings = Settings { seed, ..settings };
            let context = RenderContext::new(&scene, &camera, &settings);
            let shared = advanced(&RenderContext { shares_caustics: true, ..context });
            let settings = Settings { path_reuse: PathReuse::Off, ..settings };
            let alone = advanced(&RenderContext::new(&scene, &camera, &settings));
            caustics += shared.radiance.suffix_caustics.len();
            for (sample, alone) in (0..).zip(alone.radiance()) {
                let of_suffix = shared.radiance.after_prefix(sample) + shared.caustics.found_by(sample);
                let throughput = shared.prefixes.throughput_before(Target::AfterPrefix(sample));
                let found = throughput * of_suffix + shared.radiance()[sample as usize];
                assert!((found.g - alone.g).abs() <= 1e-12 * alone.g, "{sample}: {found}, {alone}");
            }
        }
        assert!(caustics > 10, "{caustics}");
    }
}
