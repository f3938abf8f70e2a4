//! Measures accelerators: build time, memory, query times, counts, and a hash of all answers.

use crate::timing::{median, timed};
use globillum::geom::{Counts, GeomError, Triangles};
use globillum_testkit::accelerators::{Built, Measurable};
use globillum_testkit::hash::Fnv;
use globillum_testkit::meshes::Subject;
use globillum_testkit::query::{Buffers, Query};
use globillum_testkit::rays::Rays;

/// The measurements of an accelerator on a mesh.
#[derive(Clone, Debug)]
pub(crate) struct Measurement {
    /// The accelerator's name.
    pub(crate) accelerator: String,
    /// Median seconds of building it.
    pub(crate) build_seconds: f64,
    /// Memory in bytes, including the triangles.
    pub(crate) bytes: usize,
    /// Median nanoseconds per ray, for each of [`Query::ALL`].
    pub(crate) nanoseconds: [f64; 4],
    /// Traversal counts, for each of [`Query::ALL`].
    pub(crate) counts: [Counts; 4],
    /// Hash of all answers to all queries.
    pub(crate) hash: u64,
}

/// The name and builder of an accelerator.
pub(crate) type Contender = (String, Box<dyn Fn(&Triangles) -> Built>);

/// Builds and queries every accelerator `repeats` times. The accelerators take turns, so that other load on the
/// machine affects all equally. `done` is called after each turn of each accelerator.
///
/// # Errors
/// Those of the builders.
pub(crate) fn measure(
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

/// The timings of one accelerator so far.
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
        let (built, seconds) = timed(|| self.contender.1(&subject.triangles));
        let built = built?;
        self.builds.push(seconds);
        // Drops the previous accelerator outside the timed section.
        self.accel = built;
        for query in Query::ALL {
            self.queries[query as usize].push(timed(|| query.run(&self.accel, rays, &mut self.buffers)).1);
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

#[cfg(test)]
mod tests {
    use super::*;
    use globillum_testkit::accelerators::{self, Builder};
    use globillum_testkit::shapes::statue;

    #[test]
    fn hashes_agree_for_all_accelerators_and_differ_for_a_wrong_one() {
        let subject = Subject::new("statue", statue(500).triangles()).unwrap();
        let rays = Rays::new(&subject, 16).unwrap();
        assert!(rays.bounce.len() > 20 && rays.shadow.len() == rays.bounce.len());
        let nothing: Builder = |_| accelerators::ACCELERATORS[0].1(&Triangles::new(Vec::new())?);
        let contenders = accelerators::all().chain([("nothing", nothing)]);
        let contenders: Vec<Contender> =
            contenders.map(|(name, build)| (name.to_owned(), Box::new(build) as Box<_>)).collect();
        let measured = measure(&contenders, &subject, &rays, 1, || ()).unwrap();
        let [correct @ .., nothing] = &measured[..] else { panic!("no measurement") };
        for measurement in correct {
            assert_eq!(measurement.hash, correct[0].hash, "{}", measurement.accelerator);
        }
        assert_ne!(nothing.hash, correct[0].hash);
    }
}
