use crate::light::{ChosenLight, ChosenMirror, Receiver};
use crate::path::path_state::Path;
use crate::path::path_vertex::PriorChoice;
use crate::path::render_context::RenderContext;
use crate::sampler::BounceNumbers;
use globillum_geom::{Hit, Ray};

/// For how many vertices choices are made at once.
const VERTICES_AT_ONCE: usize = 4;

/// Choices of lights or mirrors in a tree, made for several vertices at once: they do not depend on each other, so a
/// processor works on all of them. Only vertices that take one sample have one. Its buffers are reused.
#[derive(Debug)]
pub(in crate::path) struct Choices<T> {
    vertices: Vec<Vertex>,
    /// For each path, what was chosen for its vertex; empty if nothing was.
    of_paths: Vec<PriorChoice<T>>,
}

/// A vertex for which something is chosen.
#[derive(Clone, Copy, Debug)]
struct Vertex {
    /// The index of its path.
    path: usize,
    receiver: Receiver,
    /// The number that chooses.
    u: f64,
}

impl<T> Default for Choices<T> {
    fn default() -> Self {
        Self { vertices: Vec::new(), of_paths: Vec::new() }
    }
}

impl<T: Copy> Choices<T> {
    /// What was chosen for the path of this index.
    #[inline(always)]
    pub(in crate::path) fn of_path(&self, index: usize) -> PriorChoice<T> {
        self.of_paths.get(index).copied().unwrap_or(PriorChoice::Open)
    }

    /// Chooses for those vertices of `paths` that `takes_one` says take one sample, each by what `number` returns for the
    /// index of its path.
    #[inline(always)]
    fn make(
        &mut self,
        context: &RenderContext<'_>,
        (paths, rays, hits): Wave<'_>,
        takes_one: impl Fn(&Path) -> bool,
        number: impl Fn(usize) -> f64,
        choose: impl Fn(
            [Receiver; VERTICES_AT_ONCE],
            [f64; VERTICES_AT_ONCE],
        ) -> [PriorChoice<T>; VERTICES_AT_ONCE],
    ) {
        let scene = context.scene;
        self.of_paths.resize(paths.len(), PriorChoice::Open);
        self.vertices.clear();
        for (i, (path, hit)) in paths.iter().zip(hits).enumerate() {
            let Some(hit) = hit else { continue };
            if takes_one(path) && !scene.material(hit.triangle).bsdf.is_delta() {
                let receiver = scene.interaction(&rays[i], hit).receiver();
                self.vertices.push(Vertex { path: i, receiver, u: number(i) });
            }
        }
        for vertices in self.vertices.chunks(VERTICES_AT_ONCE) {
            let mut all = [vertices[0]; VERTICES_AT_ONCE];
            all[..vertices.len()].copy_from_slice(vertices);
            let chosen = choose(all.map(|vertex| vertex.receiver), all.map(|vertex| vertex.u));
            for (vertex, chosen) in vertices.iter().zip(chosen) {
                self.of_paths[vertex.path] = chosen;
            }
        }
    }
}

/// Paths, the next ray of each, and what it hits.
type Wave<'a> = (&'a [Path], &'a [Ray], &'a [Option<Hit>]);

impl Choices<ChosenLight> {
    /// Chooses lights, unless they are chosen by power. `numbers` are those of each path.
    #[inline(always)]
    pub(in crate::path) fn choose_lights(
        &mut self,
        context: &RenderContext<'_>,
        wave: Wave<'_>,
        numbers: &[BounceNumbers],
    ) {
        self.of_paths.clear();
        let Some(tree) = context.lights().tree().filter(|_| context.samples_lights) else { return };
        let takes_one = |path: &Path| context.direct_samples(path.is_prefix()) == 1;
        let choose =
            |receivers, us| tree.choose_each(receivers, us).map(|light| PriorChoice::Made(Some(light)));
        self.make(context, wave, takes_one, |i| numbers[i].light, choose);
    }
}

