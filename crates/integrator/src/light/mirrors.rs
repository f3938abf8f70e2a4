//! The plane mirrors in which area lights are sampled.

use super::lights::{AreaLight, Light, Lights};
use super::mirror_plane::{PlaneMirror, Sphere};
use crate::Stream;
use glam::DVec3;
use globillum_geom::{Accel, Triangle, Triangles};

/// The plane mirrors of a scene in which area lights are sampled. Delta lights are not: BSDF sampling finds them
/// in a mirror with probability zero, so the mean would depend on whether mirrors are sampled.
///
/// A point `x` sees in a plane mirror what its image `x'`, on the other side of the plane, sees through
/// the mirror's triangles. Reflection is an isometry: the density of a direction at `x'` is that of the
/// reflected direction at `x`.
#[derive(Clone, Debug)]
pub(crate) struct PlaneMirrors {
    planes: Vec<PlaneMirror>,
    /// The triangles of all planes in ascending order, each with its plane.
    members: Vec<(u32, usize)>,
    /// Bounds all area lights.
    light_bounds: Sphere,
}

/// The image of a shading point in a plane mirror.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Image<'a> {
    pub(crate) mirror: &'a PlaneMirror,
    /// The index of the mirror.
    pub(crate) plane: usize,
    /// The position of the image.
    pub(crate) position: DVec3,
    /// The probability of choosing this mirror at the shading point, above zero.
    pub(crate) choice_prob: f64,
}

/// A set of mirrors, one bit each.
#[derive(Clone, Copy)]
struct MirrorSet(u64);

impl PlaneMirrors {
    /// The smallest area of a plane's triangles as a share of all mirrors' area, so that there are at most
    /// [`MirrorSet::MAX`] planes. Smaller ones and curved mirrors, whose planes are small, are left to
    /// scattering.
    const LEAST_PLANE: f64 = 1.0 / MirrorSet::MAX as f64;

    /// The smallest area of a triangle as a share of all mirrors' area, so that a sample tests at most 256.
    const LEAST_TRIANGLE: f64 = 1.0 / 256.0;

    /// Groups the triangles for which `is_mirror` holds by planes; none if there are no area lights. Traces up to
    /// 128 segments for each plane.
    pub(crate) fn of<A: Accel + ?Sized>(
        triangles: &Triangles,
        is_mirror: impl Fn(u32) -> bool,
        lights: &Lights,
        accel: &A,
    ) -> Self {
        let emitting = lights.triangles().flat_map(|index| triangles.get(index).vertices);
        let light_bounds = Sphere::around(emitting);
        if lights.triangles().next().is_none() {
            return Self { planes: Vec::new(), members: Vec::new(), light_bounds };
        }
        let mut planes = Vec::new();
        let mut members = Vec::new();
        for mut group in coplanar_mirrors(triangles, is_mirror) {
            group.plane.lit = lit(&group, triangles, lights, accel);
            members.extend(group.members.iter().map(|&index| (index, planes.len())));
            planes.push(group.plane);
        }
        members.sort_unstable();
        Self { planes, members, light_bounds }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.planes.is_empty()
    }

    /// The index of the mirror that triangle `index` belongs to.
    pub(crate) fn plane_of(&self, index: u32) -> Option<usize> {
        let place = self.members.binary_search_by_key(&index, |&(triangle, _)| triangle).ok()?;
        Some(self.members[place].1)
    }

    /// Chooses uniformly among the mirrors in which `from` may see a light, by `u` in `[0, 1)`; `None` if
    /// there is none.
    pub(crate) fn choose(&self, from: DVec3, u: impl FnOnce() -> f64) -> Option<Image<'_>> {
        let candidates = self.candidates(from);
        let plane = match candidates.count() {
            0 => return None,
            1 => candidates.nth(0),
            count => candidates.nth((u() * f64::from(count)) as u32),
        };
        Some(self.image(from, plane, candidates))
    }

    /// The image of `from` in mirror `plane`; `None` if that mirror is never chosen at `from`.
    pub(crate) fn image_in(&self, plane: usize, from: DVec3) -> Option<Image<'_>> {
        let candidates = self.candidates(from);
        candidates.contains(plane).then(|| self.image(from, plane, candidates))
    }

    fn image(&self, from: DVec3, plane: usize, candidates: MirrorSet) -> Image<'_> {
        let mirror = &self.planes[plane];
        let choice_prob = 1.0 / f64::from(candidates.count());
        Image { mirror, plane, position: mirror.image_of(from), choice_prob }
    }

    /// The mirrors in which `from` may see a light.
    fn candidates(&self, from: DVec3) -> MirrorSet {
        let may_show = |mirror: &PlaneMirror| u64::from(mirror.may_show(&self.light_bounds, from));
        let shifted = (0..).zip(&self.planes).map(|(plane, mirror)| may_show(mirror) << plane);
        MirrorSet(shifted.fold(0, |all, one| all | one))
    }
}

impl MirrorSet {
    const MAX: usize = u64::BITS as usize;

    fn count(self) -> u32 {
        self.0.count_ones()
    }

