use super::light_clusters::LightClusters;
use super::mirror_tree::Viewpoint;
use crate::Stream;
use crate::light::alias_table::AliasTable;
use crate::light::receiver::Receiver;
use glam::DVec3;
use globillum_geom::{Triangle, Triangles};

/// How many there are. Four times as many change no variance by more than chance.
const COUNT: u32 = 1024;

/// The seed of their random numbers: `mirror` in ASCII.
const SEED: u64 = 0x6d69_7272_6f72;

/// From where a tree of `mirrors`, given in ascending order, is calibrated: random points of all other triangles, on the
/// side that faces the mirrors, each with a cluster of lights, chosen by power.
///
/// Half of the points are uniform by area, and half by triangle: neither a vast floor nor a fine mesh has all of them.
pub(super) fn viewpoints(triangles: &Triangles, mirrors: &[u32], clusters: &LightClusters) -> Vec<Viewpoint> {
    let is_mirror = |index: &u32| mirrors.binary_search(index).is_ok();
    let others: Vec<_> = triangles.live().iter().copied().filter(|index| !is_mirror(index)).collect();
    let areas: Vec<_> = others.iter().map(|&index| triangles.get(index).area()).collect();
    let (by_area, by_number) = (AliasTable::new(&areas), AliasTable::new(&vec![1.0; others.len()]));
    let corner = |&index: &u32| triangles.get(index).vertices[0].as_dvec3();
    let middle = mirrors.iter().map(corner).sum::<DVec3>() / mirrors.len() as f64;
    let viewpoint = |i: u32| {
        let numbers = Stream::new(SEED, 0, i);
        let table = if i.is_multiple_of(2) { &by_area } else { &by_number };
        let triangle = others[table.sample(numbers.uniform(0))?];
        let (u, v) = Triangle::sample_uniform(numbers.uniform_pair(1));
        let point = triangles.surface_point(triangle, u, v);
        let is_turned = point.normal.dot(middle - point.position) < 0.0;
        let side = if is_turned { -point.normal } else { point.normal };
        let lights = clusters.get(clusters.choose(numbers.uniform(3)).0).bounds;
        Some(Viewpoint { receiver: Receiver { position: point.position, side: side.as_vec3() }, lights })
    };
    (0..COUNT).filter_map(viewpoint).collect()
}
