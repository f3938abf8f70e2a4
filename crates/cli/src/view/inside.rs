//! Rooms, which are seen from inside.

use super::axes::Up;
use globillum::geom::{Accel, Hit, Ray};
use globillum::glam::DVec3;
use globillum::integrator::{Monitor, PinholeCamera, Render, RenderError, Scene, Settings};

/// Degrees from bottom to top: rooms are narrow.
const FIELD_OF_VIEW: f64 = 65.0;

/// A scene is closed if at least this share of the rays from its eyes, in all directions, hits something.
const CLOSED: f64 = 0.9;

/// A closed scene is seen from inside if it is at least this bright there, compared with outside.
const BRIGHT: f64 = 0.25;

/// The height of an eye, as a share of the scene's.
const EYE_HEIGHT: f64 = 0.6;

/// Places of eyes along each side of the floor.
const PLACES: u32 = 8;

/// How many views, those that see farthest, are tried for their light.
const VIEWS_TRIED: usize = 8;

/// The most bounces of paths that try a view: in a dense scene each ray takes long.
const BOUNCES: u32 = 4;

/// A camera inside a closed scene that has light inside, in a picture `aspect` times as wide as high; `None`
/// for other scenes, which are seen by `outside`, and if `cancelled`.
pub(crate) fn of_room<A: Accel>(
    scene: &Scene<A>,
    up: Up,
    aspect: f64,
    outside: &PinholeCamera,
    cancelled: &(dyn Fn() -> bool + Sync),
) -> Result<Option<PinholeCamera>, RenderError> {
    let eyes = eyes(scene, up);
    if enclosed_share(scene, &eyes) < CLOSED {
        return Ok(None);
    }
    let enough = BRIGHT * brightness(scene, outside, cancelled)?;
    let mut views = Vec::new();
    for eye in eyes {
        if cancelled() {
            return Ok(None);
        }
        views.push(best_view(scene, eye, up, aspect)?);
    }
    views.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (_, camera) in views.into_iter().take(VIEWS_TRIED) {
        if cancelled() {
            return Ok(None);
        }
        let found = brightness(scene, &camera, cancelled)?;
        if found > 0.0 && found >= enough {
            return Ok(Some(camera));
        }
    }
    Ok(None)
}

/// Where a viewer could stand, evenly spread over the floor.
fn eyes<A>(scene: &Scene<A>, up: Up) -> Vec<DVec3> {
    let bounds = scene.triangles().bounds();
    let axes = up.axes();
    let middle = bounds.center();
    let size = (axes.transpose() * bounds.extent()).abs();
    let share = |i| (f64::from(i) + 0.5) / f64::from(PLACES) - 0.5;
    let places = (0..PLACES).flat_map(|x| (0..PLACES).map(move |z| (x, z)));
    places.map(|(x, z)| middle + axes * (size * DVec3::new(share(x), EYE_HEIGHT - 0.5, share(z)))).collect()
}

/// The share of rays from `eyes` in all directions that hit something.
fn enclosed_share<A: Accel>(scene: &Scene<A>, eyes: &[DVec3]) -> f64 {
    // The points of a cube of 5 by 5 by 5 that lie on its surface.
    let cube = || (-2..=2).flat_map(|x| (-2..=2).flat_map(move |y| (-2..=2).map(move |z| [x, y, z])));
    let surface = cube().filter(|p: &[i32; 3]| p.iter().any(|x| x.abs() == 2));
    let directions: Vec<DVec3> = surface.map(|p| DVec3::from(p.map(f64::from))).collect();
    let rays = eyes.iter().flat_map(|&eye| directions.iter().map(move |&direction| Ray::new(eye, direction)));
    let rays: Vec<Ray> = rays.collect();
    let mut occluded = Vec::new();
    scene.accel().occluded_batch(&rays, &mut occluded);
    occluded.iter().filter(|&&hit| hit).count() as f64 / rays.len() as f64
}