    fn contains(self, plane: usize) -> bool {
        self.0 >> plane & 1 == 1
    }

    /// The mirror at position `n`, counted from 0.
    fn nth(self, n: u32) -> usize {
        let rest = (0..n).fold(self.0, |rest, _| rest & (rest - 1));
        rest.trailing_zeros() as usize
    }
}

/// A plane mirror and the indices of its triangles.
struct CoplanarMirrors {
    plane: PlaneMirror,
    members: Vec<u32>,
}

/// The large mirror triangles grouped by plane, without small planes.
fn coplanar_mirrors(triangles: &Triangles, is_mirror: impl Fn(u32) -> bool) -> Vec<CoplanarMirrors> {
    let mirrors = triangles.live().iter().copied().filter(|&index| is_mirror(index));
    let mut mirrors: Vec<(u32, f64)> = mirrors.map(|index| (index, triangles.get(index).area())).collect();
    let total: f64 = mirrors.iter().map(|(_, area)| area).sum();
    mirrors.retain(|&(_, area)| area >= PlaneMirrors::LEAST_TRIANGLE * total);
    // Larger triangles determine their plane more precisely.
    mirrors.sort_by(|(_, a), (_, b)| b.total_cmp(a));
    let mut groups: Vec<CoplanarMirrors> = Vec::new();
    for (index, _) in mirrors {
        let triangle = triangles.get(index);
        match groups.iter_mut().find(|group| group.plane.contains(triangle)) {
            Some(group) => {
                group.plane.add(triangle);
                group.members.push(index);
            }
            None => {
                groups.push(CoplanarMirrors { plane: PlaneMirror::through(triangle), members: vec![index] })
            }
        }
    }
    groups.retain(|group| group.plane.area >= PlaneMirrors::LEAST_PLANE * total);
    // Rounding of the sums may admit one more.
    groups.truncate(MirrorSet::MAX);
    groups
}

