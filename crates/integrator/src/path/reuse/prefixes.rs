//! The prefixes of paths, and where their suffixes begin.

use super::pixel_groups::{Groups, PixelGroup};
use super::reuse_vertex::{ReuseVertex, Suffix};
use crate::path::path_state::Path;
use crate::path::path_vertex::PathVertex;
use crate::path::radiance_sums::Target;
use crate::path::render_context::RenderContext;
use crate::path::tile_samples::TileSamples;
use glam::DVec3;
use globillum_material::Rgb;

/// The prefix of a path, up to its first diffuse vertex, and where its suffix begins.
#[derive(Clone, Copy, Debug)]
pub(in crate::path) struct Prefix {
    pub(in crate::path) end: ReuseVertex,
    /// The bounce at which it ends. A limit on bounces gives suffixes of one length to prefixes of one
    /// length, so only these share them.
    pub(in crate::path) bounce: u32,
    /// The factor on the radiance that arrives at the end along the path, if directions there are sampled by the BSDF.
    pub(in crate::path) throughput: Rgb,
    /// How many times as dense as by the BSDF its own direction there was sampled.
    pub(in crate::path) guide_ratio: f64,
    /// The largest throughput, by component, of the prefixes that end at this bounce and may share its suffix or a part of
    /// what that finds. Roulette goes by it, so that it ends no suffix for certain that one of them can use.
    pub(in crate::path) largest_throughput: Rgb,
    /// The next vertex of its own path, if that is on a mirror.
    pub(in crate::path) mirror: Option<ReuseVertex>,
    /// Its own suffix, if that has begun.
    pub(super) suffix: Option<Suffix>,
}

/// The prefixes of a wavefront.
#[derive(Debug, Default)]
pub(in crate::path) struct Prefixes {
    /// One for each sample, `None` until it ends. None if paths are not reused.
    all: Vec<Option<Prefix>>,
    /// The samples that share suffixes.
    groups: Vec<PixelGroup>,
    /// Whether prefixes have ended since [`Prefix::largest_throughput`] was computed.
    have_ended: bool,
}

impl Prefixes {
    /// Prepares for these samples.
    pub(in crate::path) fn start(&mut self, context: &RenderContext<'_>, samples: &TileSamples) {
        self.all.clear();
        self.groups.clear();
        if context.reuses_paths() {
            self.all.resize(samples.count(), None);
            let groups = Groups::of_pass(context.settings.pass_of(samples.in_pixel.start));
            let of_samples = |group: PixelGroup| {
                let of_pixel = 0..samples.in_pixel.len();
                of_pixel.map(move |i| group.map(|pixel| samples.of_pixel(pixel?).nth(i)))
            };
            self.groups.extend(groups.of_tile(samples.tile).flat_map(of_samples));
        }
    }

    /// How many there may be: one for each sample, or none if paths are not reused.
    pub(in crate::path) fn len(&self) -> usize {
        self.all.len()
    }

    /// The samples of each group.
    pub(super) fn groups(&self) -> &[PixelGroup] {
        &self.groups
    }

    /// The prefix of a sample, if it has ended.
    #[inline(always)]
    pub(in crate::path) fn of(&self, sample: u32) -> Option<&Prefix> {
        self.all[sample as usize].as_ref()
    }

    /// The prefixes of `samples`, except that of sample `own`, that may share what the path of `own` has found: those that
    /// end at the same bounce as its prefix.
    #[inline(always)]
    pub(super) fn others_like(
        &self,
        own: u32,
        samples: impl Iterator<Item = u32>,
    ) -> impl Iterator<Item = (u32, &Prefix)> {
        let bounce = self.of(own).map(|prefix| prefix.bounce);
        let others = samples.filter(move |&sample| sample != own);
        let ended = others.filter_map(|sample| Some((sample, self.of(sample)?)));
        ended.filter(move |(_, prefix)| Some(prefix.bounce) == bounce)
    }

    /// The throughput of the prefix before what is added to `target`.
    pub(in crate::path) fn throughput_before(&self, target: Target) -> Rgb {
        match target {
            Target::Sample(_) => Rgb::WHITE,
            Target::AfterPrefix(sample) => {
                let prefix = self.all.get(sample as usize).and_then(Option::as_ref);
                prefix.map_or(Rgb::WHITE, |prefix| prefix.throughput / prefix.guide_ratio)
            }
        }
    }

    /// Ends the prefix of a path at the vertex that scattered it.
    #[inline(always)]
    pub(in crate::path) fn end(&mut self, path: &Path, vertex: &PathVertex<'_>) {
        let (end, bounce, throughput) =
            (ReuseVertex::at(vertex), vertex.bounce, path.throughput * path.guide_ratio);
        self.all[path.target.sample() as usize] = Some(Prefix {
            end,
            bounce,
            throughput,
            guide_ratio: path.guide_ratio,
            largest_throughput: throughput,
            mirror: None,
            suffix: None,
        });
        self.have_ended = true;
    }

