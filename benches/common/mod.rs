//! The meshes that the benches run on, and the check before anything is timed.

use criterion::{Criterion, Throughput};
use globillum::io::load_obj;
use globillum_testkit::accelerators::{self, Builder};
use globillum_testkit::meshes::{Subject, procedural};
use globillum_testkit::query::{Buffers, Query};
use globillum_testkit::rays::Rays;

/// Camera rays are those of a picture with so many pixels on each side.
const SIDE: u32 = 96;

/// A mesh with its rays, and the hash that all answers to a query must have.
pub(crate) struct Case {
    pub(crate) subject: Subject,
    pub(crate) rays: Rays,
}

/// The procedural meshes, and the one that `GLOBILLUM_MESH` names if there is one.
pub(crate) fn cases() -> Vec<Case> {
    let mut subjects = procedural().expect("the meshes are good");
    if let Ok(path) = std::env::var("GLOBILLUM_MESH") {
        let mesh = load_obj(path.as_ref()).expect("GLOBILLUM_MESH names an OBJ file").model;
        subjects.push(Subject::new(path, mesh.triangles().to_vec()).expect("the mesh is good"));
    }
    let with_rays =
        |subject: Subject| Case { rays: Rays::new(&subject, SIDE).expect("the mesh is good"), subject };
    subjects.into_iter().map(with_rays).collect()
}

/// Every accelerator but brute force, and every splitting rule.
pub(crate) fn contenders() -> impl Iterator<Item = (&'static str, Builder)> {
    accelerators::all().skip(1)
}

/// Times a query on every mesh and accelerator, after each has been found to answer like the rest.
pub(crate) fn bench_queries(criterion: &mut Criterion, queries: [Query; 2]) {
    for Case { subject, rays } in cases() {
        for query in queries {
            let mut expected = None;
            let name = format!("{}/{}", query.name().replace(' ', "/"), subject.name);
            let mut group = criterion.benchmark_group(name);
            group.sample_size(10).throughput(Throughput::Elements(query.rays(&rays).len() as u64));
            for (name, build) in contenders() {
                let accel = build(&subject.triangles).expect("the mesh is good");
                let mut buffers = Buffers::default();
                let hash = query.answer(&accel, &rays, &mut buffers);
                assert_eq!(*expected.get_or_insert(hash), hash, "{name} answers differently");
                group.bench_function(name, |b| b.iter(|| query.run(&accel, &rays, &mut buffers)));
            }
        }
    }
}
