use super::path_state::Path;
use super::render_context::RenderContext;
use crate::light::{ChosenLight, Receiver};
use crate::sampler::BounceNumbers;
use globillum_geom::{Hit, Ray};

/// How many vertices have their lights chosen at once.
const AT_ONCE: usize = 4;

/// The lights of the vertices that take one light sample, chosen in a light tree for several vertices at once: the choices
/// do not depend on each other, so a processor works on all of them. Its buffers are reused.
#[derive(Debug, Default)]
pub(super) struct LightChoices {
    vertices: Vec<Vertex>,
    /// For each path; empty if lights are chosen by power.
    of_paths: Vec<Option<ChosenLight>>,
}

/// A vertex for which a light is chosen.
#[derive(Clone, Copy, Debug)]
struct Vertex {
    /// The index of its path.
    path: usize,
    receiver: Receiver,
    /// The number that chooses the light.
    u: f64,
}

impl LightChoices {
    /// Chooses a light at each of `hits`, those of `paths`, which have these random numbers.
    #[inline(always)]
    pub(super) fn choose(
        &mut self,
        context: &RenderContext<'_>,
        paths: &[Path],
        rays: &[Ray],
        hits: &[Option<Hit>],
        numbers: &[BounceNumbers],
    ) {
        self.of_paths.clear();
        let (scene, lights) = (context.scene, context.scene.lights());
        if !context.samples_lights || !lights.are_in_a_tree() {
            return;
        }
        self.of_paths.resize(paths.len(), None);
        self.vertices.clear();
        for (i, (path, hit)) in paths.iter().zip(hits).enumerate() {
            let Some(hit) = hit else { continue };
            let takes_one = context.direct_samples(path.is_prefix()) == 1;
            if takes_one && !scene.material(hit.triangle).bsdf.is_delta() {
                let receiver = scene.interaction(&rays[i], hit).receiver();
                self.vertices.push(Vertex { path: i, receiver, u: numbers[i].light });
            }
        }
        for vertices in self.vertices.chunks(AT_ONCE) {
            let mut all = [vertices[0]; AT_ONCE];
            all[..vertices.len()].copy_from_slice(vertices);
            let chosen = lights.choose_each(all.map(|vertex| vertex.receiver), all.map(|vertex| vertex.u));
            for (vertex, light) in vertices.iter().zip(chosen) {
                self.of_paths[vertex.path] = light;
            }
        }
    }

    /// The light chosen for the path of this index; `None` if its vertex takes several samples, or chooses by power.
    #[inline(always)]
    pub(super) fn of_path(&self, index: usize) -> Option<ChosenLight> {
        self.of_paths.get(index).copied().flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::path_state::Stage;
    use crate::sampler::Member;
    use crate::{Camera, Model, Scene, Settings};
    use glam::DVec3;
    use globillum_geom::conformance::shapes::quad;
    use globillum_geom::{Accel, KdOptions, KdTree};
    use globillum_material::{Material, Rgb};

    /// A diffuse floor, a mirror beside it and a row of lights above.
    fn scene() -> Scene<KdTree> {
        let p = DVec3::new;
        let mut model = Model::default();
        let floor = quad(p(-1.0, 0.0, 1.0), p(1.0, 0.0, 1.0), p(1.0, 0.0, -1.0), p(-1.0, 0.0, -1.0));
        model.add(Material::lambert(Rgb::splat(0.7)).unwrap(), floor);
        let mirror = quad(p(-1.0, 0.0, -1.0), p(-1.1, 2.0, -1.0), p(-1.1, 2.0, 1.0), p(-1.0, 0.0, 1.0));
        model.add(Material::mirror(Rgb::splat(0.9)).unwrap(), mirror);
        for x in (0..5).map(|k| 0.4 * f64::from(k) - 1.0) {
            let light = quad(p(x, 1.5, 0.0), p(x + 0.2, 1.5, 0.0), p(x + 0.2, 1.5, 0.2), p(x, 1.5, 0.2));
            model.add(Material::light(Rgb::splat(1.0 + x)).unwrap(), light);
        }
        Scene::build(model, |triangles| KdTree::build(triangles, &KdOptions::default())).unwrap()
    }

    #[test]
    fn each_diffuse_vertex_has_the_light_that_it_chooses_alone() {
        let (scene, eye) = (scene(), DVec3::new(0.3, 0.8, 2.5));
        let camera = Camera::look_at(eye, DVec3::new(-0.4, 0.5, 0.0), DVec3::Y, 1.0).unwrap();
        let settings = Settings::new(8, 8, 4);
        let context = RenderContext::new(&scene, &camera, &settings);
        let rays = (0..203).map(|i| {
            let aim = DVec3::new(f64::from(i % 14) * 0.2 - 1.6, 0.0, f64::from(i / 14) * 0.2 - 1.5);
            Ray::new(eye, aim - eye)
        });
        let rays: Vec<_> = rays.collect();
        let hits: Vec<_> = rays.iter().map(|ray| scene.accel().intersect(ray)).collect();
        let draw = |i: u64| settings.sampler.numbers(1, Member::alone(i), 0, &(0..4));
        let mut paths: Vec<_> = (0..203).map(|i| Path::new(i as u32, draw(i))).collect();
        for path in paths.iter_mut().step_by(3) {
            path.stage = Stage::Beyond;
        }
        let numbers: Vec<_> =
            paths.iter().flat_map(|path| BounceNumbers::draw(&[path.numbers], 2, false)).collect();
        let mut choices = LightChoices::default();
        choices.choose(&context, &paths, &rays, &hits, &numbers);
        let mut chosen = 0;
        for i in 0..paths.len() {
            let takes_one = |hit: &Hit| i % 3 == 0 && !scene.material(hit.triangle).bsdf.is_delta();
            let alone = hits[i].filter(takes_one).and_then(|hit| {
                let receiver = scene.interaction(&rays[i], &hit).receiver();
                scene.lights().choose_each([receiver], [numbers[i].light])[0]
            });
            chosen += u32::from(alone.is_some());
            assert_eq!(choices.of_path(i), alone, "{i}");
        }
        assert!((30..60).contains(&chosen) && chosen % AT_ONCE as u32 != 0, "{chosen}");
    }
}
