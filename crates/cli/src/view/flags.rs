use super::axes::Up;
use super::outside::FIELD_OF_VIEW;
use globillum::glam::DVec3;
use globillum::integrator::{Camera, RenderError};
use globillum::material::Rgb;

/// Parses a camera from `from/to`, `from/to/up` or `from/to/up/degrees`, with three coordinates each and the
/// vertical field of view in degrees; the up vector is that of `up` and the field of view 40 degrees by
/// default.
///
/// # Errors
/// What is wrong with it, in a few words.
pub fn parse_camera(text: &str, up: Up) -> Result<Camera, String> {
    let parts: Vec<_> = text.split('/').collect();
    let (from, to, own_up, degrees) = match parts[..] {
        [from, to] => (from, to, None, None),
        [from, to, up] => (from, to, Some(up), None),
        [from, to, up, degrees] => (from, to, Some(up), Some(degrees)),
        _ => return Err("must have two to four parts: from/to/up/degrees".into()),
    };
    let vector = |text| parse_numbers(text).map(DVec3::from_array);
    let up = own_up.map_or(Ok(up.axes().y_axis), vector)?;
    let [degrees] = degrees.map_or(Ok([FIELD_OF_VIEW]), parse_numbers)?;
    let camera = Camera::look_at(vector(from)?, vector(to)?, up, degrees.to_radians());
    camera.map_err(|error| match error {
        RenderError::Camera(reason) => reason.into(),
        RenderError::Param { .. } => "the field of view must be above 0 and below 180 degrees".into(),
        other => other.to_string(),
    })
}

/// The camera in the notation of [`parse_camera`], to six digits, with a target as far away as `near`.
pub(crate) fn format_camera(camera: &Camera, near: DVec3) -> String {
    let ray = camera.ray(0.0, 0.0, 1.0);
    let up = camera.ray(0.0, 1.0, 1.0).direction - ray.direction;
    let distance = near.distance(ray.origin);
    let target = ray.at(distance / ray.direction.length());
    let [from, to] = [ray.origin, target].map(|point| format_vector(point, distance));
    let degrees = 2.0 * up.length().atan().to_degrees();
    format!("{from}/{to}/{}/{}", format_vector(up.normalize(), 1.0), short(degrees))
}

/// Coordinates to six digits each; 0 for those that are rounding errors in things of this size.
pub(crate) fn format_vector(v: DVec3, size: f64) -> String {
    v.to_array().map(|x| short(if x.abs() < 1e-9 * size { 0.0 } else { x })).join(",")
}

/// A number to six digits, without zeros at its end.
fn short(x: f64) -> String {
    format!("{x:.5e}").parse().map_or_else(|_| x.to_string(), |x: f64| (x + 0.0).to_string())
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_is_formatted_as_it_is_parsed() {
        for text in ["1,2.5,-3/1,2.5,4/0,1,0/40", "0.25,100,7/0.25,50,7/0,0,1/90", "0,0,5/0,0,0/1,0,0/12.5"] {
            let camera = parse_camera(text, Up::Y).expect("it is well-formed");
            let to: Vec<f64> =
                text.split('/').nth(1).expect("a target").split(',').flat_map(str::parse).collect();
            assert_eq!(format_camera(&camera, DVec3::from_slice(&to)), text);
        }
    }

    #[test]
    fn rounding_errors_are_not_shown() {
        let camera = parse_camera("1e-12,3,5/0,1e-12,0", Up::Y).expect("it is well-formed");
        assert_eq!(format_camera(&camera, DVec3::ZERO), "0,3,5/0,0,0/0,0.857493,-0.514496/40");
    }

    #[test]
    fn up_is_the_default_of_the_up_vector() {
        let [y, z] = [Up::Y, Up::Z].map(|up| parse_camera("1,2,3/4,6,5", up));
        assert_eq!(y, parse_camera("1,2,3/4,6,5/0,1,0/40", Up::Z));
        assert_eq!(z, parse_camera("1,2,3/4,6,5/0,0,1/40", Up::Y));
        assert_ne!(y, z);
    }
}
