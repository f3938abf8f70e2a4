//! Build time of every accelerator and split rule: `cargo bench --bench build`.
//!
//! All accelerators must give the same answers before they are timed.

#[allow(dead_code, reason = "each bench uses a part of it")]
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
            assert_eq!(*expected.get_or_insert(hash), hash, "{name} gives different answers");
            group.bench_function(name, |b| b.iter_with_large_drop(build));
        }
    }
}

criterion_group!(benches, build);
criterion_main!(benches);
