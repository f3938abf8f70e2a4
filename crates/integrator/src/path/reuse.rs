//! Paths of neighbouring pixels share what they find (Bekaert, Sbert and Halton 2002).
//!
//! Where a path is first scattered, at `x`, its *stem* ends; where it goes on from the next surface,
//! `y`, its *tail* begins. If `y` is diffuse, what the tail brings leaves `y` alike in all directions,
//! so that each stem of a group could have been the one to find it: it is dealt out among them by the
//! balance heuristic, in shares that add up to one.

use super::Counters;
use super::next_event::Shaded;
use super::wave::{Path, View, WaveSamples};
use crate::PathReuse;
use crate::tile::Tile;
use glam::DVec3;
use globillum_geom::{Accel, Ray, SimdLevel, SurfacePoint};
use globillum_material::Rgb;

/// How much of a path has been traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stage {
    /// Part of its stem: mirrors only.
    Stem,
    /// Its stem, and no more.
    Scattered,
    /// More than that.
    Beyond,
}

/// A surface point as a path meets it.
#[derive(Clone, Copy, Debug)]
struct Met {
    point: SurfacePoint,
    /// Unit normal on the path's side.
    normal: DVec3,
}

/// A path as far as it was first scattered.
#[derive(Clone, Copy, Debug)]
struct Stem {
    end: Met,
    /// The bounce at which that was: with a limit on bounces, tails are as long as it leaves them.
    bounce: u32,
    /// The factor on what arrives at the end from where the path goes on.
    throughput: Rgb,
    /// Where its tail begins.
    tail: Option<Met>,
}

/// A tail's light as a stem might have found it.
#[derive(Clone, Copy, Debug)]
struct Offer {
    /// The samples of the stem and of the tail.
    stem: u32,
    tail: u32,
    /// The density, per area at the tail's beginning, with which the stem would have come upon it, times pi.
    density: f64,
}

/// The stems of a wave, and what becomes of their tails.
#[derive(Debug, Default)]
pub(super) struct Stems {
    /// One for each sample; `None` while it has not been scattered.
    all: Vec<Option<Stem>>,
    /// Those of one tail side by side, its own stem's first.
    offers: Vec<Offer>,
    /// For each offer but the first ones: what must be free.
    rays: Vec<Ray>,
    occluded: Vec<bool>,
}

impl<A> View<'_, A> {
    /// Whether there are tails to deal out.
    pub(super) fn reuses_paths(&self) -> bool {
        self.settings.path_reuse_in_effect() == PathReuse::Fours
    }

    /// Whether a path that is first scattered at this bounce ends its stem there. Roulette that could refuse
    /// the stem would have a part in its density.
    pub(super) fn ends_stem(&self, bounce: u32) -> bool {
        self.reuses_paths() && bounce < self.settings.roulette.start
    }
}

impl Stems {
    /// Forgets all, and makes room for so many samples.
    pub(super) fn clear(&mut self, samples: usize) {
        self.all.clear();
        self.all.resize(samples, None);
    }

    /// The factor on what the tail of `sample` brings by its own stem.
    pub(super) fn throughput(&self, sample: usize) -> Rgb {
        self.all[sample].map_or(Rgb::WHITE, |stem| stem.throughput)
    }

    /// The path was scattered here: its stem ends.
    #[inline(always)]
    pub(super) fn end(&mut self, path: &mut Path, shaded: &Shaded<'_>) {
        let (end, bounce, throughput) = (Met::at(shaded), shaded.bounce, path.throughput);
        self.all[path.account as usize] = Some(Stem { end, bounce, throughput, tail: None });
        path.stage = Stage::Scattered;
    }

    /// The path goes on from a diffuse surface: what it brings from now on is its tail's.
    #[inline(always)]
    pub(super) fn begin_tail(&mut self, path: &mut Path, shaded: &Shaded<'_>) {
        let sample = path.account as usize;
        let Some(stem) = &mut self.all[sample] else { return };
        stem.tail = Some(Met::at(shaded));
        (path.before, path.throughput) = (path.throughput, Rgb::WHITE);
        path.account += self.all.len() as u32;
    }

