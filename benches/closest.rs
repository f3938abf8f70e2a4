//! The closest hit of camera rays and of bounce rays: `cargo bench --bench closest`.

#[allow(dead_code, reason = "each bench uses a part of it")]
mod common;

use criterion::{Criterion, criterion_group, criterion_main};
use globillum_testkit::query::Query;

fn closest(criterion: &mut Criterion) {
    common::bench_queries(criterion, [Query::ClosestCamera, Query::ClosestBounce]);
}

criterion_group!(benches, closest);
criterion_main!(benches);
