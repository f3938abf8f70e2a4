use glam::DVec3;
use globillum_geom::Aabb;

/// The least size of what a tree is built of, relative to the largest coordinate of the scene there. All coordinates of
/// the scene are then at most `2^40` units, of which single precision can square the square.
const MIN_SIZE: f64 = 1.0 / (1_u64 << 40) as f64;

/// The inverse of a tree's unit of length, a power of two: `size`, the largest coordinate of what the tree is built of, is
/// within `[0.5, 1)` units.
///
/// All coordinates are distances from `origin`. What has next to no size, or none, has a unit that follows from the scene, so
/// that it scales with it too. In an empty scene that is 1.
pub(super) fn units_per_length(size: f64, origin: DVec3, scene: &Aabb) -> f64 {
    let corners = [scene.min, scene.max].map(|corner| (corner.as_dvec3() - origin).abs().max_element());
    let farthest = if scene.is_empty() { 0.0 } else { corners[0].max(corners[1]) };
    let (_, exponent) = libm::frexp(size.max(MIN_SIZE * farthest));
    libm::ldexp(1.0, -exponent)
}