/// Whether lights are visible from the back of the plane, and from its front: whether one of 128 segments
/// between random points of mirror and lights is unoccluded. This excludes the inside of closed mirrors. A
/// side that sees a light nevertheless is left to scattering.
fn lit<A: Accel + ?Sized>(
    group: &CoplanarMirrors,
    triangles: &Triangles,
    lights: &Lights,
    accel: &A,
) -> [bool; 2] {
    let mut lit = [false; 2];
    for (i, &member) in (0..128).zip(group.members.iter().cycle()) {
        let numbers = Stream::new(0, group.members[0].into(), i);
        let place = |index: u32, u: [f64; 2]| {
            let (u, v) = Triangle::sample_uniform(u);
            triangles.surface_point(index, u, v)
        };
        let mirror = place(member, numbers.uniform_pair(1));
        let Some(Light::Area(light, _)) = lights.choose(mirror.position, numbers.uniform(0)) else {
            continue;
        };
        let AreaLight { triangle, emission, .. } = *light;
        let light = place(triangle, numbers.uniform_pair(3));
        let side = usize::from(group.plane.height(light.position) > 0.0);
        let shines = !emission.toward(light.normal.dot(mirror.position - light.position)).is_black();
        let is_free = |segment| !accel.occluded(&segment);
        lit[side] = lit[side] || shines && mirror.segment_to(&light).is_some_and(is_free);
    }
    lit
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use globillum_geom::conformance::shapes::{cuboid, icosphere, quad};
    use globillum_geom::{KdOptions, KdTree, Ray};
    use globillum_material::{Emission, Rgb, Sides};

    /// The mirrors among `mirrors` that may show a light that faces down.
    fn under_a_light(mirrors: impl IntoIterator<Item = Triangle>) -> (Triangles, Lights, PlaneMirrors) {
        let p = DVec3::new;
        let light = quad(p(-1.0, 4.0, -1.0), p(1.0, 4.0, -1.0), p(1.0, 4.0, 1.0), p(-1.0, 4.0, 1.0));
        let triangles = Triangles::new(light.into_iter().chain(mirrors).collect()).unwrap();
        let glow = Emission::new(Rgb::WHITE, Sides::Front).unwrap();
        let lights = Lights::of(&triangles, |index| if index < 2 { glow } else { Emission::NONE }, &[]);
        let tree = KdTree::build(&triangles, &KdOptions::default()).unwrap();
        let mirrors = PlaneMirrors::of(&triangles, |index| index >= 2, &lights, &tree);
        (triangles, lights, mirrors)
    }

    fn block() -> Vec<Triangle> {
        cuboid(DVec3::new(0.3, 0.1, -0.2), DVec3::new(0.3, 0.6, 0.4), 0.32).to_vec()
    }

    /// A square of `n` by `n` squares, each of two triangles.
    fn tiles(n: u32) -> Vec<Triangle> {
        let corner = |i: u32, j: u32| {
            // Turned, so that vertices are rounded.
            let (x, z) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
            glam::DQuat::from_rotation_z(0.3) * DVec3::new(x, 0.0, z)
        };
        let tile = |i, j| quad(corner(i, j + 1), corner(i + 1, j + 1), corner(i + 1, j), corner(i, j));
        (0..n).flat_map(|i| (0..n).flat_map(move |j| tile(i, j))).collect()
    }

    /// A concave mirror of `n` strips, each turned by `step` from the one before.
    fn strips(n: u32, step: f64) -> Vec<Triangle> {
        let width = 1.0 / f64::from(n);
        let mut edge = DVec3::ZERO;
        let strip = |i: u32| {
            let (sin, cos) = (step * f64::from(i)).sin_cos();
            let next = edge + width * DVec3::new(cos, sin, 0.0);
            let depth = DVec3::Z;
            let strip = quad(edge + depth, next + depth, next, edge);
            edge = next;
            strip
        };
        (0..n).flat_map(strip).collect()
    }

    #[test]
    fn planes_are_found_and_curved_mirrors_are_not() {
        let statue = icosphere(3).placed(0.5, DVec3::new(3.0, 0.0, 0.0)).triangles();
        let with_statue = || tiles(1).into_iter().chain(statue.clone());
        let cases = [
            ("a block", block(), 6, 12),
            ("tiles", tiles(8), 1, 128),
            ("tiles too small", tiles(16), 0, 0),
            ("a curved mirror", statue.clone(), 0, 0),
            ("a wall and a curved mirror", with_statue().collect(), 1, 2),
            ("a mirror all but plane", strips(32, 1.2e-4), 32, 64),
            ("a die of twenty faces", icosphere(0).triangles(), 20, 20),
        ];
        for (what, mirrors, planes, members) in cases {
            let (.., found) = under_a_light(mirrors);
            assert_eq!((found.planes.len(), found.members.len()), (planes, members), "{what}");
        }
        let triangles = Triangles::new(block()).unwrap();
        let tree = KdTree::build(&triangles, &KdOptions::default()).unwrap();
        let dark = Lights::of(&triangles, |_| Emission::NONE, &[]);
        let found = PlaneMirrors::of(&triangles, |_| true, &dark, &tree);
        assert!(found.is_empty());
    }

    /// Of the block's faces those that face down see no light, and none does from within.
    #[test]
    fn sides_that_see_lights_are_found() {
        let (_, _, mirrors) = under_a_light(block());
        let lit: usize = mirrors.planes.iter().flat_map(|plane| plane.lit).map(usize::from).sum();
        assert_eq!(lit, 5);
        for plane in &mirrors.planes {
            assert!(!plane.lit[usize::from(plane.height(DVec3::new(0.3, 0.1, -0.2)) > 0.0)]);
        }
    }

    /// No point that sees a light in a mirror is told that it sees none there, each mirror is chosen as
    /// often as is told, and in all with certainty.
    #[test]
    fn what_may_show_a_light_is_chosen_as_often_as_told() {
        let (triangles, lights, mirrors) = under_a_light(block());
        let mut seen = 0;
        for i in 0..100_000 {
            let numbers = Stream::new(5, 0, i);
            let from = DVec3::from_array([0, 1, 2].map(|axis| 6.0 * numbers.uniform(axis) - 3.0));
            let images = || (0..mirrors.planes.len()).filter_map(|plane| mirrors.image_in(plane, from));
            let total: f64 = images().map(|image| image.choice_prob).sum();
            assert!(total == 0.0 || (total - 1.0).abs() < 1e-15);
            // As many strata as there are candidates, each of which is chosen once.
            let count = images().count();
            let chosen = (0..count).map(|k| {
                let u = || (k as f64 + numbers.uniform(3)) / count as f64;
                mirrors.choose(from, u).unwrap().plane
            });
            assert!(chosen.eq(images().map(|image| image.plane)));
            let Some(Light::Area(&AreaLight { triangle: light, .. }, _)) =
                lights.choose(from, numbers.uniform(4))
            else {
                panic!("the only lights are triangles");
            };
            let (u, v) = Triangle::sample_uniform(numbers.uniform_pair(5));
            let light = triangles.surface_point(light, u, v).position;
            for (plane, mirror) in mirrors.planes.iter().enumerate() {
                let toward = mirror.reflect(light - mirror.image_of(from));
                let shown = mirror.same_side(from, light) && mirror.is_hit_by(&Ray::new(from, toward));
                if shown && mirror.lit[usize::from(mirror.height(from) > 0.0)] {
                    seen += 1;
                    assert!(mirrors.image_in(plane, from).is_some(), "{from} {plane}");
                }
            }
        }
        assert!(seen > 1000, "{seen}");
    }

    #[test]
    fn a_point_in_a_mirrors_plane_has_no_image_in_it() {
        let (.., mirrors) = under_a_light([Triangle::new(Vec3::ZERO, Vec3::Z, Vec3::X)]);
        let at = |y: f64| mirrors.choose(DVec3::new(0.2, y, 0.2), || 0.5).map(|image| image.position.y);
        assert_eq!((at(0.0), at(1e-7), at(-1.0), at(1.0)), (None, None, None, Some(-1.0)));
    }
}
