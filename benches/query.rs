//! Query time of the k-d tree and the grid: closest hit and any hit, for camera and bounce rays.
//!
//! Before anything is timed, both are checked to give the same answers.

#[path = "common/meshes.rs"]
mod meshes;
#[path = "common/rays.rs"]
mod rays;

use criterion::{
    BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main, measurement::WallTime,
};
use globillum::geom::{Accel, GridOptions, KdOptions, KdTree, Ray, UniformGrid};
use std::hint::black_box;

fn query(criterion: &mut Criterion) {
    for case in meshes::cases() {
        let kd = KdTree::build(&case.triangles, &KdOptions::default()).expect("the mesh is good");
        let grid = UniformGrid::build(&case.triangles, &GridOptions::default()).expect("the mesh is good");
        let camera = rays::camera_rays(&kd.bounds(), 128);
        let bounce = rays::bounce_rays(&kd, &case.triangles, &camera);
        for (kind, rays) in [("camera", &camera), ("bounce", &bounce)] {
            assert_equal_answers(&kd, &grid, rays);
            let mut group = criterion.benchmark_group(format!("{}/{kind}", case.name));
            group.throughput(Throughput::Elements(rays.len() as u64)).sample_size(20);
            time(&mut group, "kd", &kd, rays);
            time(&mut group, "grid", &grid, rays);
        }
    }
}

fn assert_equal_answers(a: &dyn Accel, b: &dyn Accel, rays: &[Ray]) {
    for ray in rays {
        assert_eq!(a.intersect(ray), b.intersect(ray), "{ray:?}");
        assert_eq!(a.occluded(ray), b.intersect(ray).is_some(), "{ray:?}");
        assert_eq!(b.occluded(ray), b.intersect(ray).is_some(), "{ray:?}");
    }
}

fn time(group: &mut BenchmarkGroup<'_, WallTime>, name: &str, accel: &dyn Accel, rays: &[Ray]) {
    let (mut hits, mut occluded) = (Vec::new(), Vec::new());
    group.bench_function(format!("closest/{name}"), |b| {
        b.iter(|| accel.intersect_batch(black_box(rays), &mut hits));
    });
    group.bench_function(format!("any/{name}"), |b| {
        b.iter(|| accel.occluded_batch(black_box(rays), &mut occluded));
    });
}

criterion_group!(benches, query);
criterion_main!(benches);
