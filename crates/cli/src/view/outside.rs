use super::axes::Up;
use globillum::geom::Aabb;
use globillum::glam::{BVec3, DMat3, DVec2, DVec3, Vec3Swizzles};
use globillum::integrator::{PinholeCamera, RenderError};

/// Degrees from bottom to top, where nothing else is asked for.
pub(crate) const FIELD_OF_VIEW: f64 = 40.0;

/// The size of the frame that the scene's box fills, as a share of the picture.
const FILLED: f64 = 0.95;

/// A camera outside `bounds` that sees all of them, as large as possible in a picture `aspect` times as wide
/// as high: their corners lie within a frame of 0.95 times the size of the picture and touch two opposite
/// sides of it.
///
/// It looks from the front and somewhat from the right, or the other way round at a box that is three times
/// as deep as wide; and from above, the more so the flatter the box is. The field of view is 40 degrees.
///
/// # Errors
/// [`RenderError::Camera`] if `bounds` have no extent, or one beyond what `f64` can hold.
pub fn of_all(bounds: &Aabb, up: Up, aspect: f64) -> Result<PinholeCamera, RenderError> {
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let size = max - min;
    if !(size.is_finite() && size.max_element() > 0.0) {
        return Err(RenderError::Camera("the scene must have an extent"));
    }
    let view = view_axes(up, size);
    let corner = |i| DVec3::select(BVec3::new(i & 1 == 0, i & 2 == 0, i & 4 == 0), min, max);
    let corners = (0..8).map(|i| view.transpose() * corner(i));
    let fov = FIELD_OF_VIEW.to_radians();
    let edges =
        PinholeCamera::look_at(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, fov)?.ray(1.0, 1.0, aspect).direction;
    let eye = view * eye_that_fits(corners, FILLED * edges.xy());
    PinholeCamera::look_at(eye, eye - size.max_element() * view.z_axis, up.axes().y_axis, fov)
}

/// The unit vectors rightward and upward in the picture and toward the eye, as columns, for a box of `size`.
fn view_axes(up: Up, size: DVec3) -> DMat3 {
    let axes = up.axes();
    let [width, height, depth] = (axes.transpose() * size).abs().to_array();
    let base = width.max(depth);
    let (right, front) = if 3.0 * width < depth { (1.0, 0.5) } else { (0.5, 1.0) };
    let toward = (axes * DVec3::new(right, base / (base + height), front)).normalize();
    let rightward = axes.y_axis.cross(toward).normalize();
    DMat3::from_cols(rightward, toward.cross(rightward), toward)
}

/// The eye nearest to `points` that looks along -z and sees them within the slopes of the picture's edges.
///
/// An eye at `e` sees a point `p` within the right edge if `p.x - e.x <= slope (e.z - p.z)`, and so on: each
/// edge is a linear bound, of which one point attains the extreme.
fn eye_that_fits(points: impl Iterator<Item = DVec3>, slopes: DVec2) -> DVec3 {
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for point in points {
        low = low.min(point.xy() - slopes * point.z);
        high = high.max(point.xy() + slopes * point.z);
    }
    let distance = ((high - low) / (2.0 * slopes)).max_element();
    ((low + high) / 2.0).extend(distance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use globillum::glam::Vec3;

    /// Where the corners of the box are in the picture: from -1 to 1 rightward and upward.
    fn corners(bounds: &Aabb, camera: &PinholeCamera, aspect: f64) -> Vec<DVec2> {
        let origin = camera.ray(0.0, 0.0, aspect);
        let rightward = camera.ray(1.0, 0.0, aspect).direction - origin.direction;
        let upward = camera.ray(0.0, 1.0, aspect).direction - origin.direction;
        let film = DMat3::from_cols(rightward, upward, origin.direction).inverse();
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let all = (0..8).map(|i| DVec3::select(BVec3::new(i & 1 == 0, i & 2 == 0, i & 4 == 0), min, max));
        let seen = all.map(|corner| film * (corner - origin.origin));
        seen.inspect(|p| assert!(p.z > 0.0, "behind the camera: {p}")).map(|p| p.xy() / p.z).collect()
    }

    #[test]
    fn the_box_fills_the_frame_in_one_dimension_and_stays_within_it_in_the_other() {
        let sizes = [[1.0, 1.0, 1.0], [8.0, 0.1, 5.0], [0.5, 2.0, 0.5], [1.0, 1.0, 0.0], [0.0, 3.0, 4.0]];
        let places = [(Vec3::ZERO, 1.0), (Vec3::new(7.0, -2.0, 30.0), 1e-3), (Vec3::ZERO, 1e15)];
        for ((size, (place, scale)), aspect, up) in sizes
            .into_iter()
            .flat_map(|size| places.map(|place| (size, place)))
            .flat_map(|case| [0.2, 0.75, 1.0, 16.0 / 9.0, 7.0].map(|aspect| (case, aspect)))
            .flat_map(|(case, aspect)| [Up::Y, Up::Z].map(|up| (case, aspect, up)))
        {
            let min = place * scale;
            let bounds = Aabb { min, max: min + Vec3::from_array(size) * scale };
            let camera = of_all(&bounds, up, aspect).expect("it has an extent");
            let seen = corners(&bounds, &camera, aspect);
            let low = seen.iter().copied().reduce(DVec2::min).expect("eight corners");
            let high = seen.iter().copied().reduce(DVec2::max).expect("eight corners");
            let context = format!("{size:?} at {min} with {up:?}, {aspect}: {low} to {high}");
            assert!(low.min(-high).min_element() > -FILLED - 1e-6, "within the frame: {context}");
            let touches = (low + FILLED).abs().max((high - FILLED).abs());
            assert!(touches.min_element() < 1e-6, "touches two sides: {context}");
        }
    }

    #[test]
    fn flat_things_are_seen_from_above_and_upright_ones_from_the_front() {
        let toward = |size: Vec3, up| {
            let camera = of_all(&Aabb { min: Vec3::ZERO, max: size }, up, 1.0).expect("it has an extent");
            -camera.ray(0.0, 0.0, 1.0).direction
        };
        let flat = toward(Vec3::new(8.0, 0.3, 5.0), Up::Y);
        assert!(flat.y > 0.6 && flat.z > flat.x, "{flat}");
        let flat = toward(Vec3::new(8.0, 5.0, 0.3), Up::Z);
        assert!(flat.z > 0.6 && -flat.y > flat.x, "{flat}");
        let bust = toward(Vec3::new(1.0, 0.6, 2.0), Up::Z);
        assert!(bust.z < 0.3 && bust.y < -0.8, "{bust}");
        let aside = toward(Vec3::new(0.1, 2.0, 3.0), Up::Y);
        assert!(aside.x > 0.7, "{aside}");
    }

    #[test]
    fn boxes_without_an_extent_are_refused() {
        let point = Aabb { min: Vec3::ONE, max: Vec3::ONE };
        for bounds in [point, Aabb::EMPTY, Aabb { min: Vec3::ZERO, max: Vec3::INFINITY }] {
            assert!(of_all(&bounds, Up::Y, 1.0).is_err(), "{bounds:?}");
        }
    }
}
