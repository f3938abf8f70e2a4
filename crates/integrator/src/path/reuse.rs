//! Path reuse between neighbouring pixels (Bekaert, Sbert and Halton 2002).
//!
//! A path's *prefix* ends at its first diffuse vertex `x`; its *suffix* begins at the next vertex `y`. If `y`
//! is diffuse, the radiance of the suffix leaves `y` equally in all directions, so each prefix of a group
//! of pixels could have found it. It is shared among these prefixes by the balance heuristic.

use super::counters::Counters;
use super::path_state::{Path, RadianceSums, Stage, Target};
use super::pixel_groups::{Groups, PixelGroup};
use super::render_context::RenderContext;
use super::shading_point::ShadingPoint;
use super::tile_bounds::Tile;
use crate::guide::Guide;
use crate::light::Receiver;
use glam::DVec3;
use globillum_geom::{Frame, Ray, SurfacePoint};
use globillum_material::Rgb;
use std::ops::Range;

/// A vertex at which a prefix ends or a suffix begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReuseVertex {
    pub(super) point: SurfacePoint,
    /// Unit normal on the path's side.
    pub(super) normal: DVec3,
    /// The cell of the guide, if there is one.
    guide_cell: Option<u32>,
    is_mirror: bool,
}

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
    pub(super) guided: f64,
    /// The largest throughput of the prefixes of its group that end at this bounce, by component.
    group_throughput: Rgb,
    /// Where its own suffix begins: at a diffuse vertex, or at a mirror where pixels share caustics.
    pub(super) suffix: Option<ReuseVertex>,
}

/// A suffix as the continuation of a prefix, both named by their samples.
#[derive(Clone, Copy, Debug)]
struct Connection {
    prefix: u32,
    suffix: u32,
    /// The density, per area at the beginning of the suffix and times pi, with which the prefix would have
    /// been continued there by its BSDF alone.
    density: f64,
    /// The same by the guide, if there is one.
    guided: f64,
}

/// The prefixes of a wavefront, and the buffers by which their suffixes are shared.
#[derive(Debug, Default)]
pub(super) struct Prefixes {
    /// One for each sample, `None` until it ends.
    all: Vec<Option<Prefix>>,
    /// The samples that share suffixes.
    groups: Vec<PixelGroup>,
    /// Whether prefixes have ended since [`Prefix::group_throughput`] was computed.
    have_ended: bool,
    /// Sorted by suffix; the connection to its own prefix is first.
    connections: Vec<Connection>,
    /// The segment of each connection, without those between a prefix and its own suffix.
    rays: Vec<Ray>,
    occluded: Vec<bool>,
}

impl Prefixes {
    /// Prepares for these samples; returns how many suffixes there may be.
    pub(super) fn start(&mut self, context: &RenderContext<'_>, tile: Tile, samples: &Range<u32>) -> usize {
        self.all.clear();
        self.groups.clear();
        if context.reuses_paths() {
            let count = samples.len() as u32;
            self.all.resize(tile.pixel_count() * samples.len(), None);
            let of_sample = |group: PixelGroup, sample| group.map(|pixel| Some(pixel? * count + sample));
            let groups = Groups::of_pass(samples.start / context.settings.pass_samples).of_tile(tile);
            self.groups.extend(groups.flat_map(|group| (0..count).map(move |i| of_sample(group, i))));
        }
        self.all.len()
    }

    /// The prefix of a sample, if it has ended.
    pub(super) fn of(&self, sample: u32) -> Option<&Prefix> {
        self.all[sample as usize].as_ref()
    }

    /// The throughput of the prefix before what is added to `target`.
    pub(super) fn throughput_before(&self, target: Target) -> Rgb {
        match target {
            Target::Sample(_) => Rgb::WHITE,
            Target::Suffix(sample) => self.throughput(sample as usize),
        }
    }

    fn throughput(&self, sample: usize) -> Rgb {
        self.all[sample].map_or(Rgb::WHITE, |prefix| prefix.throughput / prefix.guided)
    }

    /// Ends the prefix of a path at the vertex that scattered it.
    #[inline(always)]
    pub(super) fn end(&mut self, path: &mut Path, vertex: &ShadingPoint<'_>) {
        let (end, bounce, throughput) =
            (ReuseVertex::at(vertex), vertex.bounce, path.throughput * path.guided);
        self.all[path.target.sample() as usize] = Some(Prefix {
            end,
            bounce,
            throughput,
            guided: path.guided,
            group_throughput: throughput,
            suffix: None,
        });
        path.stage = Stage::PrefixEnded;
        self.have_ended = true;
    }

    /// Finds the largest throughput in each group, of the prefixes that ended at `bounce`.
    pub(super) fn update_group_throughputs(&mut self, bounce: u32) {
        if !std::mem::take(&mut self.have_ended) {
            return;
        }
        for group in &self.groups {
            let members = || group.iter().flatten().map(|&sample| sample as usize);
            let ended = |prefix: &&Prefix| prefix.bounce == bounce;
            let prefixes = members().filter_map(|sample| self.all[sample].as_ref()).filter(ended);
            let largest = prefixes.fold(Rgb::BLACK, |largest, prefix| largest.max(prefix.throughput));
            for sample in members() {
                if let Some(prefix) = self.all[sample].as_mut().filter(|prefix| prefix.bounce == bounce) {
                    prefix.group_throughput = largest;
                }
            }
        }
    }

