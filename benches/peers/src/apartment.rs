//! A furnished apartment: large plain surfaces, and between them many small things.

use crate::furniture::{
    blind, bookcase, cabinets, chair, curtain, lathe, plant, shelves, table, upholstery, vessel,
};
use crate::scenes::{Light, Scene, View};
use anyhow::Result;
use globillum::geom::{Triangle, Triangles};
use globillum::glam::{DVec3, Vec3};
use globillum::integrator::Stream;
use globillum_testkit::shapes::{cuboid, icosphere, statue, torus};

/// The rooms' height.
const HEIGHT: f64 = 2.6;
/// Half the thickness of walls, the floor and the ceiling.
const THICK: f64 = 0.05;
/// A door, from the floor up.
const DOOR: [f64; 2] = [0.0, 2.1];
/// A window, above a parapet.
const WINDOW: [f64; 2] = [0.9, 2.3];

/// The apartment as its kitchen's camera sees it, with the light at that ceiling and the kitchen's window.
pub(crate) fn kitchen() -> Result<Scene> {
    Ok(Scene {
        name: "kitchen".to_owned(),
        triangles: Triangles::new(apartment())?,
        view: View { eye: KITCHEN + p(3.8, 1.6, 4.6), target: KITCHEN + p(1.3, 0.95, 1.8), width: 4.2 },
        lights: vec![
            Light::facing_down(KITCHEN + p(2.0, 2.55, 2.5), [0.6, 0.6]),
            Light { center: p(10.3, 1.6, 2.0), edges: [1.4 * DVec3::Y, 1.6 * DVec3::Z] },
        ],
        is_interior: true,
    })
}

/// The same as seen in the living room, with the light at that ceiling and the large window.
pub(crate) fn living_room() -> Result<Scene> {
    Ok(Scene {
        name: "living-room".to_owned(),
        triangles: Triangles::new(apartment())?,
        view: View { eye: p(5.6, 1.6, 4.7), target: p(2.2, 0.9, 1.6), width: 5.0 },
        lights: vec![
            Light::facing_down(p(3.0, 2.55, 2.5), [1.2, 0.8]),
            Light { center: p(2.75, 1.6, 0.0), edges: [1.4 * DVec3::Y, 3.5 * DVec3::X] },
        ],
        is_interior: true,
    })
}

/// Where the kitchen's corner is.
const KITCHEN: DVec3 = DVec3::new(6.05, 0.0, 0.05);

