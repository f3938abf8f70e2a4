use super::*;
use crate::Stream;
use globillum_geom::Triangle;

/// Whether a ray meets the box around `center`.
fn hits_box(origin: DVec3, direction: DVec3, center: DVec3, half_extents: DVec3) -> bool {
    let (a, b) = ((center - half_extents - origin) / direction, (center + half_extents - origin) / direction);
    a.min(b).max_element().max(0.0) <= a.max(b).min_element()
}

/// What a receiver at `from` asks of lights in this box, given by its center and half extents.
fn query(from: DVec3, receiver_normal: DVec3, (center, half_extents): (DVec3, DVec3), around: u32) -> Query {
    Query {
        from: from.as_vec3(),
        normal: receiver_normal.as_vec3(),
        lights: center.as_vec3(),
        lights_half_extents: half_extents.as_vec3(),
        lights_radius: half_extents.length() as f32,
        around,
    }
}

/// A mirror of which a point reflects a ray to the lights has an importance. The mean share in it is 4.6 times that of
/// points that do, since boxes and intervals cover more than the lights' projection; it would be 6.2 times if any mirror
/// with an importance counted as a whole.
#[test]
fn importance_follows_the_share_that_shows_lights() {
    let (mut shares, mut shown, mut mirrors_shown) = (0.0, 0.0, 0);
    for i in 0..2000 {
        let numbers = Stream::new(22, 0, i);
        let vector = |k: u32| DVec3::from_array([0, 1, 2].map(|axis| 2.0 * numbers.uniform(k + axis) - 1.0));
        let (from, lights, half_extents) = (3.0 * vector(0), 3.0 * vector(3), 0.4 * vector(6).abs());
        let size = 10.0_f64.powf(-2.0 * numbers.uniform(9));
        let mirror = |k: u32| {
            let center = 0.5 * vector(12 * k);
            let vertices = [3, 6, 9].map(|j| center + size * vector(12 * k + j));
            TriangleMirror { vertices, body: 1 }
        };
        let mirrors: Vec<_> = (1..=WIDTH as u32).map(mirror).collect();
        let receiver_normal = -from.normalize();
        let query = query(from, receiver_normal, (lights, half_extents), u32::MAX);
        let importance = TriangleLeaf::new(&mirrors).importance(&query);
        for (lane, importance) in importance.into_iter().enumerate() {
            let [a, b, c] = mirrors[child_of(lane)].vertices;
            let normal = (b - a).cross(c - a);
            let shows = |k: u32| {
                let (u, v) = Triangle::sample_uniform(Stream::new(23, i.into(), k).uniform_pair(0));
                let point = a + u * (b - a) + v * (c - a);
                let (wi, n) = (point - from, normal.normalize());
                hits_box(point, wi - 2.0 * wi.dot(n) * n, lights, half_extents)
            };
            let share = f64::from((0..256).map(|k| u32::from(shows(k))).sum::<u32>()) / 256.0;
            let to_center = (a + b + c) / 3.0 - from;
            let highest = [a, b, c].map(|v| (v - from).dot(receiver_normal)).into_iter().fold(0.0, f64::max);
            let whole = 0.5 * normal.dot(to_center).abs() * highest / to_center.length_squared().powi(2);
            let is_near = to_center.length_squared() < mirrors[child_of(lane)].near_sq();
            assert!(share == 0.0 || importance > 0.0 || highest == 0.0, "{i}, {lane}: {share}");
            if highest > 0.0 && !is_near {
                (shares, shown) = (shares + (importance / whole).powi(2), shown + share);
                mirrors_shown += i32::from(share > 0.0);
            }
        }
    }
    assert!(
        mirrors_shown > 300 && shares > shown && shares < 5.0 * shown,
        "{mirrors_shown}, {shares}, {shown}"
    );
}

/// What a test asks of one mirror.
#[derive(Clone, Copy, Debug)]
struct Shown {
    vertices: [DVec3; 3],
    from: DVec3,
    receiver_normal: DVec3,
    lights: DVec3,
    half_extents: DVec3,
    body: u32,
}

impl Shown {
    fn importance(&self) -> f64 {
        let Self { vertices, from, receiver_normal, lights, half_extents, body } = *self;
        let query = query(from, receiver_normal, (lights, half_extents), 1);
        TriangleLeaf::new(&[TriangleMirror { vertices, body }]).importance(&query)[0]
    }

