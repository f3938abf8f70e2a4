//! Films on which both accelerators of [`RENDERED`] agree.

use globillum::integrator::{Film, Model, PinholeCamera, Settings, render};
use globillum_testkit::accelerators::RENDERED;
use globillum_testkit::scenes::scene;

/// The film of a model, rendered with the first of [`RENDERED`].
///
/// # Panics
/// If the model is not valid, or if four samples per pixel have other bits with the other one. A comparison
/// of bits needs fewer samples than a mean.
pub(crate) fn film_by_both(model: &Model, camera: &PinholeCamera, settings: &Settings) -> Film {
    let [(_, first), others @ ..] = RENDERED.map(|(name, build)| (name, scene(model, build)));
    let film = |scene, settings| render(scene, camera, settings).expect("the scene is good").film;
    let mut few = *settings;
    few.samples = few.samples.min(4);
    let expected = film(&first, &few);
    for (name, other) in &others {
        assert_eq!(film(other, &few), expected, "the {name} gives another picture");
    }
    film(&first, settings)
}
