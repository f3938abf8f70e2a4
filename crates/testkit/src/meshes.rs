//! Meshes for measuring accelerators, each with a camera and a light position.

use crate::shapes::{cuboid, inside_out, quad, statue};
use glam::DVec3;
use globillum_geom::conformance::{Seeded, Source};
use globillum_geom::{GeomError, Triangle, Triangles};

/// A mesh with a camera and a light position.
#[derive(Clone, Debug)]
pub struct Subject {
    /// Its name.
    pub name: String,
    /// The mesh.
    pub triangles: Triangles,
    /// The origin of camera rays.
    pub eye: DVec3,
    /// The point in the middle of the picture.
    pub target: DVec3,
    /// Half the height of the field of view, relative to the distance.
    pub half_height: f64,
    /// The end of shadow rays.
    pub light: DVec3,
}

impl Subject {
    /// A mesh seen from in front of it.
    ///
    /// # Errors
    /// Those of [`Triangles::new`].
    pub fn new(name: impl Into<String>, mesh: Vec<Triangle>) -> Result<Self, GeomError> {
        let triangles = Triangles::new(mesh)?;
        let bounds = triangles.bounds();
        let empty = bounds.is_empty();
        let target = if empty { DVec3::ZERO } else { bounds.center() };
        let size = bounds.extent().max_element().max(f64::MIN_POSITIVE);
        let eye = target + DVec3::new(0.3, 0.2, 1.5) * size;
        let light = target + DVec3::new(0.8, 1.5, 0.9) * size;
        Ok(Self { name: name.into(), triangles, eye, target, half_height: 0.35, light })
    }

    fn seen(self, eye: DVec3, target: DVec3, half_height: f64, light: DVec3) -> Self {
        Self { eye, target, half_height, light, ..self }
    }
}

/// The procedural meshes: two statues, of about 70,000 and 100,000 triangles; a stadium; a hall.
///
/// # Errors
/// None: the meshes are good.
pub fn procedural() -> Result<Vec<Subject>, GeomError> {
    Ok(vec![
        Subject::new("statue-70k", statue(70_000).triangles())?,
        Subject::new("statue-100k", statue(100_000).triangles())?,
        stadium()?,
        hall()?,
    ])
}

/// A teapot in a stadium: a statue of 10,000 triangles and size 0.1 on a ground of two
/// triangles and size 10,000.
fn stadium() -> Result<Subject, GeomError> {
    let mut mesh = statue(10_000).placed(0.1, DVec3::Y * 0.1).triangles();
    let corner = |x: f64, z: f64| 5e3 * DVec3::new(x, 0.0, z);
    mesh.extend(quad(corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)));
    let (eye, target, light) = (DVec3::new(0.1, 0.3, 0.4), DVec3::Y * 0.1, DVec3::new(0.2, 0.8, 0.3));
    Ok(Subject::new("stadium", mesh)?.seen(eye, target, 0.35, light))
}

/// A hall with columns and furniture, everything aligned with the axes: about 50,000 triangles.
fn hall() -> Result<Subject, GeomError> {
    let half = DVec3::new(30.0, 6.0, 20.0);
    let mut mesh: Vec<Triangle> = inside_out(cuboid(DVec3::Y * half.y, half, 0.0)).to_vec();
    let mut source = Seeded::new(1);
    let mut add = |center: DVec3, half: DVec3| mesh.extend(cuboid(center, half, 0.0));
    for (x, z) in (0..12).flat_map(|x| (0..8).map(move |z| (x, z))) {
        let foot = DVec3::new(-27.5 + 5.0 * f64::from(x), 0.0, -17.5 + 5.0 * f64::from(z));
        add(foot + DVec3::Y * 0.2, DVec3::new(0.6, 0.2, 0.6));
        add(foot + DVec3::Y * 6.0, DVec3::new(0.4, 5.6, 0.4));
        add(foot + DVec3::Y * 11.8, DVec3::new(0.6, 0.2, 0.6));
        // A shelf between this column and the next: boards, and books on each.
        for board in 0..4 {
            let height = 0.5 + 0.6 * f64::from(board);
            add(foot + DVec3::new(2.5, height, 0.0), DVec3::new(1.5, 0.02, 0.2));
            for book in 0..10 {
                let tall = 0.15 + 0.1 * source.unit();
                let place = DVec3::new(1.2 + 0.28 * f64::from(book), height + 0.02 + tall, 0.0);
                add(foot + place, DVec3::new(0.03 + 0.08 * source.unit(), tall, 0.18));
            }
        }
    }
    let (eye, target, light) = (DVec3::new(-28.0, 5.0, 16.0), DVec3::new(5.0, 1.0, -4.0), DVec3::Y * 11.0);
    Ok(Subject::new("hall", mesh)?.seen(eye, target, 0.6, light))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_meshes_are_of_the_size_they_say() {
        let counts: Vec<usize> = procedural().unwrap().iter().map(|s| s.triangles.live().len()).collect();
        for (count, expected) in counts.into_iter().zip([70_000, 100_000, 10_000, 54_000]) {
            assert!(count.abs_diff(expected) < expected / 20, "{count} instead of {expected}");
        }
    }
}