    /// With a box that has a point of the ray from `from` at the point `at` of the mirror well inside, this far from there.
    fn by_way_of(self, at: DVec3, distance: f64, half_extents: DVec3, place: DVec3) -> Self {
        let [a, b, c] = self.vertices;
        let (normal, wi) = ((b - a).cross(c - a).normalize(), at - self.from);
        let reflected = (wi - 2.0 * wi.dot(normal) * normal).normalize();
        let lights = at + distance * reflected + 0.5 * half_extents * place;
        Self { lights, half_extents, ..self }
    }
}

/// Mirrors down to 1e-4 of the tree, needles of up to 1e4 times their width, receivers near and far and at angles down to a
/// milliradian, and boxes that are flat, large, small, or cross the mirror's plane.
#[test]
fn every_mirror_that_shows_lights_has_an_importance() {
    for i in 0..400_000 {
        let numbers = Stream::new(24, 0, i);
        let vector = |k: u32| DVec3::from_array([0, 1, 2].map(|axis| 2.0 * numbers.uniform(k + axis) - 1.0));
        let power = |k: u32, from: f64, to: f64| 10.0_f64.powf(from + (to - from) * numbers.uniform(k));
        let size = power(0, -4.0, 0.0);
        let width = (size / power(1, 0.0, 4.0)).max(2e-5);
        let x = vector(2).normalize();
        let y = x.cross(vector(5)).normalize();
        let corner = |k: u32| {
            let [u, v] = numbers.uniform_pair(k).map(|u| 2.0 * u - 1.0);
            vector(8) + size * u * x + width * v * y
        };
        let vertices = [11, 13, 15].map(corner);
        let normal = (vertices[1] - vertices[0]).cross(vertices[2] - vertices[0]);
        // Not a needle of a needle.
        if normal.length() < 0.1 * size * width {
            continue;
        }
        let normal = normal.normalize();
        let (u, v) = Triangle::sample_uniform(numbers.uniform_pair(17));
        let inside = |u: f64| 0.1 + 0.7 * u;
        let (u, v) = (inside(u), inside(v));
        let at = (1.0 - u - v) * vertices[0] + u * vertices[1] + v * vertices[2];
        let distance = power(20, -3.0, 4.0);
        let sin = power(21, -3.0, 0.0).max(1e-4 / distance).min(1.0);
        let along = vector(22).reject_from_normalized(normal).normalize();
        let (is_closed, is_crossed) = (i % 2 == 0, i % 4 == 1);
        let front = if is_closed || i % 3 == 0 { 1.0 } else { -1.0 };
        let from = at + distance * (front * sin * normal + (1.0 - sin * sin).sqrt() * along);
        let receiver_normal = vector(25).normalize();
        let receiver_normal = receiver_normal * 1.0_f64.copysign(receiver_normal.dot(at - from));
        if receiver_normal.dot(at - from) < 0.05 * distance {
            continue;
        }
        let body = if is_closed { 2 } else { 1 };
        let shown = Shown { vertices, from, receiver_normal, lights: at, half_extents: DVec3::ZERO, body };
        let to_lights = power(28, -2.0, 2.0);
        let mut half_extents = to_lights * power(29, -3.0, 0.0) * (0.1 + vector(30).abs());
        if is_crossed {
            half_extents = half_extents.max(DVec3::splat(2.0 * to_lights * sin));
        }
        if i % 5 < 3 {
            half_extents[(i % 5) as usize] = 0.0;
        }
        let shown = shown.by_way_of(at, to_lights, half_extents, vector(33));
        let importance = shown.importance();
        assert!(importance > 0.0 && importance.is_finite(), "{i}: {importance}, {shown:?}");
    }
}

