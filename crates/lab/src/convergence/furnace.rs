//! Furnaces: closed rooms whose walls emit. Every path has the same, known radiance, so that each lost path
//! shows.

use globillum::glam::DVec3;
use globillum::integrator::{Estimator, PinholeCamera, render};
use globillum::material::Rgb;
use globillum_testkit::accelerators::Builder;
use globillum_testkit::furnace::truncated_series;
use globillum_testkit::scenes::{furnace, scene};
use globillum_testkit::stats::independent_pixels;

/// Counts of the paths of a furnace, and their mean radiance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Loss {
    /// The number of all paths.
    pub(crate) paths: u32,
    /// The number of paths whose radiance differs from the exact sum by a bit or more: they left the room, or
    /// met a wall from behind.
    pub(crate) lost: u32,
    /// The mean radiance.
    pub(crate) mean: f64,
}

/// Traces `side` squared paths of 64 bounces by BSDF sampling in a cubic furnace of albedo 0.8 with half side
/// `half` and center `center`. Their exact radiance is 5 to within a part in a million.
///
/// # Panics
/// If the furnace cannot be built or rendered.
pub(crate) fn loss(build: Builder, half: f64, center: DVec3, side: u32) -> Loss {
    const RHO: f64 = 0.8;
    const BOUNCES: u32 = 64;
    let eye = center + half * DVec3::new(0.1, 0.2, 0.3);
    let toward = half * DVec3::new(0.4, -0.3, 0.8);
    let up = toward.any_orthogonal_vector();
    let camera = PinholeCamera::look_at(eye, eye + toward, up, 2.5).expect("eye and target are apart");
    // One sample per pixel: a sum of several equal samples would be rounded.
    let mut settings = independent_pixels(side, side, 1);
    (settings.estimator, settings.max_bounces) = (Estimator::Bsdf, Some(BOUNCES));
    settings.roulette.start = u32::MAX;
    let scene = scene(&furnace(RHO, half, center), build);
    let film = render(&scene, &camera, &settings).expect("the scene is good").film;
    let truth = Rgb::splat(truncated_series(RHO, BOUNCES));
    let lost = film.means().filter(|&mean| mean != truth).count() as u32;
    Loss { paths: side * side, lost, mean: film.image_mean().g }
}

#[cfg(test)]
mod tests {
    use super::*;
    use globillum::geom::{Aabb, Accel, BruteForce, Hit, QueryCounter, Ray, Traverse};
    use globillum_testkit::accelerators::RENDERED;

    /// An accelerator that finds none of its triangles.
    #[derive(Debug)]
    struct Blind(BruteForce);

    impl Accel for Blind {
        fn intersect(&self, _: &Ray) -> Option<Hit> {
            None
        }

        fn occluded(&self, _: &Ray) -> bool {
            false
        }

        fn bounds(&self) -> Aabb {
            self.0.bounds()
        }

        fn bytes(&self) -> usize {
            self.0.bytes()
        }
    }

    impl Traverse for Blind {
        fn closest<C: QueryCounter>(&self, _: &Ray, _: &mut C) -> Option<Hit> {
            None
        }

        fn any<C: QueryCounter>(&self, _: &Ray, _: &mut C) -> bool {
            false
        }
    }

    #[test]
    fn a_furnace_loses_no_path_and_without_hits_all() {
        let kept = loss(RENDERED[0].1, 1e-3, DVec3::splat(1e3), 16);
        assert_eq!((kept.paths, kept.lost), (256, 0));
        assert!((kept.mean - 5.0).abs() < 1e-5, "{kept:?}");
        let blind: Builder = |triangles| Ok(Box::new(Blind(BruteForce::build(triangles))));
        assert_eq!(loss(blind, 1.0, DVec3::ZERO, 16), Loss { paths: 256, lost: 256, mean: 0.0 });
    }
}
