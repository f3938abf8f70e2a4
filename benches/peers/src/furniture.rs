//! Furniture of the apartment, large and small.

use globillum::geom::Triangle;
use globillum::glam::DVec3;
use globillum::integrator::Stream;
use globillum_testkit::shapes::{Mesh, cuboid, icosphere, quad, torus};
use std::f64::consts::TAU;

/// Base and wall cabinets along the wall `x = 0`, with doors and handles.
pub(crate) fn cabinets() -> Vec<Triangle> {
    let mut triangles = cuboid(DVec3::new(0.32, 0.9, 2.5), DVec3::new(0.32, 0.02, 2.4), 0.0);
    for (height, depth, tall) in [(0.46, 0.29, 0.42), (1.75, 0.17, 0.35)] {
        for unit in 0..8 {
            let z = 0.4 + 0.6 * f64::from(unit);
            let (body, front) = (DVec3::new(depth, height, z), 2.0 * depth);
            triangles.extend(cuboid(body, DVec3::new(depth, tall, 0.298), 0.0));
            let door = DVec3::new(front + 0.01, height, z);
            triangles.extend(cuboid(door, DVec3::new(0.009, tall - 0.005, 0.293), 0.0));
            let handle = DVec3::new(front + 0.04, height + 0.6 * tall, z);
            triangles.extend(cuboid(handle, DVec3::new(0.006, 0.006, 0.08), 0.0));
            for end in [-0.07, 0.07] {
                let foot = handle + DVec3::new(-0.01, 0.0, end);
                triangles.extend(cuboid(foot, DVec3::new(0.012, 0.004, 0.004), 0.0));
            }
        }
    }
    triangles.extend(crockery(DVec3::new(0.3, 0.92, 0.5), 16, 0.25));
    triangles
}

/// Boards along the wall `z = 0`, full of crockery.
pub(crate) fn shelves() -> Vec<Triangle> {
    let mut triangles = Vec::new();
    for board in 0..4_u32 {
        let height = 1.05 + 0.35 * f64::from(board);
        triangles.extend(cuboid(DVec3::new(2.5, height, 0.13), DVec3::new(1.4, 0.012, 0.13), 0.0));
        for item in 0..12_u32 {
            let foot = DVec3::new(1.25 + 0.23 * f64::from(item), height + 0.012, 0.13);
            triangles.extend(vessel(foot, Stream::new(3, board.into(), item)));
        }
    }
    triangles
}

/// A table with a bowl of fruit and six places laid.
pub(crate) fn table() -> Vec<Triangle> {
    let mut triangles = cuboid(DVec3::new(2.2, 0.74, 2.5), DVec3::new(0.5, 0.02, 0.9), 0.0);
    for (x, z) in [(1.75, 1.65), (1.75, 3.35), (2.65, 1.65), (2.65, 3.35)] {
        triangles.extend(cuboid(DVec3::new(x, 0.36, z), DVec3::new(0.03, 0.36, 0.03), 0.0));
    }
    let on_table = |x, z| DVec3::new(x, 0.76, z);
    for (x, z) in [(1.95, 1.9), (1.95, 2.5), (1.95, 3.1), (2.45, 1.9), (2.45, 2.5), (2.45, 3.1)] {
        triangles.extend(lathe(
            on_table(x, z),
            &[(0.05, 0.0), (0.12, 0.015), (0.115, 0.02), (0.04, 0.004)],
            32,
        ));
        triangles
            .extend(vessel(on_table(x, z + 0.17), Stream::new(4, (100.0 * x) as u64, (100.0 * z) as u32)));
    }
    triangles.extend(lathe(on_table(2.2, 2.2), &[(0.06, 0.0), (0.14, 0.08), (0.13, 0.08), (0.05, 0.01)], 32));
    for fruit in 0..9_u32 {
        let angle = 2.4 * f64::from(fruit);
        let place = on_table(2.2, 2.2)
            + DVec3::new(0.07 * angle.cos(), 0.06 + 0.012 * f64::from(fruit), 0.07 * angle.sin());
        triangles.extend(icosphere(2).placed(0.035, place).triangles());
    }
    triangles
}

