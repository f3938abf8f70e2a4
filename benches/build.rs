//! Build time of the k-d tree and the grid.

#[path = "common/meshes.rs"]
mod meshes;

use criterion::{Criterion, criterion_group, criterion_main};
use globillum::geom::{GridOptions, KdOptions, KdTree, UniformGrid};

fn build(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("build");
    group.sample_size(10);
    for case in meshes::cases() {
        let triangles = &case.triangles;
        group.bench_function(format!("{}/kd", case.name), |b| {
            b.iter(|| KdTree::build(triangles, &KdOptions::default()).expect("the mesh is good"));
        });
        group.bench_function(format!("{}/grid", case.name), |b| {
            b.iter(|| UniformGrid::build(triangles, &GridOptions::default()).expect("the mesh is good"));
        });
    }
}

criterion_group!(benches, build);
criterion_main!(benches);