fn p(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// Six rooms on 10.3 x 9.5 metres: living room, kitchen, corridor, bedroom, bath and study. 239,000 triangles.
fn apartment() -> Vec<Triangle> {
    let mut triangles = shell();
    triangles.extend(kitchen_furniture());
    triangles.extend(living_room_furniture());
    triangles.extend(bedroom_furniture());
    triangles.extend(bath_furniture());
    triangles.extend(study_furniture());
    triangles
}

/// An opening in a wall: from where to where along it, and from which height to which.
type Opening = ([f64; 2], [f64; 2]);

/// Floor, ceiling and walls.
fn shell() -> Vec<Triangle> {
    let middle = p(5.15, 0.0, 4.75);
    let slab = p(5.2, THICK, 4.8);
    let mut triangles = cuboid(middle - THICK * DVec3::Y, slab, 0.0);
    triangles.extend(cuboid(middle + (HEIGHT + THICK) * DVec3::Y, slab, 0.0));
    let (x, z) = (DVec3::X, DVec3::Z);
    triangles.extend(wall(p(0.0, 0.0, 0.0), 10.3 * x, &[([1.0, 4.5], WINDOW)]));
    triangles.extend(wall(p(0.0, 0.0, 9.5), 10.3 * x, &[([1.2, 3.2], WINDOW), ([8.0, 9.5], WINDOW)]));
    triangles.extend(wall(p(0.0, 0.0, 0.0), 9.5 * z, &[([5.2, 6.1], DOOR)]));
    triangles.extend(wall(p(10.3, 0.0, 0.0), 9.5 * z, &[([1.2, 2.8], WINDOW)]));
    triangles.extend(wall(p(6.0, 0.0, 0.0), 5.0 * z, &[([3.9, 4.8], DOOR)]));
    triangles.extend(wall(p(0.0, 0.0, 5.0), 10.3 * x, &[([4.6, 5.5], DOOR), ([8.0, 8.9], DOOR)]));
    triangles.extend(wall(
        p(0.0, 0.0, 6.3),
        10.3 * x,
        &[([3.2, 4.1], DOOR), ([5.4, 6.2], DOOR), ([7.4, 8.3], DOOR)],
    ));
    triangles.extend(wall(p(4.5, 0.0, 6.3), 3.2 * z, &[]));
    triangles.extend(wall(p(7.0, 0.0, 6.3), 3.2 * z, &[]));
    triangles
}

/// A wall from `corner` along `across`, an axis, with openings from left to right.
fn wall(corner: DVec3, across: DVec3, openings: &[Opening]) -> Vec<Triangle> {
    let (along, length) = (across.normalize(), across.length());
    let part = |[from, to]: [f64; 2], [low, high]: [f64; 2]| {
        let center = corner + 0.5 * (from + to) * along + 0.5 * (low + high) * DVec3::Y;
        let half = 0.5 * (to - from) * along + 0.5 * (high - low) * DVec3::Y;
        let across = DVec3::new(along.z, 0.0, along.x);
        cuboid(center, half + THICK * across, 0.0)
    };
    let (mut triangles, mut from) = (Vec::new(), 0.0);
    for &([left, right], [low, high]) in openings {
        triangles.extend(part([from, left], [0.0, HEIGHT]));
        if low > 0.0 {
            triangles.extend(part([left, right], [0.0, low]));
            // A mullion.
            let middle = 0.5 * (left + right);
            triangles.extend(part([middle - 0.02, middle + 0.02], [low, high]));
        }
        triangles.extend(part([left, right], [high, HEIGHT]));
        from = right;
    }
    triangles.extend(part([from, length], [0.0, HEIGHT]));
    triangles
}

/// The same triangles, moved.
fn moved(triangles: Vec<Triangle>, by: DVec3) -> impl Iterator<Item = Triangle> {
    let by: Vec3 = by.as_vec3();
    triangles.into_iter().map(move |triangle| {
        let [a, b, c] = triangle.vertices.map(|v| v + by);
        Triangle::new(a, b, c)
    })
}

fn kitchen_furniture() -> Vec<Triangle> {
    let mut triangles = [cabinets(), shelves(), table(), blind()].concat();
    for (x, z, yaw) in [(2.1, 1.7, 0.2), (2.2, 3.3, 3.0), (3.0, 2.2, 1.5), (2.95, 2.9, 1.7)] {
        triangles.extend(chair(p(x, 0.0, z), yaw));
    }
    moved(triangles, KITCHEN).collect()
}

fn living_room_furniture() -> Vec<Triangle> {
    let mut triangles = upholstery(p(1.8, 0.2, 3.9), p(1.1, 0.2, 0.45), 3);
    triangles.extend(upholstery(p(4.2, 0.2, 4.4), p(0.5, 0.2, 0.4), 1));
    triangles.extend(cuboid(p(2.0, 0.4, 2.4), p(0.6, 0.02, 0.35), 0.0));
    for (x, z) in [(1.5, 2.15), (2.5, 2.15), (1.5, 2.65), (2.5, 2.65)] {
        triangles.extend(cuboid(p(x, 0.19, z), p(0.02, 0.19, 0.02), 0.0));
    }
    for item in 0..5_u32 {
        let place = p(1.6 + 0.2 * f64::from(item), 0.42, 2.3 + 0.1 * f64::from(item % 3));
        triangles.extend(vessel(place, Stream::new(6, 0, item)));
    }
    triangles.extend(bookcase(p(0.25, 0.0, 2.0), 5, 60));
    triangles.extend(statue(30_000).placed(0.55, p(5.2, 0.75, 0.8)).triangles());
    triangles.extend(curtain(p(0.5, 2.4, 0.15), 0.8 * DVec3::X, 2.3));
    triangles.extend(curtain(p(4.3, 2.4, 0.15), 0.9 * DVec3::X, 2.3));
    triangles.extend(plant(p(0.6, 0.0, 0.7), 700, 7));
    triangles.extend(plant(p(5.5, 0.0, 2.4), 500, 8));
    // A rug's fringe.
    for thread in 0..300 {
        let x = 0.6 + 0.01 * f64::from(thread);
        triangles.extend(cuboid(p(x, 0.004, 1.5), p(0.002, 0.003, 0.03), 0.0));
    }
    triangles.extend(cuboid(p(2.1, 0.004, 2.5), p(1.5, 0.004, 0.97), 0.0));
    triangles
}

fn bedroom_furniture() -> Vec<Triangle> {
    let mut triangles = upholstery(p(2.2, 0.25, 8.2), p(0.9, 0.25, 1.05), 2);
    for x in [1.0, 3.4] {
        triangles.extend(cuboid(p(x, 0.25, 9.2), p(0.22, 0.25, 0.2), 0.0));
        triangles.extend(lathe(
            p(x, 0.5, 9.2),
            &[(0.08, 0.0), (0.02, 0.02), (0.02, 0.3), (0.15, 0.25), (0.1, 0.45)],
            40,
        ));
    }
    triangles.extend(cuboid(p(0.4, 1.1, 7.2), p(0.32, 1.1, 0.8), 0.0));
    triangles.extend(curtain(p(0.7, 2.4, 9.35), 0.7 * DVec3::X, 2.2));
    triangles.extend(curtain(p(3.0, 2.4, 9.35), 0.7 * DVec3::X, 2.2));
    triangles
}

fn bath_furniture() -> Vec<Triangle> {
    let mut triangles = cuboid(p(5.75, 0.28, 9.0), p(0.9, 0.28, 0.4), 0.0);
    triangles.extend(torus(160, 60).placed(0.3, p(5.2, 0.5, 7.4)).triangles());
    triangles.extend(lathe(
        p(6.6, 0.0, 7.6),
        &[(0.1, 0.0), (0.08, 0.6), (0.28, 0.85), (0.25, 0.85), (0.05, 0.75)],
        64,
    ));
    for item in 0..8_u32 {
        triangles.extend(vessel(p(4.8, 1.2, 6.9 + 0.2 * f64::from(item)), Stream::new(9, 0, item)));
    }
    triangles.extend(cuboid(p(4.8, 1.18, 7.6), p(0.12, 0.01, 0.85), 0.0));
    triangles
}

fn study_furniture() -> Vec<Triangle> {
    let mut triangles = bookcase(p(10.05, 0.0, 7.9), 6, 70);
    triangles.extend(bookcase(p(7.25, 0.0, 8.2), 6, 50));
    triangles.extend(cuboid(p(8.8, 0.73, 9.0), p(0.8, 0.02, 0.4), 0.0));
    triangles.extend(chair(p(8.7, 0.0, 8.3), 3.1));
    triangles.extend(icosphere(5).placed(0.18, p(9.3, 0.95, 9.1)).triangles());
    triangles.extend(plant(p(7.5, 0.0, 6.8), 500, 10));
    for item in 0..6_u32 {
        triangles.extend(vessel(p(8.2 + 0.15 * f64::from(item), 0.75, 8.9), Stream::new(11, 0, item)));
    }
    triangles
}