/// Of the views from `eye` in 16 directions, a little downward, the one that sees farthest, and how far.
fn best_view<A: Accel>(
    scene: &Scene<A>,
    eye: DVec3,
    up: Up,
    aspect: f64,
) -> Result<(f64, PinholeCamera), RenderError> {
    let axes = up.axes();
    let around = (-2..=2).flat_map(|x: i32| (-2..=2).map(move |z: i32| (x, z)));
    let around = around.filter(|(x, z)| x.abs().max(z.abs()) == 2);
    let mut best: Option<(f64, PinholeCamera)> = None;
    for (x, z) in around {
        let ahead = DVec3::new(x.into(), 0.0, z.into()).normalize() - 0.2 * DVec3::Y;
        let target = eye + scene.triangles().bounds().extent().max_element() * (axes * ahead);
        let camera = PinholeCamera::look_at(eye, target, axes.y_axis, FIELD_OF_VIEW.to_radians())?;
        let depth = depth(scene, &camera, aspect);
        if best.is_none_or(|(deepest, _)| depth > deepest) {
            best = Some((depth, camera));
        }
    }
    best.ok_or(RenderError::Camera("a room must have directions"))
}

/// The mean over a picture of `d / (d + unit)`, with the distance `d` and a quarter of the scene's diagonal as
/// `unit`: what is close to the eye costs more than what is far away brings. A ray that leaves the scene has 0.
fn depth<A: Accel>(scene: &Scene<A>, camera: &PinholeCamera, aspect: f64) -> f64 {
    let middle = |i, count| (2.0 * f64::from(i) + 1.0) / f64::from(count) - 1.0;
    let pixels = (0..8).flat_map(|y| (0..12).map(move |x| (middle(x, 12), middle(y, 8))));
    let rays: Vec<Ray> = pixels.map(|(x, y)| camera.ray(x, y, aspect)).collect();
    let mut hits = Vec::new();
    scene.accel().intersect_batch(&rays, &mut hits);
    let distance = |(ray, hit): (&Ray, &Option<Hit>)| hit.map_or(0.0, |hit| hit.t * ray.direction.length());
    let unit = 0.25 * scene.triangles().bounds().extent().length();
    rays.iter().zip(&hits).map(distance).map(|d| d / (d + unit)).sum::<f64>() / rays.len() as f64
}

/// Cancels a render.
struct Canceller<'a>(&'a (dyn Fn() -> bool + Sync));

impl Monitor for Canceller<'_> {
    fn cancelled(&self) -> bool {
        (self.0)()
    }
}

