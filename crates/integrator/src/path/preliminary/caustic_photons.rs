//! Paths from lights by way of mirrors: where they reach diffuse surfaces, photons are left (after Jensen 1996).

use crate::Stream;
use crate::checked_accel;
use crate::guide::{Photon, PhotonGuide, guide_vertex};
use crate::light::AliasTable;
use crate::path::caustics::MIN_MIRRORS;
use crate::path::emission_rays::reflected_ray;
use crate::path::mirrors_left::mirrors_left;
use crate::path::render_context::RenderContext;
use crate::sampler::ReservedStream;
use glam::Vec3;
use globillum_geom::{Frame, Hit, Ray, Triangle};
use globillum_material::Bsdf;
use globillum_material::warp::CosineHemisphere;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// How many paths leave lights for each pixel of the picture.
const PATHS_OF_PIXEL: u64 = 8;

/// How many leave lights at least and at most.
const PATHS_RANGE: [u64; 2] = [1 << 14, 1 << 20];

/// How many are traced at once.
const PATHS_AT_ONCE: u32 = 1 << 12;

/// A path from a light, with its next ray.
#[derive(Clone, Copy)]
struct PhotonPath {
    numbers: Stream,
    ray: Ray,
    mirrors: u32,
    /// Where the ray left the last mirror; zero before the first one.
    exit: Vec3,
}

/// The lights that are triangles, each sampled with a probability in proportion to its power.
struct Emitters<'a> {
    context: &'a RenderContext<'a>,
    triangles: Vec<u32>,
    table: AliasTable,
}

/// The guide toward caustics by way of several mirrors. `None` unless caustics are shared, lights are sampled by way of
/// mirrors, and the limit on bounces allows for several; and if there are few photons. Breaks if `cancelled` before the end.
pub(in crate::path) fn photon_guide(
    context: &RenderContext<'_>,
    cancelled: impl Fn() -> bool + Sync,
) -> ControlFlow<(), Option<PhotonGuide>> {
    let allows_several = mirrors_left(context.settings, 1) >= MIN_MIRRORS;
    let is_used = context.shares_caustics && context.mirrors.is_some() && allows_several;
    if !is_used {
        return ControlFlow::Continue(None);
    }
    match photons(context, cancelled) {
        Some(photons) => ControlFlow::Continue(PhotonGuide::new(&photons)),
        None => ControlFlow::Break(()),
    }
}

/// The photons of all paths, in their order; `None` if `cancelled` before the end.
fn photons(context: &RenderContext<'_>, cancelled: impl Fn() -> bool + Sync) -> Option<Vec<Photon>> {
    let lights = context.scene.lights();
    let powers: Vec<f64> = lights.area_powers().collect();
    let emitters =
        Emitters { context, triangles: lights.triangles().collect(), table: AliasTable::new(&powers) };
    let paths = PATHS_OF_PIXEL * context.settings.pixel_count();
    let paths = paths.clamp(PATHS_RANGE[0], PATHS_RANGE[1]) as u32;
    let chunks = (0..paths / PATHS_AT_ONCE).into_par_iter();
    let of_chunks: Option<Vec<Vec<Photon>>> =
        chunks.map(|chunk| photons_of_chunk(&emitters, chunk, &cancelled)).collect();
    of_chunks.map(|photons| photons.concat())
}

/// The photons of paths `chunk * PATHS_AT_ONCE` and on; `None` if `cancelled` before the end.
fn photons_of_chunk(
    emitters: &Emitters<'_>,
    chunk: u32,
    cancelled: impl Fn() -> bool,
) -> Option<Vec<Photon>> {
    let context = emitters.context;
    let first = chunk * PATHS_AT_ONCE;
    let mut paths: Vec<PhotonPath> =
        (first..first + PATHS_AT_ONCE).filter_map(|path| emitters.start(path)).collect();
    let (mut photons, mut rays, mut hits) = (Vec::new(), Vec::new(), Vec::new());
    while !paths.is_empty() {
        if cancelled() {
            return None;
        }
        rays.clear();
        rays.extend(paths.iter().map(|path| path.ray));
        checked_accel::intersect(context.scene.accel(), &rays, &mut hits);
        let advanced = paths
            .iter()
            .zip(&hits)
            .filter_map(|(path, hit)| path.advance(context, hit.as_ref()?, &mut photons));
        paths = advanced.collect();
    }
    Some(photons)
}

impl Emitters<'_> {
    /// Starts a path at a light, with a direction by the cosine.
    fn start(&self, path: u32) -> Option<PhotonPath> {
        let scene = self.context.scene;
        let numbers = Stream::reserved(ReservedStream::Photons, path);
        let triangle = self.triangles[self.table.sample(numbers.uniform(0))?];
        let (u, v) = Triangle::sample_uniform(numbers.uniform_pair(1));
        let point = scene.triangles().surface_point(triangle, u, v);
        let emission = scene.material(triangle).emission;
        let [front, back] = [1.0, -1.0].map(|cos| emission.toward(cos).luminance());
        let side = if numbers.uniform(3) * (front + back) < front { point.normal } else { -point.normal };
        let direction = Frame::around(side).to_world(CosineHemisphere::sample(numbers.uniform_pair(4)));
        Some(PhotonPath { numbers, ray: point.spawn_ray(direction), mirrors: 0, exit: Vec3::ZERO })
    }
}

