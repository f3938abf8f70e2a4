use crate::pixel_rect::PixelRect;
use crate::{Scene, Sensor};
use glam::{DVec2, DVec3};
use globillum_geom::{Accel, Triangle};
use rayon::prelude::*;

/// Places in the picture where the sensor sees points of lights, if nothing occludes them. Probes there find lights that are
/// smaller than the distance between other probes.
#[derive(Debug, Default)]
pub(super) struct LightPoints {
    /// In ascending order of their pixels, row by row.
    points: Vec<LightPoint>,
}

#[derive(Clone, Copy, Debug)]
struct LightPoint {
    column: u32,
    row: u32,
    /// From the upper left corner of its pixel, in pixels.
    offset: [f64; 2],
}

impl LightPoints {
    /// Of each triangle that emits, about one point for each pixel of its length in a picture of this size. In all, there are
    /// no more of them than pixels, or than triangles where these are more.
    pub(super) fn of(scene: &Scene<dyn Accel + '_>, sensor: &dyn Sensor, size: [u32; 2]) -> Self {
        let lights: Vec<u32> = scene.lights().triangles().collect();
        let projection = Projection { sensor, size: size.map(f64::from).into() };
        let pixels = size[0] as usize * size[1] as usize;
        let halvings = (pixels / lights.len().max(1)).max(1).ilog2();
        let of_light = |light: u32| {
            let mut points = Vec::new();
            let median = projection.median(scene.triangles().get(light));
            projection.add_points(median, halvings, &mut points);
            points
        };
        let mut points: Vec<LightPoint> = lights.into_par_iter().flat_map_iter(of_light).collect();
        points.par_sort_unstable_by_key(|point| (point.row, point.column));
        Self { points }
    }

    /// The points in a rectangle of pixels: the pixel, and the offset from its upper left corner in pixels.
    pub(super) fn within(&self, pixels: PixelRect) -> impl Iterator<Item = ((u32, u32), [f64; 2])> {
        let columns = pixels.x..pixels.x + pixels.width;
        let of_row = move |row| {
            let place =
                |column| self.points.partition_point(|point| (point.row, point.column) < (row, column));
            &self.points[place(columns.start)..place(columns.end)]
        };
        let rows = pixels.y..pixels.y + pixels.height;
        rows.flat_map(of_row).map(|point| ((point.column, point.row), point.offset))
    }
}

/// How the sensor projects points to the picture.
#[derive(Clone, Copy)]
struct Projection<'a> {
    sensor: &'a dyn Sensor,
    /// Width and height of the picture, in pixels.
    size: DVec2,
}

impl Projection<'_> {
    /// The median to the side that is shortest in the picture, or in space if the sensor does not see all corners.
    fn median(self, triangle: &Triangle) -> [DVec3; 2] {
        let corners = triangle.vertices.map(|v| v.as_dvec3());
        let [p, q, r] = corners.map(|corner| self.place(corner));
        let places = p.zip(q).zip(r).map(|((p, q), r)| [p, q, r]);
        let others = |i: usize| [(i + 1) % 3, (i + 2) % 3];
        let side = |i: usize| {
            let [a, b] = others(i);
            places.map_or(corners[a].distance(corners[b]), |places| places[a].distance(places[b]))
        };
        let from = if side(0) <= side(1).min(side(2)) { 0 } else { 1 + usize::from(side(2) < side(1)) };
        let [a, b] = others(from);
        [corners[from], 0.5 * (corners[a] + corners[b])]
    }

    /// Halves a segment until its parts are no longer than a pixel, but not more often than `halvings`. Adds the middles of
    /// the parts that the sensor may see.
    fn add_points(self, [from, to]: [DVec3; 2], halvings: u32, points: &mut Vec<LightPoint>) {
        let is_short = match (self.place(from), self.place(to)) {
            (Some(from), Some(to)) if self.are_beside(from, to) => return,
            (None, None) => return,
            (Some(from), Some(to)) => from.distance(to) <= 1.0,
            _ => false,
        };
        let middle = 0.5 * (from + to);
        if is_short || halvings == 0 {
            points.extend(self.place(middle).and_then(|place| self.light_point(place)));
        } else {
            self.add_points([from, middle], halvings - 1, points);
            self.add_points([middle, to], halvings - 1, points);
        }
    }

    /// Whether both places are beyond the same side of the picture.
    fn are_beside(self, a: DVec2, b: DVec2) -> bool {
        a.max(b).cmplt(DVec2::ZERO).any() || a.min(b).cmpgt(self.size).any()
    }

    /// Where the sensor sees `point`, in pixels from the upper left corner of the picture; `None` if it cannot tell.
    fn place(self, point: DVec3) -> Option<DVec2> {
        let position = self.sensor.project(point, self.size.x / self.size.y)?;
        let place = (DVec2::new(position.x, -position.y) + 1.0) * 0.5 * self.size;
        place.is_finite().then_some(place)
    }

    /// The point at this place; `None` outside the picture.
    fn light_point(self, place: DVec2) -> Option<LightPoint> {
        let is_inside = place.cmpge(DVec2::ZERO).all() && place.cmple(self.size).all();
        let corner = place.floor().min(self.size - 1.0);
        let (column, row) = (corner.x as u32, corner.y as u32);
        is_inside.then(|| LightPoint { column, row, offset: (place - corner).to_array() })
    }
}
