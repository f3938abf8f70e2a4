use glam::{DVec3, Vec3};

/// The fraction of the area by which a corner may turn the wrong way, since coordinates are rounded.
const TOLERANCE: f64 = 1e-6;

/// Whether a polygon of `count` corners is convex, so that its fan around the first corner covers it. A
/// polygon that is not planar is convex if its projection onto its mean plane is. A polygon without area is
/// convex.
pub(super) fn is_convex(count: usize, corner: impl Fn(usize) -> Vec3) -> bool {
    if count < 4 {
        return true;
    }
    let side = |from: usize, to: usize| corner(to % count).as_dvec3() - corner(from % count).as_dvec3();
    let areas = (1..count - 1).map(|i| side(0, i).cross(side(0, i + 1)));
    let whole: DVec3 = areas.clone().sum();
    let covered: f64 = areas.clone().map(DVec3::length).sum();
    // In a polygon that crosses itself, areas of opposite orientation may cancel.
    if whole.length() <= TOLERANCE * covered {
        return covered == 0.0;
    }
    let turns_back = |area: DVec3| area.dot(whole) < -TOLERANCE * whole.length_squared();
    // The fan of a star folds over although all corners turn the same way. The corners of a dart do not all
    // turn the same way although its fan may not fold over.
    let turns = (0..count).map(|i| side(i, i + 1).cross(side(i + 1, i + 2)));
    !areas.chain(turns).any(turns_back)
}
