//! Path reuse between pixels of a tile (Bekaert, Sbert and Halton 2002).
//!
//! A path's *prefix* ends at its first diffuse vertex `x`; its *suffix* begins at the next vertex `y`. If `y`
//! is diffuse, the radiance of the suffix leaves `y` equally in all directions, so each prefix of a group
//! of pixels could have found it. It is shared among these prefixes by the balance heuristic. If `y` is on a mirror, the
//! suffix begins at the diffuse vertex that the mirror shows, and prefixes find it by way of the same triangle. A path that
//! leaves the scene after its prefix has the environment for a suffix.
//!
//! Light that a suffix finds by way of mirrors is rare and bright where light samples hardly ever find it. All prefixes of
//! the square share it.
//!
//! In the open, most paths leave the scene after their prefix. There the radiance of the environment is a control variate:
//! it is taken to arrive at prefixes from all directions, and suffixes are what differs from it.

use super::pixel_groups::{Groups, PixelGroup, samples_of_square};
use super::reuse_vertex::{ReuseVertex, Suffix};
use crate::path::counters::Counters;
use crate::path::path_state::{Path, RadianceSums, Target};
use crate::path::render_context::RenderContext;
use crate::path::shading_point::ShadingPoint;
use crate::path::tile_probes::TileProbes;
use crate::pixel_rect::{PixelRect, TILE_SIDE};
use glam::DVec3;
use globillum_geom::Ray;
use globillum_material::Rgb;
use std::ops::Range;

/// A path up to its first diffuse vertex.
#[derive(Clone, Copy, Debug)]
pub(super) struct Prefix {
    pub(super) end: ReuseVertex,
    /// The bounce at which it ends. A limit on bounces gives suffixes of one length to prefixes of one
    /// length, so only these share them.
    pub(super) bounce: u32,
    /// The factor on the radiance that arrives at the end along the path, if directions there are sampled by the BSDF.
    pub(super) throughput: Rgb,
    /// How many times as dense as by the BSDF its own direction there was sampled.
    pub(super) guide_ratio: f64,
    /// The largest throughput, by component, of the prefixes that end at this bounce and may share its suffix or a part of
    /// what that finds. Roulette goes by it, so that it ends no suffix for certain that one of them can use.
    pub(super) largest_throughput: Rgb,
    /// The next vertex of its own path, if that is on a mirror.
    pub(super) mirror: Option<ReuseVertex>,
    /// Where its own suffix begins: at the next vertex, or at the one that the mirror shows.
    start: Option<SuffixStart>,
}

/// Where a suffix begins.
#[derive(Clone, Copy, Debug)]
enum SuffixStart {
    Surface(ReuseVertex),
    /// Outside of the scene, in this unit direction from the prefix.
    Environment(DVec3),
}

/// Radiance that arrives along a suffix, and is divided among prefixes.
#[derive(Clone, Copy, Debug)]
struct SharedRadiance {
    radiance: Rgb,
    /// How many connections divide it.
    connections: usize,
}

/// A suffix as the continuation of a prefix, which is named by its sample.
#[derive(Clone, Copy, Debug)]
struct Connection {
    prefix: u32,
    /// The density, times pi, with which the prefix would have been continued to the suffix by its BSDF alone: per area where
    /// that begins, or per solid angle to the environment.
    density: f64,
    /// The same by the guide, if there is one.
    guided_density: f64,
    /// How many rays must be unoccluded: none to a prefix's own suffix, two by way of a mirror.
    rays: usize,
}

/// The prefixes of a wavefront, and the buffers by which their suffixes are shared.
#[derive(Debug, Default)]
pub(in crate::path) struct Prefixes {
    tile: PixelRect,
    /// One for each sample, `None` until it ends.
    all: Vec<Option<Prefix>>,
    /// The samples that share suffixes.
    groups: Vec<PixelGroup>,
    /// The control variates of successive samples: the radiance that is taken to arrive at the ends of their prefixes from all
    /// directions.
    controls: Vec<Rgb>,
    /// How many samples have one in common.
    samples_of_control: usize,
    /// Whether prefixes have ended since [`Prefix::largest_throughput`] was computed.
    have_ended: bool,
    shared: Vec<SharedRadiance>,
    /// Those of all shared radiance, in order; the connection of a suffix to its own prefix is first.
    connections: Vec<Connection>,
    /// The segments of all connections, in order.
    rays: Vec<Ray>,
    occluded: Vec<bool>,
}