    /// Begins the suffix of a path at this vertex.
    #[inline(always)]
    pub(super) fn begin_suffix(&mut self, path: &mut Path, vertex: &ShadingPoint<'_>) {
        let sample = path.target.sample();
        let Some(prefix) = &mut self.all[sample as usize] else { return };
        let start = ReuseVertex::at(vertex);
        prefix.suffix = Some(start);
        path.prefix_throughput = if start.is_mirror { prefix.throughput } else { prefix.group_throughput };
        path.throughput = Rgb::WHITE;
        path.guided = 1.0;
        path.target = Target::Suffix(sample);
    }

    /// Adds the radiance of all suffixes to that of the samples whose prefixes can be continued by them.
    pub(super) fn share_suffixes(
        &mut self,
        context: &RenderContext<'_>,
        radiance: &mut RadianceSums,
        counters: &mut Counters,
    ) {
        if !context.reuses_paths() {
            return;
        }
        self.connections.clear();
        self.rays.clear();
        context.simd.run(
            #[inline(always)]
            || self.connect(context.guide, &radiance.suffixes),
        );
        context.scene.accel().occluded_batch(&self.rays, &mut self.occluded);
        counters.shadow_rays += self.rays.len() as u64;
        self.combine(radiance);
    }

    /// Connects each suffix to the prefixes of its group.
    #[inline(always)]
    fn connect(&mut self, guide: Option<&Guide>, suffixes: &[Rgb]) {
        let Self { all, groups, connections, rays, .. } = self;
        for group in groups {
            for suffix in group.iter().copied().flatten() {
                let radiance = suffixes[suffix as usize];
                let Some(own) = &all[suffix as usize] else { continue };
                let Some(start) = own.suffix.as_ref().filter(|_| !radiance.is_black()) else { continue };
                // What leaves a mirror depends on the direction, so it stays with its own sample. So does a radiance that is
                // not finite, so that an error names that one.
                let is_shared = !start.is_mirror && radiance.is_finite();
                let found = own.end.connection_to(start).filter(|_| is_shared);
                let density = found.map_or(1.0, |(density, _)| density);
                connections.push(Connection {
                    prefix: suffix,
                    suffix,
                    density,
                    guided: density * own.guided,
                });
                if found.is_none() {
                    continue;
                }
                for prefix in group.iter().copied().flatten().filter(|&prefix| prefix != suffix) {
                    let Some(other) = &all[prefix as usize] else { continue };
                    if other.bounce != own.bounce {
                        continue;
                    }
                    let Some((density, ray)) = other.end.connection_to(start) else { continue };
                    let guided = density * other.end.guided(guide, ray.direction);
                    rays.push(ray);
                    connections.push(Connection { prefix, suffix, density, guided });
                }
            }
        }
    }

    /// Divides each suffix among the prefixes with an unoccluded connection, weighted by the balance
    /// heuristic.
    fn combine(&mut self, RadianceSums { samples, suffixes }: &mut RadianceSums) {
        let others = self.connections.iter_mut().filter(|connection| connection.prefix != connection.suffix);
        for (connection, _) in others.zip(&self.occluded).filter(|(_, occluded)| **occluded) {
            (connection.density, connection.guided) = (0.0, 0.0);
        }
        for connections in self.connections.chunk_by(|a, b| a.suffix == b.suffix) {
            let sum: f64 = connections.iter().map(|connection| connection.guided).sum();
            for connection in connections {
                let (prefix, suffix) = (connection.prefix as usize, connection.suffix as usize);
                let throughput = self.all[prefix].map_or(Rgb::WHITE, |prefix| prefix.throughput);
                samples[prefix] += throughput * suffixes[suffix] * (connection.density / sum);
            }
        }
    }
}

impl ReuseVertex {
    #[inline(always)]
    fn at(vertex: &ShadingPoint<'_>) -> Self {
        let (point, is_mirror) = (vertex.at.point, vertex.at.material.bsdf.is_delta());
        let guide_cell = vertex.guide_cell.map(|cell| cell.index);
        Self { point, normal: vertex.frame.normal, guide_cell, is_mirror }
    }

    /// What receives light.
    pub(super) fn receiver(&self) -> Receiver {
        Receiver { position: self.point.position, side: self.normal.as_vec3() }
    }

    /// How many times as dense as cosine sampling the guide makes `direction`.
    #[inline(always)]
    pub(super) fn guided(&self, guide: Option<&Guide>, direction: DVec3) -> f64 {
        let Some((guide, cell)) = guide.zip(self.guide_cell) else { return 1.0 };
        guide.cell(cell).directions.ratio(Frame::around(self.normal).to_local(direction))
    }

    /// The density per area, times pi, with which cosine sampling from here hits `other`, and the segment
    /// between them. `None` if one of them is not clearly in front of the other, or if the density is not a
    /// normal number.
    #[inline(always)]
    pub(super) fn connection_to(&self, other: &Self) -> Option<(f64, Ray)> {
        let between = other.point.position - self.point.position;
        let [near, far] = [self.normal.dot(between), -other.normal.dot(between)];
        let square = between.length_squared();
        let density = (near / square) * (far / square);
        if !(near > 0.0 && far > 0.0 && density.is_normal()) {
            return None;
        }
        Some((density, self.point.segment_to(&other.point)?))
    }
}