    /// Finds the largest throughput of the prefixes that ended at `bounce` and share suffixes: those of each group, or of
    /// each square if it shares what suffixes find of caustics.
    pub(in crate::path) fn update_largest_throughputs(
        &mut self,
        context: &RenderContext<'_>,
        samples: &TileSamples,
        bounce: u32,
    ) {
        if !std::mem::take(&mut self.have_ended) {
            return;
        }
        let Self { all, groups, .. } = self;
        if context.shares_caustics {
            samples.by_square().for_each(|of_square| update_largest_throughput(all, of_square, bounce));
        } else {
            let of_groups = groups.iter().map(|group| group.iter().flatten().copied());
            of_groups.for_each(|of_group| update_largest_throughput(all, of_group, bounce));
        }
    }

    /// Notes the mirror that a path meets after its prefix. What the path finds from here on is added to the sum of its
    /// suffix, but no other prefix has a part in it unless the suffix begins at the next vertex.
    #[inline(always)]
    pub(in crate::path) fn meet_mirror(&mut self, path: &mut Path, vertex: &PathVertex<'_>) {
        let Some(prefix) = &mut self.all[path.target.sample() as usize] else { return };
        prefix.mirror = Some(ReuseVertex::at(vertex));
        path.largest_prefix_throughput = prefix.throughput;
        path.leave_prefix();
    }

    /// Begins the suffix of a path at this diffuse vertex, the next one after its prefix or after the mirror there. The
    /// throughput of the suffix includes that of the mirror.
    #[inline(always)]
    pub(in crate::path) fn begin_suffix(&mut self, path: &mut Path, vertex: &PathVertex<'_>) {
        let Some(prefix) = &mut self.all[path.target.sample() as usize] else { return };
        prefix.suffix = Some(Suffix::Surface { start: ReuseVertex::at(vertex), mirror: prefix.mirror });
        path.largest_prefix_throughput = prefix.largest_throughput;
        if prefix.mirror.is_none() {
            path.leave_prefix();
        }
    }

    /// Makes the environment the suffix of a path that leaves the scene right after its prefix, in `direction`.
    #[inline(always)]
    pub(in crate::path) fn leave_scene(&mut self, path: &mut Path, direction: DVec3) {
        let Some(prefix) = &mut self.all[path.target.sample() as usize] else { return };
        prefix.suffix = Some(Suffix::Environment(direction.normalize()));
        path.leave_prefix();
    }
}

/// Finds the largest throughput of the prefixes of these samples that ended at `bounce`.
fn update_largest_throughput(
    all: &mut [Option<Prefix>],
    samples: impl Iterator<Item = u32> + Clone,
    bounce: u32,
) {
    let ended = |prefix: &&Prefix| prefix.bounce == bounce;
    let prefixes = samples.clone().filter_map(|sample| all[sample as usize].as_ref()).filter(ended);
    let largest = prefixes.fold(Rgb::BLACK, |largest, prefix| largest.max(prefix.throughput));
    for sample in samples {
        if let Some(prefix) = all[sample as usize].as_mut().filter(|prefix| prefix.bounce == bounce) {
            prefix.largest_throughput = largest;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::Wavefront;
    use crate::path::test_rooms::{advanced, camera, room, settings};

    /// Roulette must not end a suffix for certain while a prefix of its square can use what the suffix finds of caustics:
    /// that prefix counts on it in the balance heuristic. The floor has colours without blue and without red.
    #[test]
    fn roulette_goes_by_all_prefixes_that_share_caustics() {
        let (scene, camera, settings) = (room(0.2), camera(0.9), settings());
        let context = RenderContext::new(&scene, &camera, &settings);
        let context = RenderContext { shares_caustics: true, ..context };
        let Wavefront { samples, prefixes, .. } = advanced(&context);
        let of = |sample| prefixes.of(sample).map(|prefix| (prefix.bounce, prefix.throughput));
        let mut pairs = 0;
        let all = 0..samples.count() as u32;
        for (sample, own) in all.filter_map(|sample| Some((sample, prefixes.of(sample)?))) {
            for (bounce, throughput) in samples.of_square(sample).filter_map(of) {
                if bounce == own.bounce {
                    assert_eq!(own.largest_throughput.max(throughput), own.largest_throughput, "{sample}");
                    pairs += u32::from(throughput.r == 0.0 && own.throughput.b == 0.0);
                }
            }
        }
        assert!(pairs > 1000, "{pairs}");
    }
}
