//! Paths of neighbouring pixels share what they find (Bekaert, Sbert and Halton 2002).
//!
//! Where a path is first scattered, at `x`, its *stem* ends; where it goes on from the next surface,
//! `y`, its *tail* begins. If `y` is diffuse, what the tail brings leaves `y` alike in all directions,
//! so that each stem of a group could have been the one to find it: it is dealt out among them by the
//! balance heuristic, in shares that add up to one.

use super::counters::Counters;
use super::job::{View, WaveSamples};
use super::reuse_groups::Group;
use super::state::{Path, Stage};
use super::tile::Tile;
use super::vertex::Shaded;
use crate::PathReuse;
use glam::DVec3;
use globillum_geom::{Accel, Ray, SimdLevel, SurfacePoint};
use globillum_material::Rgb;

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
    /// The largest factors of all stems of its group that end at this bounce.
    largest: Rgb,
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
    /// The samples that share their tails.
    groups: Vec<Group>,
    /// Whether stems have ended since [`Stem::largest`] was found.
    fresh: bool,
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
    /// Forgets all, and makes room for these samples; returns how many tails there may be.
    pub(super) fn start<A>(&mut self, view: &View<'_, A>, tile: Tile, samples: WaveSamples) -> usize {
        self.all.clear();
        self.groups.clear();
        if view.reuses_paths() {
            self.all.resize(tile.pixel_count() * samples.count as usize, None);
            let of_sample = |group: Group, sample| group.map(|pixel| Some(pixel? * samples.count + sample));
            let groups = tile.groups(samples.first / view.settings.pass_samples);
            let groups = groups.flat_map(|group| (0..samples.count).map(move |i| of_sample(group, i)));
            self.groups.extend(groups);
        }
        self.all.len()
    }

    /// The sample whose light goes to `account`.
    pub(super) fn sample(&self, account: u32) -> u32 {
        account.checked_sub(self.all.len() as u32).unwrap_or(account)
    }

    /// The factor, by its sample's own stem, on the light that goes to `account`.
    pub(super) fn before(&self, account: u32) -> Rgb {
        let is_tail = self.sample(account) != account;
        if is_tail { self.throughput(self.sample(account) as usize) } else { Rgb::WHITE }
    }

    /// The factor on what a tail brings by the stem of `sample`.
    fn throughput(&self, sample: usize) -> Rgb {
        self.all[sample].map_or(Rgb::WHITE, |stem| stem.throughput)
    }

    /// The path was scattered here: its stem ends.
    #[inline(always)]
    pub(super) fn end(&mut self, path: &mut Path, shaded: &Shaded<'_>) {
        let (end, bounce, throughput) = (Met::at(shaded), shaded.bounce, path.throughput);
        self.all[path.account as usize] =
            Some(Stem { end, bounce, throughput, largest: throughput, tail: None });
        path.stage = Stage::Scattered;
        self.fresh = true;
    }

    /// After all paths have been through `bounce`: what a tail is worth to all who may share it.
    pub(super) fn compare(&mut self, bounce: u32) {
        if !std::mem::take(&mut self.fresh) {
            return;
        }
        for group in &self.groups {
            let members = || group.iter().flatten().map(|&sample| sample as usize);
            let ended = |stem: &&Stem| stem.bounce == bounce;
            let stems = members().filter_map(|sample| self.all[sample].as_ref()).filter(ended);
            let largest = stems.fold(Rgb::BLACK, |largest, stem| largest.max(stem.throughput));
            for sample in members() {
                if let Some(stem) = self.all[sample].as_mut().filter(|stem| stem.bounce == bounce) {
                    stem.largest = largest;
                }
            }
        }
    }

    /// The path goes on from a diffuse surface: what it brings from now on is its tail's.
    #[inline(always)]
    pub(super) fn begin_tail(&mut self, path: &mut Path, shaded: &Shaded<'_>) {
        let sample = path.account as usize;
        let Some(stem) = &mut self.all[sample] else { return };
        stem.tail = Some(Met::at(shaded));
        (path.before, path.throughput) = (stem.largest, Rgb::WHITE);
        path.account += self.all.len() as u32;
    }

    /// Deals out what the tails of this tile brought: in `radiance` it follows what the samples have of
    /// their own, which is then all.
    pub(super) fn deal<A: Accel>(
        &mut self,
        view: &View<'_, A>,
        level: SimdLevel,
        radiance: &mut Vec<Rgb>,
        counters: &mut Counters,
    ) {
        if !view.reuses_paths() {
            return;
        }
        let (own, tails) = radiance.split_at_mut(self.all.len());
        self.offers.clear();
        self.rays.clear();
        level.run(
            #[inline(always)]
            || self.offer(tails),
        );
        view.scene.accel().occluded_batch(&self.rays, &mut self.occluded);
        counters.shadow_rays += self.rays.len() as u64;
        self.accept(tails, own);
        radiance.truncate(self.all.len());
    }

    /// Offers each tail to all stems of its group.
    #[inline(always)]
    fn offer(&mut self, tails: &[Rgb]) {
        let Self { all, groups, offers, rays, .. } = self;
        for group in groups {
            for tail in group.iter().copied().flatten() {
                let light = tails[tail as usize];
                let Some(own) = &all[tail as usize] else { continue };
                let Some(start) = own.tail.as_ref().filter(|_| !light.is_black()) else { continue };
                let seen = own.end.sees(start).filter(|_| light.is_finite());
                offers.push(Offer { stem: tail, tail, density: seen.map_or(1.0, |(density, _)| density) });
                if seen.is_none() {
                    // What is not finite stays with its own sample, so that an error names that one.
                    continue;
                }
                for stem in group.iter().copied().flatten().filter(|&stem| stem != tail) {
                    let Some(other) = &all[stem as usize] else { continue };
                    if other.bounce != own.bounce {
                        continue;
                    }
                    let Some((density, ray)) = other.end.sees(start) else { continue };
                    rays.push(ray);
                    offers.push(Offer { stem, tail, density });
                }
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

    /// The density per area, times pi, with which a direction by the cosine from here meets `other`, and the
    /// segment that must be free. `None` if one of them lies behind the other or can not be told from
    /// that, or if the density is not a normal number.
    #[inline(always)]
    fn sees(&self, other: &Self) -> Option<(f64, Ray)> {
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