/// A chair with a back of slats.
pub(crate) fn chair(foot: DVec3, yaw: f64) -> Vec<Triangle> {
    let turned = |x: f64, y: f64, z: f64| {
        let (sin, cos) = yaw.sin_cos();
        foot + DVec3::new(cos * x + sin * z, y, cos * z - sin * x)
    };
    let mut triangles = cuboid(turned(0.0, 0.45, 0.0), DVec3::new(0.21, 0.015, 0.21), yaw);
    for (x, z) in [(-0.19, -0.19), (0.19, -0.19), (-0.19, 0.19), (0.19, 0.19)] {
        triangles.extend(cuboid(turned(x, 0.22, z), DVec3::new(0.018, 0.22, 0.018), yaw));
    }
    for slat in 0..7 {
        let x = -0.18 + 0.06 * f64::from(slat);
        triangles.extend(cuboid(turned(x, 0.7, -0.2), DVec3::new(0.012, 0.24, 0.008), yaw));
    }
    triangles.extend(cuboid(turned(0.0, 0.95, -0.2), DVec3::new(0.21, 0.03, 0.012), yaw));
    triangles
}

/// A window in the wall `x = 4.2` behind a blind of 60 slats.
pub(crate) fn blind() -> Vec<Triangle> {
    let mut triangles = Vec::new();
    for slat in 0..60 {
        let height = 1.0 + 0.02 * f64::from(slat);
        let corner = |x: f64, y: f64, z: f64| DVec3::new(4.1 + x, height + y, z);
        let [a, b] = [(-0.01, 0.008), (0.01, -0.008)];
        triangles.extend(quad(
            corner(a.0, a.1, 1.2),
            corner(b.0, b.1, 1.2),
            corner(b.0, b.1, 2.8),
            corner(a.0, a.1, 2.8),
        ));
    }
    triangles
}

/// A row of vessels along z.
fn crockery(foot: DVec3, count: u32, apart: f64) -> Vec<Triangle> {
    let place = |item| foot + DVec3::Z * (apart * f64::from(item));
    (0..count).flat_map(|item| vessel(place(item), Stream::new(2, 0, item))).collect()
}

/// A cup with its handle, a bottle, or a pile of plates.
pub(crate) fn vessel(foot: DVec3, stream: Stream) -> Vec<Triangle> {
    let size = 0.8 + 0.4 * stream.uniform(1);
    let scaled =
        |profile: &[(f64, f64)]| profile.iter().map(|(r, y)| (r * size, y * size)).collect::<Vec<_>>();
    let pick = stream.uniform(0);
    if pick < 0.5 {
        let cup = [(0.025, 0.0), (0.035, 0.02), (0.04, 0.08), (0.037, 0.08), (0.03, 0.02), (0.001, 0.01)];
        let ring: Mesh = torus(20, 10).placed(0.02 * size, foot + DVec3::new(0.05, 0.045, 0.0) * size);
        let mut triangles = lathe(foot, &scaled(&cup), 32);
        triangles.extend(ring.triangles());
        triangles
    } else if pick < 0.75 {
        let bottle = [
            (0.001, 0.0),
            (0.04, 0.005),
            (0.04, 0.14),
            (0.03, 0.18),
            (0.012, 0.21),
            (0.012, 0.27),
            (0.001, 0.27),
        ];
        lathe(foot, &scaled(&bottle), 40)
    } else {
        let plate = |i: u32| {
            let foot = foot + DVec3::Y * (0.012 * f64::from(i) * size);
            lathe(foot, &scaled(&[(0.04, 0.0), (0.1, 0.012), (0.095, 0.016), (0.03, 0.005)]), 32)
        };
        (0..5).flat_map(plate).collect()
    }
}

/// The surface that `profile`, points of a radius and a height above `foot`, sweeps around the vertical axis.
pub(crate) fn lathe(foot: DVec3, profile: &[(f64, f64)], segments: u32) -> Vec<Triangle> {
    let at = |(radius, height): (f64, f64), segment: u32| {
        let angle = TAU * f64::from(segment % segments) / f64::from(segments);
        foot + DVec3::new(radius * angle.cos(), height, radius * angle.sin())
    };
    let band = |pair: &[(f64, f64)]| {
        let (low, high) = (pair[0], pair[1]);
        let face = move |i| quad(at(low, i), at(high, i), at(high, i + 1), at(low, i + 1));
        (0..segments).flat_map(face).collect::<Vec<_>>()
    };
    profile.windows(2).flat_map(band).collect()
}

