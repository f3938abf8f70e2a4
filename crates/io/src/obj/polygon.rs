use glam::DVec3;
use globillum_geom::Triangle;

/// How far, as a share of the area, a corner may turn the wrong way: coordinates are rounded.
const TOLERANCE: f64 = 1e-6;

/// Whether the polygon that was cut into `fan` is convex. A bent one counts as convex if its
/// shadow on its mean plane is; one without area, since nothing of it is left, too.
pub(super) fn is_convex(fan: &[Triangle]) -> bool {
    if fan.len() < 2 {
        return true;
    }
    let areas = fan.iter().map(|t| {
        let [a, b, c] = t.vertices.map(|v| v.as_dvec3());
        (b - a).cross(c - a)
    });
    let whole: DVec3 = areas.clone().sum();
    let covered: f64 = areas.clone().map(DVec3::length).sum();
    // What crosses itself may have as much area one way round as the other.
    if whole.length() <= TOLERANCE * covered {
        return covered == 0.0;
    }
    let turns_back = |area: DVec3| area.dot(whole) < -TOLERANCE * whole.length_squared();
    // A star turns alike at all corners, but its fan folds over; a dart has it the other way round.
    !areas.chain(turns(fan)).any(turns_back)
}

/// At each corner, the parallelogram of the sides that meet there.
fn turns(fan: &[Triangle]) -> impl Iterator<Item = DVec3> {
    let count = fan.len() + 2;
    let corner = move |i: usize| match i % count {
        0 => fan[0].vertices[0].as_dvec3(),
        1 => fan[0].vertices[1].as_dvec3(),
        i => fan[i - 2].vertices[2].as_dvec3(),
    };
    (0..count).map(move |i| (corner(i + 1) - corner(i)).cross(corner(i + 2) - corner(i + 1)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn fan(corners: &[[f32; 2]]) -> Vec<Triangle> {
        let at = |i: usize| Vec3::new(corners[i][0], 0.0, corners[i][1]);
        (1..corners.len() - 1).map(|i| Triangle::new(at(0), at(i), at(i + 1))).collect()
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
            assert!(!is_convex(&fan(corners)), "{corners:?}");
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
            assert!(is_convex(&fan(corners)), "{corners:?}");
        }
    }
}