impl Choices<ChosenMirror> {
    /// Chooses small mirrors. `numbers` are those of each path; empty unless most take one sample.
    #[inline(always)]
    pub(in crate::path) fn choose_small_mirrors(
        &mut self,
        context: &RenderContext<'_>,
        wave: Wave<'_>,
        numbers: &[f64],
    ) {
        self.of_paths.clear();
        let Some(mirrors) = context.small_mirrors().filter(|_| !numbers.is_empty()) else { return };
        let takes_one = |path: &Path| context.small_mirror_samples(path.is_prefix()) == 1;
        let choose = |receivers, us| mirrors.choose(receivers, 1, us).map(PriorChoice::Made);
        self.make(context, wave, takes_one, |i| numbers[i], choose);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::mis::MisContext;
    use crate::path::reuse_stage::ReuseStage;
    use crate::path::test_rooms::built;
    use crate::sampler::Member;
    use crate::sampler::MirrorSize;
    use crate::{Model, PinholeCamera, Scene, Settings};
    use glam::DVec3;
    use globillum_geom::conformance::shapes::{icosphere, quad};
    use globillum_geom::{Accel, KdTree};
    use globillum_material::{Material, Rgb};

    /// A diffuse floor, a mirror beside it, a mirror ball above it and a row of lights.
    fn scene() -> Scene<KdTree> {
        let p = DVec3::new;
        let mut model = Model::default();
        let floor = quad(p(-1.0, 0.0, 1.0), p(1.0, 0.0, 1.0), p(1.0, 0.0, -1.0), p(-1.0, 0.0, -1.0));
        model.add(Material::lambert(Rgb::splat(0.7)).unwrap(), floor);
        let mirror = quad(p(-1.0, 0.0, -1.0), p(-1.1, 2.0, -1.0), p(-1.1, 2.0, 1.0), p(-1.0, 0.0, 1.0));
        model.add(Material::mirror(Rgb::splat(0.9)).unwrap(), mirror);
        let ball = icosphere(3).placed(0.2, p(0.6, 0.3, 0.2)).triangles();
        model.add(Material::mirror(Rgb::splat(0.9)).unwrap(), ball);
        for x in (0..5).map(|k| 0.4 * f64::from(k) - 1.0) {
            let light = quad(p(x, 1.5, 0.0), p(x + 0.2, 1.5, 0.0), p(x + 0.2, 1.5, 0.2), p(x, 1.5, 0.2));
            model.add(Material::light(Rgb::splat(1.0 + x)).unwrap(), light);
        }
        built(model)
    }

    #[test]
    fn each_diffuse_vertex_has_what_it_chooses_alone() {
        let (scene, eye) = (scene(), DVec3::new(0.3, 0.8, 2.5));
        let camera = PinholeCamera::look_at(eye, DVec3::new(-0.4, 0.5, 0.0), DVec3::Y, 1.0).unwrap();
        let settings = Settings::new(8, 8, 4);
        let context = RenderContext::new(&scene, &camera, &settings);
        let small_mirrors = context.small_mirrors().unwrap();
        let rays = (0..203).map(|i| {
            let aim = DVec3::new(f64::from(i % 14) * 0.2 - 1.6, 0.0, f64::from(i / 14) * 0.2 - 1.5);
            Ray::new(eye, aim - eye)
        });
        let rays: Vec<_> = rays.collect();
        let hits: Vec<_> = rays.iter().map(|ray| scene.accel().intersect(ray)).collect();
        let draw = |i: u64| settings.sampler.numbers(1, Member::alone(i), 0, &(0..4));
        let mut paths: Vec<_> =
            (0..203).map(|i| Path::new(i as u32, draw(i), MisContext::of_camera(false))).collect();
        for path in paths.iter_mut().step_by(3) {
            path.stage = ReuseStage::Settled;
        }
        let numbers: Vec<_> =
            paths.iter().flat_map(|path| BounceNumbers::draw(&[path.numbers], 2, false)).collect();
        // Small numbers: with large ones most vertices choose none.
        let of_mirrors: Vec<_> =
            paths.iter().map(|path| 0.001 * path.numbers.mirror(MirrorSize::Small, 2)).collect();
        let (mut lights, mut mirrors) = (Choices::default(), Choices::default());
        lights.choose_lights(&context, (&paths, &rays, &hits), &numbers);
        mirrors.choose_small_mirrors(&context, (&paths, &rays, &hits), &of_mirrors);
        let (mut with_light, mut with_mirror) = (0, 0);
        for i in 0..paths.len() {
            let takes_one = |hit: &Hit| i % 3 == 0 && !scene.material(hit.triangle).bsdf.is_delta();
            let Some(hit) = hits[i].filter(takes_one) else {
                assert_eq!(
                    (lights.of_path(i), mirrors.of_path(i)),
                    (PriorChoice::Open, PriorChoice::Open),
                    "{i}"
                );
                continue;
            };
            let receiver = scene.interaction(&rays[i], &hit).receiver();
            let tree = scene.lights().tree().expect("there are many lights");
            let [light] = tree.choose_each([receiver], [numbers[i].light]);
            let [mirror] = small_mirrors.choose([receiver], 1, [of_mirrors[i]]);
            // They choose different ones of the five clusters.
            let us = [0.4, 0.0, 0.2, 0.2].map(|u| u + 0.2 * of_mirrors[i]);
            let alone = us.map(|u| small_mirrors.choose([receiver], 1, [u])[0]);
            assert_eq!(small_mirrors.choose([receiver; 4], 1, us), alone, "{i}");
            with_light += 1;
            with_mirror += u32::from(mirror.is_some());
            assert_eq!(lights.of_path(i), PriorChoice::Made(Some(light)), "{i}");
            assert_eq!(mirrors.of_path(i), PriorChoice::Made(mirror), "{i}");
        }
        assert!((30..60).contains(&with_light) && with_light % VERTICES_AT_ONCE as u32 != 0, "{with_light}");
        assert!((10..with_light).contains(&with_mirror), "{with_mirror}");
    }

    #[test]
    fn without_numbers_nothing_is_chosen() {
        let scene = scene();
        let camera = PinholeCamera::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, 1.0).unwrap();
        let settings = Settings::new(8, 8, 4);
        let context = RenderContext::new(&scene, &camera, &settings);
        let (ray, draw) =
            (Ray::new(DVec3::Y, -DVec3::Y), settings.sampler.numbers(1, Member::alone(0), 0, &(0..4)));
        let (mut path, hit) =
            (Path::new(0, draw, MisContext::of_camera(false)), scene.accel().intersect(&ray));
        path.stage = ReuseStage::Settled;
        let mut choices = Choices::default();
        choices.choose_small_mirrors(&context, (&[path], &[ray], &[hit]), &[0.5]);
        assert!(matches!(choices.of_path(0), PriorChoice::Made(_)));
        choices.choose_small_mirrors(&context, (&[path], &[ray], &[hit]), &[]);
        assert_eq!(choices.of_path(0), PriorChoice::Open);
    }
}