/// A mirror that has an importance anywhere in a ball of receivers has one for the ball, which is not much larger for a tiny
/// ball. A ball may cross the plane of the mirror, of which both sides or one reflect.
#[test]
fn a_ball_of_receivers_is_shown_what_its_points_are() {
    let (mut shown, mut hidden, mut ratios) = (0, 0, Vec::new());
    for i in 0..20_000 {
        let numbers = Stream::new(26, 0, i);
        let vector = |k: u32| DVec3::from_array([0, 1, 2].map(|axis| 2.0 * numbers.uniform(k + axis) - 1.0));
        let power = |k: u32, from: f64, to: f64| 10.0_f64.powf(from + (to - from) * numbers.uniform(k));
        let size = power(0, -3.0, 0.0);
        let at = 0.5 * vector(1);
        let vertices = [4, 7, 10].map(|k| at + size * vector(k));
        let distance = power(13, -1.0, 1.0);
        let radius = distance * power(14, -4.0, 0.0);
        let from = at + distance * vector(15).normalize();
        let half_extents = power(18, -2.0, 0.0) * vector(19).abs();
        let body = [1, 2][i as usize % 2];
        let leaf = TriangleLeaf::new(&[TriangleMirror { vertices, body }]);
        // Lights that the middle sees in the mirror, or near those.
        let receiver_normal = (at - from).normalize();
        let whole = Shown { vertices, from, receiver_normal, lights: at, half_extents: DVec3::ZERO, body };
        let far = power(25, -1.0, 1.0);
        let lights = whole.by_way_of(at, far, half_extents, 4.0 * vector(22)).lights;
        let at_point = |receiver: DVec3| query(receiver, receiver_normal, (lights, half_extents), 1);
        let of_ball = leaf.largest_importance(&at_point(from), radius as f32);
        let mut largest = 0.0_f64;
        for k in 0..16 {
            let inside = vector(26 + 3 * k);
            let receiver = from + radius * inside / inside.length().max(1.0);
            let importance = leaf.importance(&at_point(receiver))[0];
            assert!(importance == 0.0 || of_ball > 0.0, "{i}: {importance}");
            largest = largest.max(importance);
        }
        (shown, hidden) = (shown + i32::from(largest > 0.0), hidden + i32::from(of_ball == 0.0));
        if largest > 0.0 && radius < 1e-3 * distance && distance > 3.0 * size {
            ratios.push(of_ball / largest);
        }
    }
    ratios.sort_by(f64::total_cmp);
    let median = ratios[ratios.len() / 2];
    assert!(shown > 2000 && hidden > 2000 && median < 2.0, "{shown}, {hidden}, {median}");
}

/// The plane through the image of a point of a floor and the side with which a mirror stands on it is the floor's. Lights on
/// the ceiling all have the same distance from that, so their box has no width there, yet shows in the mirror.
#[test]
fn mirrors_that_stand_on_the_floor_show_the_ceiling() {
    let mut least = f64::INFINITY;
    for i in 0..20_000 {
        let numbers = Stream::new(25, 0, i);
        let uniform = |k: u32, from: f64, to: f64| from + (to - from) * numbers.uniform(k);
        // Facing all directions, or along an axis.
        let angle = if i % 2 == 0 { f64::from(i % 8) * 0.25 } else { numbers.uniform(0) };
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * angle);
        let foot = DVec3::new(uniform(1, -0.5, 0.5), 0.0, uniform(2, -0.5, 0.5));
        let (across, up) =
            (uniform(3, 0.1, 0.5) * DVec3::new(cos, 0.0, sin), uniform(4, 0.1, 0.5) * DVec3::Y);
        let mut vertices = [foot, foot + across, foot + across + up];
        vertices.rotate_left((i % 3) as usize);
        let at = foot + 0.6 * across + 0.3 * up;
        let back = DVec3::new(-sin, 0.0, cos) * uniform(5, 0.2, 1.0);
        let height = [0.0, 1e-7, 1e-3][i as usize % 3];
        let from = foot + uniform(6, -1.0, 1.5) * across + back + height * DVec3::Y;
        let whole = Shown {
            vertices,
            from,
            receiver_normal: DVec3::Y,
            lights: at,
            half_extents: DVec3::ZERO,
            body: 1,
        };
        let half_extents = uniform(7, 0.2, 0.5) * DVec3::new(1.0, 0.0, 1.0);
        let shown = whole.by_way_of(at, uniform(8, 0.5, 2.0), half_extents, DVec3::ZERO);
        let all = whole.by_way_of(at, 1.0, DVec3::splat(100.0), DVec3::ZERO);
        least = least.min(shown.importance() / all.importance());
    }
    assert!(least > 0.01, "{least}");
}
