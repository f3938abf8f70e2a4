//! Scenes that need no file.

use crate::scenes::{Light, Scene, View};
use anyhow::Result;
use globillum::geom::{Triangle, Triangles};
use globillum::glam::DVec3;
use globillum::integrator::Stream;
use globillum_testkit::shapes::{self, Mesh, cuboid, inside_out};

/// A closed room of 6 x 3 x 5 with statues, shelves and a table: a few large triangles and many small ones.
/// No ray leaves it.
pub(crate) fn room() -> Result<Scene> {
    let p = DVec3::new;
    let mut triangles = inside_out(cuboid(p(3.0, 1.5, 2.5), p(3.0, 1.5, 2.5), 0.0));
    let mut place = |mesh: Mesh, scale, offset| triangles.extend(mesh.placed(scale, offset).triangles());
    place(shapes::statue(21_000), 0.7, p(1.3, 1.0, 1.2));
    place(shapes::statue(18_000), 0.5, p(4.6, 0.7, 1.6));
    place(shapes::torus(60, 30), 0.3, p(3.0, 0.97, 2.2));
    place(shapes::icosphere(4), 0.25, p(3.6, 1.05, 2.0));
    place(shapes::icosphere(4), 0.4, p(2.2, 0.4, 3.0));
    triangles.extend(table(p(3.2, 0.8, 2.2)));
    triangles.extend(shelves(p(5.8, 0.0, 3.2)));
    Ok(Scene {
        name: "room".to_owned(),
        triangles: Triangles::new(triangles)?,
        view: View { eye: p(0.5, 1.7, 4.6), target: p(3.2, 1.1, 1.8), width: 4.5 },
        lights: vec![Light::facing_down(p(3.0, 2.95, 2.5), [1.2, 1.2])],
        is_interior: true,
    })
}

/// A table; `top` is the middle of its top.
fn table(top: DVec3) -> Vec<Triangle> {
    let board = cuboid(top, DVec3::new(0.9, 0.03, 0.6), 0.0);
    let legs = [(-0.8, -0.5), (-0.8, 0.5), (0.8, -0.5), (0.8, 0.5)].into_iter().flat_map(|(x, z)| {
        let half = top.y / 2.0;
        cuboid(DVec3::new(top.x + x, half, top.z + z), DVec3::new(0.03, half, 0.03), 0.0)
    });
    board.into_iter().chain(legs).collect()
}

/// Six boards along z from `foot` up, each full of books that lean at random.
fn shelves(foot: DVec3) -> Vec<Triangle> {
    let mut triangles = Vec::new();
    for row in 0..6_u32 {
        let height = foot.y + 0.1 + 0.4 * f64::from(row);
        let board = DVec3::new(foot.x, height, foot.z);
        triangles.extend(cuboid(board, DVec3::new(0.15, 0.015, 1.2), 0.0));
        for book in 0..60_u32 {
            let stream = Stream::new(1, row.into(), book);
            let half = DVec3::new(0.1, 0.1 + 0.06 * stream.uniform(0), 0.015);
            let z = foot.z - 1.15 + 0.039 * f64::from(book);
            let center = DVec3::new(foot.x, height + 0.015 + half.y, z);
            triangles.extend(cuboid(center, half, 0.1 * (stream.uniform(1) - 0.5)));
        }
    }
    triangles
}

/// A height field of `2 side^2` triangles over the unit square.
pub(crate) fn terrain(side: u32) -> Result<Scene> {
    let at = |x: u32, z: u32| {
        let [x, z] = [x, z].map(|i| f64::from(i) / f64::from(side));
        DVec3::new(x, height(x, z), z).as_vec3()
    };
    let row = |z: u32| (0..=side).map(move |x| at(x, z)).collect::<Vec<_>>();
    let rows: Vec<_> = (0..=side).map(row).collect();
    let cells = (0..side as usize).flat_map(|z| (0..side as usize).map(move |x| (x, z)));
    let split = |(x, z): (usize, usize)| {
        let [a, b, c, d] = [rows[z][x], rows[z + 1][x], rows[z + 1][x + 1], rows[z][x + 1]];
        Triangle::quad(a, b, c, d)
    };
    Ok(Scene {
        name: "terrain".to_owned(),
        triangles: Triangles::new(cells.flat_map(split).collect())?,
        view: View { eye: DVec3::new(0.55, 0.5, 1.2), target: DVec3::new(0.5, 0.1, 0.55), width: 0.7 },
        lights: vec![Light::facing_down(DVec3::new(0.9, 0.6, 0.2), [0.3, 0.3])],
        is_interior: false,
    })
}

/// Value noise in eight octaves, each twice as fine and about half as high.
fn height(x: f64, z: f64) -> f64 {
    (0..8)
        .map(|octave| {
            let scale = f64::from(4_u32 << octave);
            0.6 / scale * noise(octave, x * scale, z * scale)
        })
        .sum()
}

/// Random numbers at integer points, interpolated smoothly.
fn noise(octave: u32, x: f64, z: f64) -> f64 {
    let smooth = |t: f64| t * t * (3.0 - 2.0 * t);
    let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
    let [i, j] = [x, z].map(|c| c.floor() as u32);
    let [s, t] = [x.fract(), z.fract()].map(smooth);
    let value = |i: u32, j: u32| Stream::new(octave.into(), i.into(), j).uniform(0);
    mix(mix(value(i, j), value(i + 1, j), s), mix(value(i, j + 1), value(i + 1, j + 1), s), t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::PROCEDURAL;

    #[test]
    fn the_procedural_scenes_have_their_stated_sizes() {
        for (name, count) in PROCEDURAL.into_iter().zip([57_000_usize, 239_000, 239_000, 1_000_000, 70_000]) {
            let triangles = Scene::load(name).expect("it is procedural").triangles;
            assert!(triangles.len().abs_diff(count) < count / 50, "{name}: {}", triangles.len());
            assert_eq!(triangles.degenerate_count(), 0, "{name}");
        }
    }
}
