//! Accelerators against the oracle, over scenes and rays that the fuzzer's bytes spell.
#![no_main]

use globillum_geom::conformance::check_bytes;
use globillum_geom::{KdOptions, KdTree, UniformGrid, WideBvh};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let kd = check_bytes(bytes, KdTree::build);
    let grid = check_bytes(bytes, UniformGrid::build);
    let wide = check_bytes(bytes, WideBvh::build);
    // By default so few triangles are one cell.
    let mut options = KdOptions::default();
    (options.leaf_size, options.lookahead) = (4, 2);
    let cells = |triangles: &_| Ok(WideBvh::build_with(triangles, &options)?.without_exhaustive_tests());
    let cells = check_bytes(bytes, cells);
    let nodes = check_bytes(bytes, |triangles| Ok(WideBvh::build(triangles)?.without_exhaustive_tests()));
    for result in [kd, grid, wide, cells, nodes] {
        if let Err(violation) = result {
            panic!("{violation}");
        }
    }
});
