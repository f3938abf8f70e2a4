use crate::guide::Guide;
use crate::light::Receiver;
use crate::path::path_vertex::PathVertex;
use glam::DVec3;
use globillum_geom::decide::Shear;
use globillum_geom::{Frame, Ray, SurfacePoint, Triangles};

/// A vertex at which a prefix ends or a suffix begins, or a mirror between them.
#[derive(Clone, Copy, Debug)]
pub(in crate::path) struct ReuseVertex {
    pub(in crate::path) point: SurfacePoint,
    /// Unit normal on the path's side.
    pub(in crate::path) normal: DVec3,
    /// The cell of the guide, if there is one.
    guide_cell: Option<u32>,
}

/// A suffix, as prefixes find it.
#[derive(Clone, Copy, Debug)]
pub(in crate::path) enum Suffix {
    /// It begins at the diffuse vertex `start`.
    Surface {
        start: ReuseVertex,
        /// The vertex on the mirror triangle by way of which prefixes find the start; `None` if they find it directly.
        mirror: Option<ReuseVertex>,
    },
    /// It is the environment, in this unit direction.
    Environment(DVec3),
}

impl ReuseVertex {
    #[inline(always)]
    pub(in crate::path) fn at(vertex: &PathVertex<'_>) -> Self {
        let guide_cell = vertex.guide_cell.map(|cell| cell.index);
        Self { point: vertex.at.point, normal: vertex.frame.normal, guide_cell }
    }

    /// What receives light.
    pub(in crate::path) fn receiver(&self) -> Receiver {
        Receiver { position: self.point.position, normal: self.normal.as_vec3() }
    }

    /// How many times as dense as cosine sampling the guide makes `direction`.
    #[inline(always)]
    pub(in crate::path) fn guide_ratio(&self, guide: Option<&Guide>, direction: DVec3) -> f64 {
        let Some((guide, cell)) = guide.zip(self.guide_cell) else { return 1.0 };
        guide.cell(cell).directions.ratio(Frame::around(self.normal).to_local(direction))
    }

    /// The unit direction toward another point.
    #[inline(always)]
    pub(in crate::path) fn direction_to(&self, point: &SurfacePoint) -> DVec3 {
        (point.position - self.point.position).normalize()
    }

    /// The density, times pi, with which cosine sampling from here finds a suffix, and the direction in which it does, of
    /// any length: per area at its start, or per solid angle if it is the environment. `None` if the start is not in front
    /// of this vertex or this vertex not in front of the start, as seen in the mirror if there is one; if one of them is
    /// behind the mirror; and if the density is not a normal number.
    ///
    /// By way of a mirror, it is the density directly from the image of this vertex: reflection keeps lengths and angles.
    #[inline(always)]
    pub(super) fn density_at(&self, suffix: &Suffix) -> Option<(f64, DVec3)> {
        let (start, mirror) = match suffix {
            Suffix::Surface { start, mirror } => (start, mirror),
            &Suffix::Environment(direction) => {
                let cosine = self.normal.dot(direction);
                return (cosine > 0.0 && cosine.is_normal()).then_some((cosine, direction));
            }
        };
        let between = start.point.position - self.point.position;
        let (between, direction) = match mirror {
            None => (between, between),
            Some(mirror) => {
                let height = |of: &Self| mirror.normal.dot(of.point.position - mirror.point.position);
                let [here, there] = [height(self), height(start)];
                if !(here > 0.0 && there > 0.0) {
                    return None;
                }
                (between + 2.0 * here * mirror.normal, between - 2.0 * there * mirror.normal)
            }
        };
        let [near, far] = [self.normal.dot(direction), -start.normal.dot(between)];
        let square = between.length_squared();
        let density = (near / square) * (far / square);
        (near > 0.0 && far > 0.0 && density.is_normal()).then_some((density, direction))
    }

