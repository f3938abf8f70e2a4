//! Any hit of shadow rays and of bounce rays: `cargo bench --bench any`.

#[allow(dead_code, reason = "each bench uses a part of it")]
mod common;

use criterion::{Criterion, criterion_group, criterion_main};
use globillum_testkit::query::Query;

fn any(criterion: &mut Criterion) {
    common::bench_queries(criterion, [Query::AnyShadow, Query::AnyBounce]);
}

criterion_group!(benches, any);
criterion_main!(benches);