/// The mean luminance of a small picture.
fn brightness<A: Accel>(
    scene: &Scene<A>,
    camera: &PinholeCamera,
    cancelled: &(dyn Fn() -> bool + Sync),
) -> Result<f64, RenderError> {
    let mut settings = Settings::new(12, 8, 16);
    settings.threads = rayon::current_num_threads();
    settings.max_bounces = Some(BOUNCES);
    let picture = Render::new(scene, camera, &settings).monitor(&Canceller(cancelled)).run()?;
    Ok(picture.film.image_mean().luminance())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::AccelKind;
    use crate::view::{AnyCamera, CameraBy, CameraType, View};
    use globillum::geom::Triangle;
    use globillum::glam::Vec3;
    use globillum::integrator::{DeltaLight, Model};
    use globillum::material::{Material, Rgb};
    use globillum_testkit::shapes::{cuboid, icosphere, inside_out};
    use globillum_testkit::{cornell, scenes};

    /// A room of 6 by 2.5 by 4 with its middle at the origin; its walls face outward, as those of a cube do.
    fn walls() -> Vec<Triangle> {
        cuboid(DVec3::ZERO, DVec3::new(3.0, 1.25, 2.0), 0.0)
    }

    fn model(parts: impl IntoIterator<Item = (Material, Vec<Triangle>)>) -> Model {
        let mut model = Model::default();
        parts.into_iter().for_each(|(material, triangles)| {
            model.add(material, triangles);
        });
        model
    }

    fn white() -> Material {
        Material::lambert(Rgb::splat(0.7)).expect("in range")
    }

    fn light() -> Material {
        Material::light(Rgb::splat(5.0)).expect("in range")
    }

    fn bulb(at: DVec3) -> Vec<Triangle> {
        cuboid(at, DVec3::splat(0.1), 0.0)
    }

    fn view(mut model: Model, up: Up, environment: f64, accel: AccelKind) -> (PinholeCamera, CameraBy) {
        model.set_environment(Rgb::splat(environment)).expect("in range");
        let scene = Scene::build(model, |triangles| accel.build(triangles)).expect("a good model");
        match View::Automatic(CameraType::Pinhole, up)
            .camera(&scene, 1.5, &|| false)
            .expect("it has an extent")
        {
            (AnyCamera::Pinhole(camera), by) => (camera, by),
            (other, _) => panic!("{other:?} was not asked for"),
        }
    }

    #[test]
    fn a_closed_room_with_a_light_is_seen_from_inside() {
        for walls in [walls(), inside_out(walls())] {
            let room = || model([(white(), walls.clone()), (light(), bulb(DVec3::Y))]);
            let (camera, by) = view(room(), Up::Y, 0.0, AccelKind::Wide);
            assert_eq!(by, CameraBy::Inside);
            assert_eq!((camera, by), view(room(), Up::Y, 0.0, AccelKind::Kd));
            let ray = camera.ray(0.0, 0.0, 1.0);
            // It stands in a corner and looks across, at the height of the eyes of someone who stands.
            assert!((ray.origin.abs() - DVec3::new(2.625, 0.25, 1.75)).length() < 1e-12, "{ray:?}");
            assert!(ray.origin.x * ray.direction.x < 0.0 && ray.origin.z * ray.direction.z < 0.0, "{ray:?}");
            assert!(ray.direction.y < 0.0, "{ray:?}");
        }
    }

    #[test]
    fn a_search_that_is_cancelled_ends_with_the_view_from_outside() {
        let room = model([(white(), walls()), (light(), bulb(DVec3::Y))]);
        let scene = Scene::build(room, |triangles| AccelKind::Wide.build(triangles)).expect("a good model");
        let view = View::Automatic(CameraType::Pinhole, Up::Y);
        let (_, by) = view.camera(&scene, 1.5, &|| true).expect("it has an extent");
        assert_eq!(by, CameraBy::Outside);
    }

    #[test]
    fn a_point_light_lights_a_room() {
        let mut room = model([(white(), walls())]);
        room.add_delta_light(DeltaLight::point(Vec3::Y, Rgb::splat(5.0)).expect("in range"));
        assert_eq!(view(room, Up::Y, 0.0, AccelKind::Wide).1, CameraBy::Inside);
    }

    #[test]
    fn up_is_up_in_rooms_too() {
        let swap = |t: Triangle| Triangle { vertices: t.vertices.map(|v| Vec3::new(v.x, -v.z, v.y)) };
        let parts = [(white(), walls()), (light(), bulb(DVec3::Y))];
        let room = model(parts.map(|(material, t)| (material, t.into_iter().map(swap).collect())));
        let (camera, by) = view(room, Up::Z, 0.0, AccelKind::Wide);
        assert_eq!(by, CameraBy::Inside);
        let eye = camera.ray(0.0, 0.0, 1.0).origin;
        assert!((eye.abs() - DVec3::new(2.625, 1.75, 0.25)).length() < 1e-12, "{eye}");
    }

    #[test]
    fn what_is_solid_open_or_dark_inside_is_seen_from_outside() {
        let solid = || vec![(white(), walls())];
        let sphere = || vec![(white(), icosphere(2).triangles())];
        let above = (light(), bulb(4.0 * DVec3::Y));
        for (name, model, environment) in [
            ("a solid in an environment", model(solid()), 1.0),
            ("a black solid", model(solid()), 0.0),
            ("a sphere", model(sphere()), 1.0),
            ("a light above a solid", model(solid().into_iter().chain([above])), 0.0),
            ("a room that is brighter outside", model([(white(), walls()), (light(), bulb(DVec3::Y))]), 1e4),
            ("an open box", cornell::with_blocks(false).expect("it is built in"), 0.0),
            ("a light over a floor", scenes::light_over_floor(), 0.0),
        ] {
            assert_eq!(view(model, Up::Y, environment, AccelKind::Wide).1, CameraBy::Outside, "{name}");
        }
    }
}
