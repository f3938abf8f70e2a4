//! Furnaces: closed rooms whose walls shine, in which no path can gather less than all there is.

use globillum::glam::DVec3;
use globillum::integrator::{Camera, Estimator, render};
use globillum::material::Rgb;
use globillum_testkit::accelerators::Builder;
use globillum_testkit::furnace::truncated_series;
use globillum_testkit::scenes::{furnace, scene};
use globillum_testkit::stats::independent_pixels;

/// What became of the paths of a furnace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Loss {
    /// All of them.
    pub(crate) paths: u32,
    /// Those that did not gather what they should, to the bit: they left, or met a wall from behind.
    pub(crate) lost: u32,
    /// The mean radiance.
    pub(crate) mean: f64,
}

/// Paths of 64 bounces, by scattering alone, in a cubic furnace of albedo 0.8 whose half side is
/// `half`, around `center`; `side` squared of them. Their exact mean is 5 but for a part in a
/// million.
///
/// # Panics
/// If the furnace cannot be built or rendered.
pub(crate) fn loss(build: Builder, half: f64, center: DVec3, side: u32) -> Loss {
    const RHO: f64 = 0.8;
    const BOUNCES: u32 = 64;
    let eye = center + half * DVec3::new(0.1, 0.2, 0.3);
    let toward = half * DVec3::new(0.4, -0.3, 0.8);
    let up = toward.any_orthogonal_vector();
    let camera = Camera::look_at(eye, eye + toward, up, 2.5).expect("eye and target are apart");
    // One sample a pixel: the sum of several equal ones would be rounded.
    let mut settings = independent_pixels(side, side, 1);
    (settings.estimator, settings.max_bounces) = (Estimator::Bsdf, Some(BOUNCES));
    settings.roulette.start = u32::MAX;
    let scene = scene(&furnace(RHO, half, center), build);
    let film = render(&scene, &camera, &settings, &()).expect("the scene is good").film;
    let truth = Rgb::splat(truncated_series(RHO, BOUNCES));
    let lost = film.means().filter(|&mean| mean != truth).count() as u32;
    Loss { paths: side * side, lost, mean: film.image_mean().g }
}

#[cfg(test)]
mod tests {
    use super::*;
    use globillum::geom::Triangles;
    use globillum_testkit::accelerators::{ACCELERATORS, STRUCTURES};

    #[test]
    fn a_furnace_keeps_its_paths_and_a_room_without_walls_none() {
        let kept = loss(STRUCTURES[0].1, 1e-3, DVec3::splat(1e3), 16);
        assert_eq!((kept.paths, kept.lost), (256, 0));
        assert!((kept.mean - 5.0).abs() < 1e-5, "{kept:?}");
        let nothing: Builder = |_| ACCELERATORS[0].1(&Triangles::new(Vec::new())?);
        assert_eq!(loss(nothing, 1.0, DVec3::ZERO, 16), Loss { paths: 256, lost: 256, mean: 0.0 });
    }
}