    /// Deals out what the tails of this tile brought: in `radiance` it follows what the samples have of
    /// their own, which is then all.
    pub(super) fn deal<A: Accel>(
        &mut self,
        view: &View<'_, A>,
        level: SimdLevel,
        tile: Tile,
        samples: WaveSamples,
        radiance: &mut Vec<Rgb>,
        counters: &mut Counters,
    ) {
        if !view.reuses_paths() {
            return;
        }
        let (own, tails) = radiance.split_at_mut(self.all.len());
        let pass = samples.first / view.settings.pass_samples;
        self.offers.clear();
        self.rays.clear();
        level.run(
            #[inline(always)]
            || {
                for group in tile.groups(pass) {
                    for sample in 0..samples.count {
                        let members = group.map(|pixel| pixel.map(|pixel| pixel * samples.count + sample));
                        self.offer(members, tails);
                    }
                }
            },
        );
        view.scene.accel().occluded_batch(&self.rays, &mut self.occluded);
        counters.shadow_rays += self.rays.len() as u64;
        self.accept(tails, own);
        radiance.truncate(self.all.len());
    }

    /// Offers the tails of these samples to each of their stems.
    #[inline(always)]
    fn offer(&mut self, members: [Option<u32>; 4], tails: &[Rgb]) {
        let Self { all, offers, rays, .. } = self;
        for tail in members.into_iter().flatten() {
            let light = tails[tail as usize];
            let Some(own) = &all[tail as usize] else { continue };
            let Some(start) = own.tail.as_ref().filter(|_| !light.is_black()) else { continue };
            let density = own.end.density_of(start).filter(|_| light.is_finite());
            offers.push(Offer { stem: tail, tail, density: density.unwrap_or(1.0) });
            if density.is_none() {
                // What is not finite stays with its own sample, so that an error names that one.
                continue;
            }
            for stem in members.into_iter().flatten().filter(|&stem| stem != tail) {
                let Some(other) = &all[stem as usize] else { continue };
                if other.bounce != own.bounce {
                    continue;
                }
                let Some(density) = other.end.density_of(start) else { continue };
                let Some(ray) = other.end.point.segment_to(&start.point) else { continue };
                rays.push(ray);
                offers.push(Offer { stem, tail, density });
            }
        }
    }

    /// Takes each tail to the stems that see its beginning, in shares that add up to one.
    fn accept(&mut self, tails: &[Rgb], radiance: &mut [Rgb]) {
        let others = self.offers.iter_mut().filter(|offer| offer.stem != offer.tail);
        for (offer, _) in others.zip(&self.occluded).filter(|(_, occluded)| **occluded) {
            offer.density = 0.0;
        }
        for offers in self.offers.chunk_by(|a, b| a.tail == b.tail) {
            let sum: f64 = offers.iter().map(|offer| offer.density).sum();
            for offer in offers {
                let (stem, tail) = (offer.stem as usize, offer.tail as usize);
                radiance[stem] += self.throughput(stem) * tails[tail] * (offer.density / sum);
            }
        }
    }
}

impl Met {
    #[inline(always)]
    fn at(shaded: &Shaded<'_>) -> Self {
        let point = shaded.at.point;
        Self { point, normal: point.normal * 1.0_f64.copysign(shaded.wo.z) }
    }

    /// The density per area, times pi, with which a direction by the cosine from here meets `other`; `None`
    /// if one of them lies behind the other.
    #[inline(always)]
    fn density_of(&self, other: &Self) -> Option<f64> {
        let between = other.point.position - self.point.position;
        let [near, far] = [self.normal.dot(between), -other.normal.dot(between)];
        let square = between.length_squared();
        let density = (near / square) * (far / square);
        (near > 0.0 && far > 0.0 && density.is_normal()).then_some(density)
    }
}
