//! The meshes of the benches, and the check of answers before timing.

use criterion::{Criterion, Throughput};
use globillum::io::load_obj;
use globillum_testkit::accelerators::{self, Builder};
use globillum_testkit::meshes::{Subject, procedural};
use globillum_testkit::query::{Buffers, Query};
use globillum_testkit::rays::Rays;

/// Pixels along each side of the picture, with one camera ray each.
const SIDE: u32 = 96;

/// A mesh with its rays.
pub(crate) struct Case {
    pub(crate) subject: Subject,
    pub(crate) rays: Rays,
}

/// The procedural meshes, and the OBJ file in `GLOBILLUM_MESH` if that is set.
pub(crate) fn cases() -> Vec<Case> {
    let mut subjects = procedural().expect("the meshes are good");
    if let Ok(path) = std::env::var("GLOBILLUM_MESH") {
        let mesh = load_obj(&path).expect("GLOBILLUM_MESH names an OBJ file").model;
        subjects.push(Subject::new(path, mesh.triangles().to_vec()).expect("the mesh is good"));
    }
    let with_rays =
        |subject: Subject| Case { rays: Rays::new(&subject, SIDE).expect("the mesh is good"), subject };
    subjects.into_iter().map(with_rays).collect()
}

/// Every accelerator except brute force, and every split rule.
pub(crate) fn contenders() -> impl Iterator<Item = (&'static str, Builder)> {
    accelerators::all().skip(1)
}

/// Times queries on every mesh and accelerator. All accelerators must give the same answers before they are
/// timed.
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
                assert_eq!(*expected.get_or_insert(hash), hash, "{name} gives different answers");
                group.bench_function(name, |b| b.iter(|| query.run(&accel, &rays, &mut buffers)));
            }
        }
    }
}