    /// Adds the rays by which this vertex finds a suffix in `direction`, if they are unoccluded, and returns their number.
    /// It is 0 if the direction leads past the mirror triangle, and if a cosine is zero up to rounding.
    #[inline(always)]
    pub(super) fn push_rays(
        &self,
        triangles: &Triangles,
        suffix: &Suffix,
        direction: DVec3,
        rays: &mut Vec<Ray>,
    ) -> usize {
        match suffix {
            Suffix::Environment(direction) => {
                rays.push(self.point.spawn_ray(*direction));
                1
            }
            Suffix::Surface { start, mirror: None } => {
                let Some(segment) = self.point.segment_to(&start.point) else { return 0 };
                rays.push(segment);
                1
            }
            Suffix::Surface { start, mirror: Some(mirror) } => {
                let Some(point) = self.point_seen(triangles, mirror.point.triangle, direction) else {
                    return 0;
                };
                let Some(to_mirror) = self.point.segment_to(&point) else { return 0 };
                let Some(from_mirror) = point.segment_to(&start.point) else { return 0 };
                rays.push(to_mirror);
                rays.push(from_mirror);
                2
            }
        }
    }

    /// Where the line in `direction` meets the triangle `index`, decided as for any ray.
    #[inline(always)]
    fn point_seen(&self, triangles: &Triangles, index: u32, direction: DVec3) -> Option<SurfacePoint> {
        let hit = Shear::new(&self.point.spawn_ray(direction))?.decide(triangles.get(index))?;
        Some(triangles.surface_point(index, hit.u, hit.v))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Stream;
    use glam::Vec3;
    use globillum_geom::Triangle;
    use globillum_material::{Bsdf, Reflectance};

    /// Cells along each side of the target.
    const CELLS: usize = 4;

    fn at(point: SurfacePoint, normal: DVec3) -> ReuseVertex {
        ReuseVertex { point, normal, guide_cell: None }
    }

    /// A vertex that looks up, a mirror above it that leans, and a square that the mirror shows whole: its corner and the two
    /// sides that span it.
    struct Setup {
        triangles: Triangles,
        from: ReuseVertex,
        mirror: ReuseVertex,
        corner: DVec3,
        sides: [DVec3; 2],
    }

    impl Setup {
        fn new() -> Self {
            let mirror = Triangle::new(
                Vec3::new(-8.0, -6.0, 1.5),
                Vec3::new(8.0, -6.0, 2.5),
                Vec3::new(0.0, 10.0, 3.0),
            );
            let triangles = Triangles::new(vec![mirror]).unwrap();
            let point = triangles.surface_point(0, 0.3, 0.2);
            let normal = -point.normal.z.signum() * point.normal;
            let from = at(triangles.given_point(DVec3::ZERO, DVec3::Z), DVec3::Z);
            let sides = [DVec3::new(1.2, 0.1, -0.3), DVec3::new(0.2, 1.5, 0.2)];
            Self { triangles, from, mirror: at(point, normal), corner: DVec3::new(0.4, 0.2, -0.5), sides }
        }

        fn normal(&self) -> DVec3 {
            self.sides[0].cross(self.sides[1]).normalize()
        }

        /// The point of the square at these coordinates.
        fn start(&self, [a, b]: [f64; 2]) -> ReuseVertex {
            let position = self.corner + a * self.sides[0] + b * self.sides[1];
            at(self.triangles.given_point(position, self.normal()), self.normal())
        }

        /// The coordinates at which the square's plane is met by way of the mirror in `direction`.
        fn shown(&self, direction: DVec3) -> [f64; 2] {
            let meet = |from: DVec3, along: DVec3, of: DVec3, normal: DVec3| {
                from + normal.dot(of - from) / normal.dot(along) * along
            };
            let n = self.mirror.normal;
            let reflecting = meet(self.from.point.position, direction, self.mirror.point.position, n);
            let reflected = direction - 2.0 * n.dot(direction) * n;
            let offset = meet(reflecting, reflected, self.corner, self.normal()) - self.corner;
            let [a, b] = self.sides;
            let area = a.cross(b);
            [offset.cross(b).dot(area), a.cross(offset).dot(area)].map(|x| x / area.length_squared())
        }
    }

    /// Cosine sampling reaches each cell of the square by way of the mirror as often as the density says. The sum of squares
    /// exceeds the limit with a probability of 1e-6.
    #[test]
    fn the_density_by_way_of_a_mirror_is_that_of_cosine_sampling() {
        let setup = Setup::new();
        let white = Bsdf::Lambert(Reflectance::ONE);
        let samples = 200_000;
        let mut counts = [[0_u32; CELLS]; CELLS];
        for i in 0..samples {
            let u = Stream::new(1, 0, i).uniform_pair(0);
            let sample = white.sample(DVec3::Z, u).unwrap();
            let [a, b] = setup.shown(sample.wi).map(|x| (x * CELLS as f64).floor());
            if (0.0..CELLS as f64).contains(&a) && (0.0..CELLS as f64).contains(&b) {
                counts[a as usize][b as usize] += 1;
            }
        }
        let steps = 16;
        let area = setup.sides[0].cross(setup.sides[1]).length() / ((CELLS * steps) as f64).powi(2);
        let mut sum = 0.0;
        for (i, j) in (0..CELLS).flat_map(|i| (0..CELLS).map(move |j| (i, j))) {
            let mut share = 0.0;
            for (k, l) in (0..steps).flat_map(|k| (0..steps).map(move |l| (k, l))) {
                let at = |cell, step| ((cell * steps + step) as f64 + 0.5) / (CELLS * steps) as f64;
                let start = setup.start([at(i, k), at(j, l)]);
                let suffix = Suffix::Surface { start, mirror: Some(setup.mirror) };
                let (density, direction) = setup.from.density_at(&suffix).unwrap();
                share += density / std::f64::consts::PI * area;
                let mut rays = Vec::new();
                assert_eq!(setup.from.push_rays(&setup.triangles, &suffix, direction, &mut rays), 2);
                let lengths = rays.iter().map(|ray| ray.direction.length()).sum::<f64>();
                assert!((lengths / direction.length() - 1.0).abs() < 1e-6, "{lengths}");
                let shown = setup.shown(direction);
                assert!(
                    (shown[0] - at(i, k)).abs() < 1e-5 && (shown[1] - at(j, l)).abs() < 1e-5,
                    "{shown:?}"
                );
            }
            let expected = share * samples as f64;
            assert!(expected > 100.0, "{expected}");
            sum += (f64::from(counts[i][j]) - expected).powi(2) / expected;
        }
        // Sixteen degrees of freedom.
        assert!(sum < 58.5, "{sum}");
    }

    #[test]
    fn nothing_is_found_behind_a_mirror_or_past_it() {
        let setup = Setup::new();
        let start = setup.start([0.5, 0.5]);
        let by = |from: &ReuseVertex, mirror: &ReuseVertex, start: &ReuseVertex| {
            let suffix = Suffix::Surface { start: *start, mirror: Some(*mirror) };
            let (_, direction) = from.density_at(&suffix)?;
            Some(from.push_rays(&setup.triangles, &suffix, direction, &mut Vec::new()))
        };
        assert_eq!(by(&setup.from, &setup.mirror, &start), Some(2));
        let behind = at(setup.triangles.given_point(DVec3::Z * 5.0, -DVec3::Z), -DVec3::Z);
        assert_eq!(by(&behind, &setup.mirror, &start), None, "the end is behind the mirror");
        assert_eq!(by(&setup.from, &setup.mirror, &behind), None, "the start is behind the mirror");
        let back = ReuseVertex { normal: -setup.mirror.normal, ..setup.mirror };
        assert_eq!(by(&setup.from, &back, &start), None, "both are at the back of the mirror");
        let aside = at(setup.triangles.given_point(DVec3::X * 60.0, DVec3::Z), DVec3::Z);
        assert_eq!(by(&aside, &setup.mirror, &start), Some(0), "past its edges");
    }
}
