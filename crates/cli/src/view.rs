//! Cameras and colours on the command line.

use globillum::geom::Aabb;
use globillum::glam::DVec3;
use globillum::integrator::{Camera, Model, RenderError};
use globillum::material::Rgb;

/// Degrees from bottom to top, where nothing else is asked for.
const FIELD_OF_VIEW: f64 = 40.0;

/// Parses a camera from `from/to`, `from/to/up` or `from/to/up/degrees`, with three coordinates each and the
/// vertical field of view in degrees; up is `0,1,0` and the field of view 40 degrees by default.
///
/// # Errors
/// What is wrong with it, in a few words.
pub fn parse_camera(text: &str) -> Result<Camera, String> {
    let parts: Vec<_> = text.split('/').collect();
    let (from, to, up, degrees) = match parts[..] {
        [from, to] => (from, to, None, None),
        [from, to, up] => (from, to, Some(up), None),
        [from, to, up, degrees] => (from, to, Some(up), Some(degrees)),
        _ => return Err("must have two to four parts: from/to/up/degrees".into()),
    };
    let vector = |text| parse_numbers(text).map(DVec3::from_array);
    let [degrees] = degrees.map_or(Ok([FIELD_OF_VIEW]), parse_numbers)?;
    let camera =
        Camera::look_at(vector(from)?, vector(to)?, up.map_or(Ok(DVec3::Y), vector)?, degrees.to_radians());
    camera.map_err(|error| match error {
        RenderError::Camera(reason) => reason.into(),
        RenderError::Param { .. } => "the field of view must be above 0 and below 180 degrees".into(),
        other => other.to_string(),
    })
}

/// Parses a radiance from `r,g,b`, or from one number for a grey.
///
/// # Errors
/// What is wrong with it, in a few words.
pub fn parse_colour(text: &str) -> Result<Rgb, String> {
    let numbers = match text.contains(',') {
        true => parse_numbers(text)?,
        false => [parse_numbers::<1>(text)?[0]; 3],
    };
    let valid = numbers.iter().all(|&x| x >= 0.0 && x.is_finite());
    if valid { Ok(Rgb::from(numbers)) } else { Err("each radiance must be 0 or a number above".into()) }
}

fn parse_numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let number = |word: &str| word.trim().parse().map_err(|_| format!("`{word}` is not a number"));
    let numbers = text.split(',').map(number).collect::<Result<Vec<f64>, _>>()?;
    numbers.try_into().map_err(|_| format!("`{text}` is not {N} numbers"))
}

/// A camera in front of `model`, a little above and to the right, that sees all of it in a picture `aspect`
/// times as wide as high.
///
/// # Errors
/// [`RenderError::Camera`] if the model has no extent, or one beyond what `f64` can hold.
pub fn of_all(model: &Model, aspect: f64) -> Result<Camera, RenderError> {
    let bounds = Aabb::around(model.triangles().iter().flat_map(|t| t.vertices));
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let (middle, radius) = ((min + max) / 2.0, (max - min).length() / 2.0);
    let half = (FIELD_OF_VIEW / 2.0).to_radians();
    let narrower = half.min((half.tan() * aspect).atan());
    let distance = radius / narrower.sin();
    let eye = middle + distance * DVec3::new(0.3, 0.2, 1.0).normalize();
    Camera::look_at(eye, middle, DVec3::Y, 2.0 * half)
}
