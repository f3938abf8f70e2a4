use globillum::geom::Aabb;
use globillum::glam::DVec3;
use globillum::integrator::{Camera, Model, RenderError};
use globillum::material::Rgb;

/// Degrees from bottom to top, where nothing else is asked for.
const FIELD_OF_VIEW: f64 = 40.0;

/// Reads `from/to`, `from/to/up` or `from/to/up/degrees`.
pub fn parse_camera(text: &str) -> Result<Camera, String> {
    let parts: Vec<_> = text.split('/').collect();
    let (from, to, up, fov) = match parts[..] {
        [from, to] => (from, to, None, None),
        [from, to, up] => (from, to, Some(up), None),
        [from, to, up, fov] => (from, to, Some(up), Some(fov)),
        _ => return Err("wants two to four parts: from/to/up/degrees".into()),
    };
    let vector = |text| parse_numbers(text).map(DVec3::from_array);
    let fov = fov.map_or(Ok([FIELD_OF_VIEW]), parse_numbers)?[0];
    Camera::look_at(vector(from)?, vector(to)?, up.map_or(Ok(DVec3::Y), vector)?, fov.to_radians())
        .map_err(|error| error.to_string())
}

/// Reads `r,g,b`, or one number for a grey.
pub fn parse_colour(text: &str) -> Result<Rgb, String> {
    if text.contains(',') {
        parse_numbers(text).map(Rgb::from)
    } else {
        Ok(Rgb::splat(parse_numbers::<1>(text)?[0]))
    }
}

fn parse_numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let number = |word: &str| word.trim().parse().map_err(|_| format!("`{word}` is not a number"));
    let numbers = text.split(',').map(number).collect::<Result<Vec<f64>, _>>()?;
    numbers.try_into().map_err(|_| format!("`{text}` is not {N} numbers"))
}

/// A camera a little above and beside the scene that sees all of it, in a picture `aspect` times
/// as wide as high.
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