impl Prefixes {
    /// Prepares for these samples; returns how many suffixes there may be.
    pub(in crate::path) fn start(
        &mut self,
        context: &RenderContext<'_>,
        TileProbes { tile, controls, .. }: &TileProbes,
        samples: &Range<u32>,
    ) -> usize {
        self.tile = *tile;
        self.controls.clone_from(controls);
        self.samples_of_control = (TILE_SIDE * tile.width) as usize * samples.len();
        self.all.clear();
        self.groups.clear();
        if context.reuses_paths() {
            let count = samples.len() as u32;
            self.all.resize(tile.pixel_count() * samples.len(), None);
            let of_sample = |group: PixelGroup, sample| group.map(|pixel| Some(pixel? * count + sample));
            let groups = Groups::of_pass(samples.start / context.settings.pass_samples).of_tile(*tile);
            self.groups.extend(groups.flat_map(|group| (0..count).map(move |i| of_sample(group, i))));
        }
        self.all.len()
    }

    /// The tile of the samples.
    pub(super) fn tile(&self) -> PixelRect {
        self.tile
    }

    /// The samples of one number in the pixels of the square that holds `sample`, which is one of them.
    pub(super) fn samples_of_square(&self, sample: u32) -> impl Iterator<Item = u32> + use<> {
        let count = (self.all.len() / self.tile.pixel_count()) as u32;
        samples_of_square(self.tile, count, sample)
    }

    /// The prefix of a sample, if it has ended.
    pub(super) fn of(&self, sample: u32) -> Option<&Prefix> {
        self.all[sample as usize].as_ref()
    }

    /// The throughput of the prefix before what is added to `target`.
    pub(in crate::path) fn throughput_before(&self, target: Target) -> Rgb {
        match target {
            Target::Sample(_) => Rgb::WHITE,
            Target::Suffix(sample) => self.throughput(sample as usize),
        }
    }

    fn throughput(&self, sample: usize) -> Rgb {
        let prefix = self.all.get(sample).copied().flatten();
        prefix.map_or(Rgb::WHITE, |prefix| prefix.throughput / prefix.guide_ratio)
    }

    /// Ends the prefix of a path at the vertex that scattered it.
    #[inline(always)]
    pub(in crate::path) fn end(&mut self, path: &Path, vertex: &ShadingPoint<'_>) {
        let (end, bounce, throughput) =
            (ReuseVertex::at(vertex), vertex.bounce, path.throughput * path.guide_ratio);
        self.all[path.target.sample() as usize] = Some(Prefix {
            end,
            bounce,
            throughput,
            guide_ratio: path.guide_ratio,
            largest_throughput: throughput,
            mirror: None,
            start: None,
        });
        self.have_ended = true;
    }

    /// Finds the largest throughput of the prefixes that ended at `bounce` and share suffixes: those of each group, or of each
    /// square if it shares what suffixes find of caustics.
    pub(in crate::path) fn update_largest_throughputs(&mut self, context: &RenderContext<'_>, bounce: u32) {
        if !std::mem::take(&mut self.have_ended) {
            return;
        }
        if !context.shares_caustics {
            for group in &self.groups {
                update_largest_throughput(&mut self.all, group.iter().flatten().copied(), bounce);
            }
            return;
        }
        let count = (self.all.len() / self.tile.pixel_count()) as u32;
        for square in PixelRect::grid([self.tile.width, self.tile.height], [TILE_SIDE; 2]) {
            let first = (square.y * self.tile.width + square.x) * count;
            for sample in first..first + count {
                let of_square = samples_of_square(self.tile, count, sample);
                update_largest_throughput(&mut self.all, of_square, bounce);
            }
        }
    }

    /// Notes the mirror that a path meets after its prefix. What the path finds from here on is added to the sum of its
    /// suffix, but no other prefix has a part in it unless the suffix begins at the next vertex.
    #[inline(always)]
    pub(in crate::path) fn meet_mirror(&mut self, path: &mut Path, vertex: &ShadingPoint<'_>) {
        let Some(prefix) = &mut self.all[path.target.sample() as usize] else { return };
        prefix.mirror = Some(ReuseVertex::at(vertex));
        path.prefix_throughput = prefix.throughput;
        path.leave_prefix();
    }

    /// Begins the suffix of a path at this diffuse vertex, the next one after its prefix or after the mirror there. The
    /// throughput of the suffix includes that of the mirror.
    #[inline(always)]
    pub(in crate::path) fn begin_suffix(&mut self, path: &mut Path, vertex: &ShadingPoint<'_>) {
        let Some(prefix) = &mut self.all[path.target.sample() as usize] else { return };
        prefix.start = Some(SuffixStart::Surface(ReuseVertex::at(vertex)));
        path.prefix_throughput = prefix.largest_throughput;
        if prefix.mirror.is_none() {
            path.leave_prefix();
        }
    }

    /// Makes the environment the suffix of a path that leaves the scene right after its prefix, in `direction`.
    #[inline(always)]
    pub(in crate::path) fn leave_scene(&mut self, path: &mut Path, direction: DVec3) {
        let Some(prefix) = &mut self.all[path.target.sample() as usize] else { return };
        prefix.start = Some(SuffixStart::Environment(direction.normalize()));
        path.leave_prefix();
    }

