//! This library's structures.

use crate::measure::timed;
use crate::peer::{Answer, Build, Entry, Family, Peer, Trial, one_by_one};
use crate::rays::RaySet;
use anyhow::Result;
use globillum::geom::{Accel, GeomError, Hit, KdTree, Ray, SimdLevel, Triangles, UniformGrid, WideBvh};
use rayon::ThreadPoolBuilder;
use std::sync::Arc;

/// Two entries for each structure: queried ray by ray, and in batches. All other entries are compared with the
/// first. The wide BVH uses the instructions of `level` at most.
pub(crate) fn build(triangles: &Triangles, level: SimdLevel) -> Result<Vec<Entry>> {
    let structures = [
        both("k-d tree", || KdTree::build(triangles))?,
        both("wide BVH", || Ok(WideBvh::build(triangles)?.with_level(level)))?,
        both("wide BVH, built quickly", || Ok(WideBvh::build_quickly(triangles)?.with_level(level)))?,
        both("uniform grid", || UniformGrid::build(triangles))?,
    ];
    Ok(structures.into_iter().flatten().collect())
}

fn both<A: Accel + 'static>(
    structure: &'static str,
    build: impl FnOnce() -> Result<A, GeomError> + Send,
) -> Result<[Entry; 2]> {
    let one_thread = ThreadPoolBuilder::new().num_threads(1).build()?;
    let (accel, seconds) = one_thread.install(|| timed(build));
    let accel = Arc::new(accel?);
    let build = Build { seconds, bytes: Some(accel.bytes()) };
    let entry = |family, mode: &str, peer| Entry { family, structure, mode: mode.to_owned(), build, peer };
    Ok([
        entry(Family::OursSingle, "single", Box::new(Single(accel.clone()))),
        entry(Family::OursBatch, "batch", Box::new(Batch(accel))),
    ])
}

struct Single<A>(Arc<A>);

impl<A: Accel> Peer for Single<A> {
    fn closest<'a>(&'a self, rays: &RaySet) -> Box<dyn Trial + 'a> {
        one_by_one(rays, Ray::clone, |ray| self.0.intersect(ray))
    }

    fn any<'a>(&'a self, rays: &RaySet) -> Box<dyn Trial + 'a> {
        one_by_one(rays, Ray::clone, |ray| self.0.occluded(ray))
    }
}

struct Batch<A>(Arc<A>);

impl<A: Accel> Peer for Batch<A> {
    fn closest<'a>(&'a self, rays: &RaySet) -> Box<dyn Trial + 'a> {
        let query = |rays: &[Ray], hits: &mut Vec<Option<Hit>>| self.0.intersect_batch(rays, hits);
        Box::new(BatchTrial::new(rays, query))
    }

    fn any<'a>(&'a self, rays: &RaySet) -> Box<dyn Trial + 'a> {
        let query = |rays: &[Ray], occluded: &mut Vec<bool>| self.0.occluded_batch(rays, occluded);
        Box::new(BatchTrial::new(rays, query))
    }
}

struct BatchTrial<A, F> {
    rays: Vec<Ray>,
    /// The lengths of the batches.
    batches: Vec<usize>,
    answers: Vec<Vec<A>>,
    query: F,
}

impl<A, F: Fn(&[Ray], &mut Vec<A>)> BatchTrial<A, F> {
    fn new(rays: &RaySet, query: F) -> Self {
        let batches = rays.batches();
        let answers = batches.iter().map(|&count| Vec::with_capacity(count)).collect();
        Self { rays: rays.to_vec(), batches, answers, query }
    }
}

impl<A: Copy + Into<Answer>, F: Fn(&[Ray], &mut Vec<A>)> Trial for BatchTrial<A, F> {
    fn trace(&mut self) {
        let mut rays = &*self.rays;
        for (&count, answers) in self.batches.iter().zip(&mut self.answers) {
            let (batch, rest) = rays.split_at(count);
            (self.query)(batch, answers);
            rays = rest;
        }
    }

    fn answers(&self) -> Vec<Answer> {
        self.answers.iter().flatten().map(|&answer| answer.into()).collect()
    }
}