/// Boards along z from `foot` up, each full of books that lean at random.
pub(crate) fn bookcase(foot: DVec3, rows: u32, books: u32) -> Vec<Triangle> {
    let mut triangles = Vec::new();
    let half = 0.02 * f64::from(books);
    for row in 0..rows {
        let height = foot.y + 0.1 + 0.4 * f64::from(row);
        triangles.extend(cuboid(
            DVec3::new(foot.x, height, foot.z),
            DVec3::new(0.15, 0.015, half + 0.05),
            0.0,
        ));
        for book in 0..books {
            let stream = Stream::new(1, row.into(), book);
            let size = DVec3::new(0.1, 0.1 + 0.06 * stream.uniform(0), 0.015);
            let z = foot.z - half + 0.02 + 0.04 * f64::from(book);
            let center = DVec3::new(foot.x, height + 0.015 + size.y, z);
            triangles.extend(cuboid(center, size, 0.1 * (stream.uniform(1) - 0.5)));
        }
    }
    triangles
}

/// A sheet that hangs in folds from `top`, along `across`.
pub(crate) fn curtain(top: DVec3, across: DVec3, height: f64) -> Vec<Triangle> {
    let (columns, rows) = (120, 30);
    let fold = across.cross(DVec3::Y).normalize();
    let at = |i: u32, j: u32| {
        let (s, t) = (f64::from(i) / f64::from(columns), f64::from(j) / f64::from(rows));
        let depth = (0.02 + 0.04 * t) * (9.0 * TAU * s + 2.0 * t).sin();
        top + s * across - t * height * DVec3::Y + depth * fold
    };
    let cell = |(i, j): (u32, u32)| quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    (0..columns).flat_map(|i| (0..rows).map(move |j| (i, j))).flat_map(cell).collect()
}

/// A pot of earth with bent leaves.
pub(crate) fn plant(foot: DVec3, leaves: u32, seed: u64) -> Vec<Triangle> {
    let pot = [(0.001, 0.0), (0.14, 0.0), (0.18, 0.3), (0.16, 0.3), (0.15, 0.26), (0.001, 0.26)];
    let mut triangles = lathe(foot, &pot, 32);
    for leaf in 0..leaves {
        let stream = Stream::new(seed, 0, leaf);
        let angle = TAU * stream.uniform(0);
        let (out, side) =
            (DVec3::new(angle.cos(), 0.0, angle.sin()), DVec3::new(-angle.sin(), 0.0, angle.cos()));
        let (length, rise, base) =
            (0.15 + 0.3 * stream.uniform(1), 0.2 + 0.8 * stream.uniform(2), 0.26 + 0.5 * stream.uniform(3));
        let at = |t: f64| foot + (base + rise * length * (t - t * t) * 2.0) * DVec3::Y + (length * t) * out;
        let width = |t: f64| 0.08 * length * (TAU / 2.0 * t).sin() + 0.002;
        for step in 0..6 {
            let (s, t) = (f64::from(step) / 6.0, f64::from(step + 1) / 6.0);
            let (a, b) = (at(s) - width(s) * side, at(s) + width(s) * side);
            triangles.extend(quad(a, b, at(t) + width(t) * side, at(t) - width(t) * side));
        }
    }
    triangles
}

/// A sofa or a bed: a base, a back and cushions along x.
pub(crate) fn upholstery(center: DVec3, half: DVec3, cushions: u32) -> Vec<Triangle> {
    let mut triangles = cuboid(center, half, 0.0);
    let back = DVec3::new(half.x, 0.4, 0.08);
    triangles.extend(cuboid(center + DVec3::new(0.0, half.y + 0.2, half.z), back, 0.0));
    let width = half.x / f64::from(cushions);
    for cushion in 0..cushions {
        let x = -half.x + width * f64::from(2 * cushion + 1);
        let place = center + DVec3::new(x, half.y + 0.06, half.z - 0.25);
        let soft = icosphere(4).placed(1.0, DVec3::ZERO).triangles();
        let size = DVec3::new(0.95 * width, 0.07, 0.22).as_vec3();
        triangles.extend(soft.into_iter().map(|triangle| {
            let [a, b, c] = triangle.vertices.map(|v| v * size + place.as_vec3());
            Triangle::new(a, b, c)
        }));
    }
    triangles
}
