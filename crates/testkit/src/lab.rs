//! Measuring an accelerator: what it costs, and that it answers like the others.

use crate::accelerators::{Built, Measurable};
use crate::hash::Fnv;
use crate::meshes::Subject;
use crate::rays::Rays;
use globillum_geom::{Accel, Counts, GeomError, Hit, Ray, Triangles};
use std::time::Instant;

/// What rays are asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Query {
    /// The closest hit of camera rays: coherent.
    ClosestCamera,
    /// The closest hit of bounce rays: incoherent.
    ClosestBounce,
    /// Any hit of shadow rays: coherent.
    AnyShadow,
    /// Any hit of bounce rays: incoherent.
    AnyBounce,
}

impl Query {
    /// Every query.
    pub const ALL: [Self; 4] = [Self::ClosestCamera, Self::ClosestBounce, Self::AnyShadow, Self::AnyBounce];

    /// In two words: what is asked, for which rays.
    pub const fn name(self) -> &'static str {
        match self {
            Self::ClosestCamera => "closest camera",
            Self::ClosestBounce => "closest bounce",
            Self::AnyShadow => "any shadow",
            Self::AnyBounce => "any bounce",
        }
    }

    /// The rays that it is asked for.
    pub fn rays(self, rays: &Rays) -> &[Ray] {
        match self {
            Self::ClosestCamera => &rays.camera,
            Self::ClosestBounce | Self::AnyBounce => &rays.bounce,
            Self::AnyShadow => &rays.shadow,
        }
    }

    fn asks_for_any(self) -> bool {
        matches!(self, Self::AnyShadow | Self::AnyBounce)
    }

    /// What it takes, in all.
    pub fn count(self, accel: &dyn Measurable, rays: &Rays) -> Counts {
        let mut counts = Counts::default();
        for ray in self.rays(rays) {
            counts += if self.asks_for_any() { accel.count_any(ray).1 } else { accel.count_closest(ray).1 };
        }
        counts
    }

    /// Answers it once for all rays, and returns a hash of the answers.
    pub fn answer(self, accel: &dyn Accel, rays: &Rays, buffers: &mut Buffers) -> u64 {
        let mut hash = Fnv::default();
        self.run(accel, rays, buffers);
        if self.asks_for_any() {
            buffers.occluded.iter().for_each(|&occluded| hash.add(u64::from(occluded)));
        } else {
            buffers.hits.iter().for_each(|hit| hash.add_hit(hit));
        }
        hash.0
    }

    /// Answers it once for all rays.
    pub fn run(self, accel: &dyn Accel, rays: &Rays, buffers: &mut Buffers) {
        if self.asks_for_any() {
            accel.occluded_batch(self.rays(rays), &mut buffers.occluded);
        } else {
            accel.intersect_batch(self.rays(rays), &mut buffers.hits);
        }
    }

    /// Seconds that [`Query::run`] takes.
    fn time(self, accel: &dyn Accel, rays: &Rays, buffers: &mut Buffers) -> f64 {
        let start = Instant::now();
        self.run(accel, rays, buffers);
        start.elapsed().as_secs_f64()
    }
}

/// Where answers go.
#[derive(Clone, Debug, Default)]
pub struct Buffers {
    hits: Vec<Option<Hit>>,
    occluded: Vec<bool>,
}

/// An accelerator on a mesh, measured.
#[derive(Clone, Debug)]
pub struct Measurement {
    /// The accelerator's name.
    pub accelerator: String,
    /// Median seconds of building it.
    pub build_seconds: f64,
    /// Bytes it holds, the triangles included.
    pub bytes: usize,
    /// Median nanoseconds a ray, for each of [`Query::ALL`].
    pub nanoseconds: [f64; 4],
    /// What is done, for each of [`Query::ALL`].
    pub counts: [Counts; 4],
    /// Of all answers to all queries.
    pub hash: u64,
}

