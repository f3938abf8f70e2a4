//! Build time of every accelerator and splitting rule: `cargo bench --bench build`.
//!
//! What is timed has been found to answer like the rest.

#[allow(dead_code, reason = "this bench needs only a part")]
mod common;

use criterion::{Criterion, criterion_group, criterion_main};
use globillum_testkit::query::{Buffers, Query};

fn build(criterion: &mut Criterion) {
    for common::Case { subject, rays } in common::cases() {
        let mut group = criterion.benchmark_group(format!("build/{}", subject.name));
        group.sample_size(10);
        let mut expected = None;
        for (name, build) in common::contenders() {
            let build = || build(&subject.triangles).expect("the mesh is good");
            let hash = Query::ClosestBounce.answer(&build(), &rays, &mut Buffers::default());
            assert_eq!(*expected.get_or_insert(hash), hash, "{name} answers differently");
            group.bench_function(name, |b| b.iter_with_large_drop(build));
        }
    }
}

criterion_group!(benches, build);
criterion_main!(benches);