impl PhotonPath {
    /// The path as a mirror reflects it. `None` if it ends; on a diffuse surface, it leaves a photon.
    fn advance(&self, context: &RenderContext<'_>, hit: &Hit, photons: &mut Vec<Photon>) -> Option<Self> {
        let at = context.scene.interaction(&self.ray, hit);
        let Self { mirrors, exit, .. } = *self;
        match at.material.bsdf {
            _ if !at.point.position.is_finite() => None,
            Bsdf::Mirror(reflectance) => {
                // Russian roulette: what goes on has the same power.
                let survives = self.numbers.uniform(6 + mirrors) < reflectance.rgb().max_component();
                (survives && mirrors < mirrors_left(context.settings, 1)).then(|| Self {
                    ray: reflected_ray(&at.point, self.ray.direction),
                    mirrors: mirrors + 1,
                    exit: at.point.position.as_vec3(),
                    ..*self
                })
            }
            Bsdf::Lambert(albedo) if mirrors >= MIN_MIRRORS && !albedo.rgb().is_black() => {
                let vertex = guide_vertex(at.receiver());
                photons.push(Photon { vertex, exit });
                None
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::test_rooms::built;
    use crate::{Model, PinholeCamera, Scene, Settings};
    use glam::DVec3;
    use globillum_geom::KdTree;
    use globillum_geom::conformance::shapes::quad;
    use globillum_material::{Emission, Material, Rgb, Sides};

    /// The first of two floors, or both, each below a light and beside mirrors at these distances. The lights have a radiance
    /// of two and of three, the second one also upward.
    fn floors(count: usize, mirrors: &[f64]) -> Scene<KdTree> {
        let mut model = Model::default();
        let mirror = Material::mirror(Rgb::new(0.5, 0.8, 0.2)).unwrap();
        for (x, radiance, sides) in
            [(0.0, 2.0, Sides::Front), (8.0, 3.0, Sides::Both)].into_iter().take(count)
        {
            let level = |y: f64, half: f64| {
                [(-half, 1.0), (half, 1.0), (half, -1.0), (-half, -1.0)]
                    .map(|(dx, z)| DVec3::new(x + dx, y, z))
            };
            let [a, b, c, d] = level(0.0, 0.5);
            model.add(Material::lambert(Rgb::splat(0.8)).unwrap(), quad(a, b, c, d));
            let [a, b, c, d] = level(4.0, 0.2);
            let emission = Emission::new(Rgb::splat(radiance), sides).unwrap();
            model.add(Material::lambert(Rgb::BLACK).unwrap().emitting(emission), quad(a, d, c, b));
            for dx in mirrors {
                let at = |y, z| DVec3::new(x + dx, y, z);
                model.add(mirror, quad(at(0.0, 1.0), at(0.0, -1.0), at(4.0, -1.0), at(4.0, 1.0)));
            }
        }
        built(model)
    }

    fn photons_in(scene: &Scene<KdTree>) -> Vec<Photon> {
        let camera = PinholeCamera::look_at(DVec3::new(0.0, 2.0, 3.0), DVec3::ZERO, DVec3::Y, 0.4).unwrap();
        let settings = Settings::new(128, 128, 4);
        photons(&RenderContext::new(scene, &camera, &settings), || false).expect("nothing cancels it")
    }

    /// Photons lie on floors, have left mirrors, and are as many as powers say: the second light sends as much downward as
    /// the first one does, times 1.5. Five standard deviations of their number are allowed.
    #[test]
    fn photons_come_from_lights_by_way_of_mirrors() {
        let photons = photons_in(&floors(2, &[-0.5, 0.5]));
        let mut counts = [0.0; 2];
        for Photon { vertex, exit } in &photons {
            let floor = usize::from(vertex[0] > 4.0);
            counts[floor] += 1.0;
            assert!(vertex[1].abs() < 1e-6 && vertex[4] == 1.0, "{vertex:?}");
            assert!(((exit.x - 8.0 * floor as f32).abs() - 0.5).abs() < 1e-6, "{exit}");
        }
        let error = 5.0 * f64::sqrt(counts[0] * 2.25 + counts[1]);
        assert!(counts[0] > 500.0, "{counts:?}");
        assert!((counts[1] - 1.5 * counts[0]).abs() < error, "{counts:?}");
    }

    #[test]
    fn one_mirror_has_no_photons() {
        assert!(photons_in(&floors(1, &[0.5])).is_empty());
    }
}