/// An accelerator by name, and how it is built.
pub type Contender = (String, Box<dyn Fn(&Triangles) -> Built>);

/// Builds and asks every accelerator `repeats` times, in turn, so that a disturbance meets all
/// alike; `done` is called after each turn of each.
///
/// # Errors
/// What building one says.
pub fn measure(
    contenders: &[Contender],
    subject: &Subject,
    rays: &Rays,
    repeats: usize,
    mut done: impl FnMut(),
) -> Result<Vec<Measurement>, GeomError> {
    let runs: Result<Vec<Run<'_>>, GeomError> =
        contenders.iter().map(|contender| Run::new(contender, subject)).collect();
    let mut runs = runs?;
    for _ in 0..repeats {
        for run in &mut runs {
            run.turn(subject, rays)?;
            done();
        }
    }
    Ok(runs.into_iter().map(|run| run.finish(rays)).collect())
}

/// What has been measured of one accelerator.
struct Run<'a> {
    contender: &'a Contender,
    accel: Box<dyn Measurable>,
    builds: Vec<f64>,
    queries: [Vec<f64>; 4],
    buffers: Buffers,
}

impl<'a> Run<'a> {
    fn new(contender: &'a Contender, subject: &Subject) -> Result<Self, GeomError> {
        let accel = contender.1(&subject.triangles)?;
        Ok(Self {
            contender,
            accel,
            builds: Vec::new(),
            queries: Default::default(),
            buffers: Buffers::default(),
        })
    }

    fn turn(&mut self, subject: &Subject, rays: &Rays) -> Result<(), GeomError> {
        let start = Instant::now();
        let built = self.contender.1(&subject.triangles)?;
        self.builds.push(start.elapsed().as_secs_f64());
        // The one before is freed outside the time that is taken.
        self.accel = built;
        for query in Query::ALL {
            self.queries[query as usize].push(query.time(&self.accel, rays, &mut self.buffers));
        }
        Ok(())
    }

    fn finish(mut self, rays: &Rays) -> Measurement {
        let mut hash = Fnv::default();
        Query::ALL.iter().for_each(|query| hash.add(query.answer(&self.accel, rays, &mut self.buffers)));
        let nanoseconds = |query: Query| {
            let count = query.rays(rays).len().max(1) as f64;
            median(self.queries[query as usize].clone()) * 1e9 / count
        };
        Measurement {
            accelerator: self.contender.0.clone(),
            bytes: self.accel.bytes(),
            nanoseconds: Query::ALL.map(nanoseconds),
            counts: Query::ALL.map(|query| query.count(&*self.accel, rays)),
            hash: hash.0,
            build_seconds: median(self.builds),
        }
    }
}

/// The middle one of some numbers; NaN if there are none.
pub fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers.get(numbers.len() / 2).copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accelerators::{self, Builder};
    use crate::shapes::statue;

    #[test]
    fn all_accelerators_have_one_hash_and_a_wrong_one_another() {
        let subject = Subject::new("statue", statue(500).triangles()).unwrap();
        let rays = Rays::new(&subject, &*accelerators::ACCELERATORS[0].1(&subject.triangles).unwrap(), 16);
        assert!(rays.bounce.len() > 20 && rays.shadow.len() == rays.bounce.len());
        let nothing: Builder = |_| accelerators::ACCELERATORS[0].1(&Triangles::new(Vec::new())?);
        let contenders = accelerators::all().chain([("nothing", nothing)]);
        let contenders: Vec<Contender> =
            contenders.map(|(name, build)| (name.to_owned(), Box::new(build) as Box<_>)).collect();
        let measured = measure(&contenders, &subject, &rays, 1, || ()).unwrap();
        let [alike @ .., nothing] = &measured[..] else { panic!("there is nothing") };
        for measurement in alike {
            assert_eq!(measurement.hash, alike[0].hash, "{}", measurement.accelerator);
        }
        assert_ne!(nothing.hash, alike[0].hash);
    }
}
