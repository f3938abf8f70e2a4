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

#[cfg(test)]
mod tests {
    use super::*;

    fn found(corners: &[[f32; 2]]) -> bool {
        is_convex(corners.len(), |i| Vec3::new(corners[i][0], 0.0, corners[i][1]))
    }

    #[test]
    fn darts_bow_ties_and_stars_are_not_convex() {
        let star = [0.0, 144.0, 288.0, 72.0, 216.0_f32].map(|a| a.to_radians().sin_cos().into());
        let odd: [&[[f32; 2]]; 5] = [
            &[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]],
            &[[0.0, 0.0], [2.0, 2.0], [0.0, 1.0], [-2.0, 2.0]],
            &[[2.0, 2.0], [0.0, 1.0], [-2.0, 2.0], [0.0, 0.0]],
            &[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 1.0]],
            &star,
        ];
        for corners in odd {
            assert!(!found(corners), "{corners:?}");
        }
    }

    #[test]
    fn squares_regular_polygons_and_straight_corners_are_convex() {
        let decagon = std::array::from_fn::<_, 10, _>(|i| (36.0 * i as f32).to_radians().sin_cos().into());
        let even: [&[[f32; 2]]; 5] = [
            &[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]],
            &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]],
            &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
            &[[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
            &decagon,
        ];
        for corners in even {
            assert!(found(corners), "{corners:?}");
        }
    }
}