    /// Adds the radiance of all suffixes to that of the samples of a tile whose prefixes can be continued by them.
    pub(in crate::path) fn share_suffixes(
        &mut self,
        context: &RenderContext<'_>,
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
            || self.connect_groups(context, &radiance.suffixes),
        );
        self.connect_squares(context, &radiance.suffix_caustics);
        context.scene.accel().occluded_batch(&self.rays, &mut self.occluded);
        counters.shadow_rays += self.rays.len() as u64;
        self.combine(&mut radiance.samples);
    }

    /// Connects each suffix to the prefixes of its group, which share what it differs from the control variate.
    #[inline(always)]
    fn connect_groups(&mut self, context: &RenderContext<'_>, suffixes: &[Rgb]) {
        for group in 0..self.groups.len() {
            let group = self.groups[group];
            for sample in group.into_iter().flatten() {
                let control = self.controls[sample as usize / self.samples_of_control];
                let difference = suffixes[sample as usize] - control;
                if !difference.is_black() {
                    self.connect(context, (sample, difference), group.into_iter().flatten());
                }
            }
        }
    }

    /// Connects the suffixes of these caustics, each the sample and its radiance, to the prefixes of their squares.
    fn connect_squares(&mut self, context: &RenderContext<'_>, caustics: &[(u32, Rgb)]) {
        for &(sample, radiance) in caustics {
            self.connect(context, (sample, radiance), self.samples_of_square(sample));
        }
    }

    /// Connects the suffix of a sample to its own prefix and to those of `samples`, which share this radiance.
    #[inline(always)]
    fn connect(
        &mut self,
        context: &RenderContext<'_>,
        (sample, radiance): (u32, Rgb),
        samples: impl Iterator<Item = u32>,
    ) {
        let Self { all, shared, connections, rays, .. } = self;
        let Some(own) = &all[sample as usize] else { return };
        let before = connections.len();
        // A radiance that is not finite stays with its own sample, so that an error names that one.
        let suffix = own.suffix().filter(|_| radiance.is_finite());
        let found = suffix.and_then(|suffix| own.end.density_at(&suffix));
        let density = found.map_or(1.0, |(density, _)| density);
        let guided_density = density * own.guide_ratio;
        connections.push(Connection { prefix: sample, density, guided_density, rays: 0 });
        if let Some(suffix) = suffix.filter(|_| found.is_some()) {
            for prefix in samples.filter(|&prefix| prefix != sample) {
                let Some(other) = &all[prefix as usize] else { continue };
                if other.bounce != own.bounce {
                    continue;
                }
                let Some((density, direction)) = other.end.density_at(&suffix) else { continue };
                let added = other.end.push_rays(context.scene.triangles(), &suffix, direction, rays);
                if added > 0 {
                    let guided_density = density * other.end.guide_ratio(context.guide, direction);
                    connections.push(Connection { prefix, density, guided_density, rays: added });
                }
            }
        }
        shared.push(SharedRadiance { radiance, connections: connections.len() - before });
    }

    /// Divides all shared radiance among the prefixes with an unoccluded connection, weighted by the balance heuristic.
    fn combine(&mut self, samples: &mut [Rgb]) {
        let mut occluded = self.occluded.iter();
        for connection in &mut self.connections {
            if occluded.by_ref().take(connection.rays).fold(false, |any, &is_occluded| any | is_occluded) {
                (connection.density, connection.guided_density) = (0.0, 0.0);
            }
        }
        let mut rest = &*self.connections;
        for &SharedRadiance { radiance, connections } in &self.shared {
            let (connections, others) = rest.split_at(connections);
            rest = others;
            let sum: f64 = connections.iter().map(|connection| connection.guided_density).sum();
            for connection in connections {
                let prefix = connection.prefix as usize;
                let throughput = self.all[prefix].map_or(Rgb::WHITE, |prefix| prefix.throughput);
                samples[prefix] += throughput * radiance * (connection.density / sum);
            }
        }
        self.add_controls(samples);
    }

    /// Adds what is taken to arrive at the ends of prefixes from all directions.
    fn add_controls(&self, samples: &mut [Rgb]) {
        let squares =
            samples.chunks_mut(self.samples_of_control).zip(self.all.chunks(self.samples_of_control));
        for (&control, (samples, prefixes)) in self.controls.iter().zip(squares) {
            if control.is_black() {
                continue;
            }
            for (sample, prefix) in samples.iter_mut().zip(prefixes) {
                *sample += prefix.map_or(Rgb::BLACK, |prefix| prefix.throughput * control);
            }
        }
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

impl Prefix {
    /// The suffix, if it has begun.
    #[inline(always)]
    fn suffix(&self) -> Option<Suffix<'_>> {
        Some(match self.start.as_ref()? {
            SuffixStart::Surface(start) => Suffix::Surface { start, mirror: self.mirror.as_ref() },
            &SuffixStart::Environment(direction) => Suffix::Environment(direction),
        })
    }
}
