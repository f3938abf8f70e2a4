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
    /// Of each triangle that emits, one point for each pixel of its length in a picture of this size. In all, there are no
    /// more of them than pixels or triangles.
    pub(super) fn of(scene: &Scene<dyn Accel + '_>, sensor: &dyn Sensor, size: [u32; 2]) -> Self {
        let lights: Vec<u32> = scene.lights().triangles().collect();
        let projection = Projection { sensor, size: size.map(f64::from).into() };
        let most = size.map(f64::from).iter().product::<f64>() / lights.len() as f64;
        let of_light = |light: u32| projection.points_of(scene.triangles().get(light), most);
        let mut points: Vec<LightPoint> = lights.into_par_iter().flat_map_iter(of_light).collect();
        points.par_sort_by_key(|point| (point.row, point.column));
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
    /// Points of a triangle, evenly spaced along its median to the side that is shortest in the picture: one for each pixel,
    /// but no more than `most`, or one. None if the sensor cannot tell where it sees the corners.
    fn points_of(self, triangle: &Triangle, most: f64) -> impl Iterator<Item = LightPoint> {
        let corners = triangle.vertices.map(|v| v.as_dvec3());
        let medians = [[0, 1, 2], [1, 2, 0], [2, 0, 1]].map(|order| {
            let [from, a, b] = order.map(|i| corners[i]);
            let [end, p, q] = [self.place(from)?, self.place(a)?, self.place(b)?];
            Some((p.distance(q), end.distance(0.5 * (p + q)), [from, 0.5 * (a + b)]))
        });
        let shortest = medians.into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0));
        shortest.into_iter().flat_map(move |(_, length, [from, to])| {
            let count = length.ceil().min(most).max(1.0) as u32;
            let at = move |i: u32| from.lerp(to, (f64::from(i) + 0.5) / f64::from(count));
            (0..count).filter_map(move |i| self.light_point(self.place(at(i))?))
        })
    }

    /// Where the sensor sees `point`, in pixels from the upper left corner of the picture; `None` if it cannot tell.
    fn place(self, point: DVec3) -> Option<DVec2> {
        let position = self.sensor.project(point, self.size.x / self.size.y)?;
        let place = (DVec2::new(position.x, -position.y) + 1.0) * 0.5 * self.size;
        place.is_finite().then_some(place)
    }

    /// The point at this place; `None` outside the picture.
    fn light_point(self, place: DVec2) -> Option<LightPoint> {
        let corner = place.floor();
        let is_inside = corner.cmpge(DVec2::ZERO).all() && corner.cmplt(self.size).all();
        let (column, row) = (corner.x as u32, corner.y as u32);
        is_inside.then(|| LightPoint { column, row, offset: (place - corner).to_array() })
    }
}
