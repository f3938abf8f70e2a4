//! Rays a second of irradiance at points, beside those of a camera: `cargo bench --bench irradiance`.
//!
//! The renders take turns, and the medians are printed. Before that, the irradiance of a list in another order must
//! be the same to the bit.
#![allow(clippy::print_stdout, reason = "a bench prints its results")]

use globillum::geom::{Accel, WideBvh};
use globillum::glam::DVec3;
use globillum::integrator::{
    IrradiancePoints, Model, PathReuse, Reading, Scene, Sensor, Settings, Stream, render,
};
use globillum_testkit::cornell;
use globillum_testkit::shapes::statue;
use std::time::Instant;

/// Side of the picture, so that it has about as many pixels as there are points.
const SIDE: u32 = 316;
const POINTS: u32 = 100_000;
const SAMPLES: u32 = 16;
/// Renders of each kind.
const TURNS: usize = 7;

/// Points at random on the walls, the floor and the ceiling of the box, which face inward.
fn on_walls() -> Vec<(DVec3, DVec3)> {
    let place = |i| {
        let numbers = Stream::new(7, 0, i);
        let [u, v] = [0, 1].map(|axis| 2.0 * numbers.uniform(axis) - 1.0);
        let side = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z][i as usize % 5];
        let (right, up) = side.any_orthonormal_pair();
        (0.999 * (u * right + v * up - side), side)
    };
    (0..POINTS).map(place).collect()
}

/// Rays a second of one render.
fn speed(scene: &Scene<dyn Accel + '_>, sensor: &dyn Sensor, settings: &Settings) -> f64 {
    let start = Instant::now();
    let picture = render(scene, sensor, settings).expect("scene and sensor are good");
    picture.counters.rays() as f64 / start.elapsed().as_secs_f64()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() {
    // `-- --test` checks the answers only.
    let turns = if std::env::args().any(|flag| flag == "--test") { 0 } else { TURNS };
    let camera = cornell::camera().expect("the camera is good");
    let with_statue = cornell::with_mesh(&statue(70_000).triangles(), false);
    for (name, model) in [("box", cornell::with_blocks(false)), ("box with a statue", with_statue)] {
        let model: Model = model.expect("the box is good");
        let scene = Scene::build(model, WideBvh::build).expect("the box is good");
        let mut list = on_walls();
        let points = IrradiancePoints::new(list.iter().copied()).expect("they are within the domain");
        let readings = |points: &IrradiancePoints| -> Vec<Reading> {
            let picture = render(&scene, points, &points.settings(1)).expect("all is good");
            points.readings(&picture.film).collect()
        };
        let mut in_order = readings(&points);
        in_order.reverse();
        list.reverse();
        let reversed = IrradiancePoints::new(list).expect("they are within the domain");
        assert!(readings(&reversed) == in_order, "{name}: the order of the list changes irradiance");

        let mut speeds = [const { Vec::new() }; 3];
        for _ in 0..turns {
            let mut settings = Settings::new(SIDE, SIDE, SAMPLES);
            speeds[0].push(speed(&scene, &camera, &settings));
            settings.path_reuse = PathReuse::Off;
            speeds[1].push(speed(&scene, &camera, &settings));
            speeds[2].push(speed(&scene, &points, &points.settings(SAMPLES)));
        }
        if turns > 0 {
            let [reuse, camera, points] = speeds.map(|speeds| median(speeds) / 1e6);
            println!(
                "{name}: points {points:.2}, camera {camera:.2}, with path reuse {reuse:.2} million rays/s"
            );
        }
    }
}
