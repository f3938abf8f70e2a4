use super::any_camera::{AnyCamera, CameraType};
use super::axes::Up;
use super::outside::FIELD_OF_VIEW;
use globillum::glam::DVec3;
use globillum::integrator::{OrthographicCamera, PinholeCamera, RenderError, SphericalCamera};
use globillum::material::{Emission, Rgb};

/// The largest coordinate and size of a camera. The origins of its rays are then within
/// [`Ray::MAX_ORIGIN`](globillum::geom::Ray::MAX_ORIGIN), also at the edge of the widest picture.
const FARTHEST: f64 = 1e60;

/// Parses a camera from `from/to`, `from/to/up` or `from/to/up/degrees`, with three coordinates each and the
/// vertical field of view in degrees; the up vector is that of `up` and the field of view 40 degrees by
/// default. Coordinates are at most 1e60 in magnitude, so that rays can be traced.
///
/// # Errors
/// What is wrong with it, in a few words.
pub fn parse_camera(text: &str, up: Up) -> Result<PinholeCamera, String> {
    let CameraParts { eye, target, up, size } =
        CameraParts::parse(text, up, "two to four parts: from/to/up/degrees")?;
    let degrees = size.unwrap_or(FIELD_OF_VIEW);
    let range = "the field of view must be above 0 and below 180 degrees";
    PinholeCamera::look_at(eye, target, up, degrees.to_radians()).map_err(|error| reason(error, range))
}

/// Parses a camera of any type. The fourth part of an orthographic one is its height in units of length, at most 1e60; by
/// default it shows as much where it looks as a pinhole camera. A spherical one has no fourth part.
pub(crate) fn parse_any_camera(text: &str, up: Up, camera_type: CameraType) -> Result<AnyCamera, String> {
    match camera_type {
        CameraType::Pinhole => parse_camera(text, up).map(AnyCamera::Pinhole),
        CameraType::Orthographic => {
            let CameraParts { eye, target, up, size } =
                CameraParts::parse(text, up, "two to four parts: from/to/up/height")?;
            let at_target = || 2.0 * eye.distance(target) * (0.5 * FIELD_OF_VIEW.to_radians()).tan();
            let range = "the height must be a number above 0, at most 1e60";
            if size.is_some_and(|height| height > FARTHEST) {
                return Err(range.into());
            }
            let camera = OrthographicCamera::look_at(eye, target, up, size.unwrap_or_else(at_target));
            let camera = camera.map_err(|error| reason(error, range))?;
            Ok(AnyCamera::Orthographic(camera))
        }
        CameraType::Spherical => {
            let form = "two or three parts: from/to/up";
            let CameraParts { eye, target, up, size } = CameraParts::parse(text, up, form)?;
            if size.is_some() {
                return Err(format!("must have {form}"));
            }
            let camera = SphericalCamera::look_at(eye, target, up).map_err(|error| reason(error, ""))?;
            Ok(AnyCamera::Spherical(camera))
        }
    }
}

/// What is wrong with a camera, one of whose numbers has this `range`.
fn reason(error: RenderError, range: &str) -> String {
    match error {
        RenderError::Camera(reason) => reason.into(),
        RenderError::Param { .. } => range.into(),
        other => other.to_string(),
    }
}

/// The parts of a camera on the command line.
struct CameraParts {
    eye: DVec3,
    target: DVec3,
    up: DVec3,
    /// The fourth part.
    size: Option<f64>,
}

impl CameraParts {
    /// Parses the parts; `form` says how many there are, and which.
    fn parse(text: &str, up: Up, form: &str) -> Result<Self, String> {
        let parts: Vec<_> = text.split('/').collect();
        let (from, to, own_up, size) = match parts[..] {
            [from, to] => (from, to, None, None),
            [from, to, up] => (from, to, Some(up), None),
            [from, to, up, size] => (from, to, Some(up), Some(size)),
            _ => return Err(format!("must have {form}")),
        };
        let vector = |text| {
            let vector = DVec3::from_array(parse_numbers(text)?);
            let is_near = vector.abs().cmple(DVec3::splat(FARTHEST)).all();
            if is_near {
                Ok(vector)
            } else {
                Err(format!("each coordinate must be from -{FARTHEST:e} to {FARTHEST:e}"))
            }
        };
        let up = own_up.map_or(Ok(up.axes().y_axis), vector)?;
        let size = size.map(parse_numbers).transpose()?.map(|[size]| size);
        Ok(Self { eye: vector(from)?, target: vector(to)?, up, size })
    }
}

/// The camera in the notation of [`parse_any_camera`], with a target as far away as `near`. The error of a number is at
/// most five millionths of that distance, and of the number.
pub(crate) fn format_camera(camera: &AnyCamera, near: DVec3) -> String {
    // Rays through the middle and the upper edge.
    let (middle, above) = match camera {
        AnyCamera::Pinhole(camera) => (camera.ray(0.0, 0.0, 1.0), camera.ray(0.0, 1.0, 1.0)),
        AnyCamera::Orthographic(camera) => (camera.ray(0.0, 0.0, 1.0), camera.ray(0.0, 1.0, 1.0)),
        AnyCamera::Spherical(camera) => (camera.ray(0.0, 0.0), camera.ray(0.0, 1.0)),
    };
    let (up, size) = match camera {
        AnyCamera::Pinhole(_) => {
            let up = above.direction - middle.direction;
            (up, Some(2.0 * up.length().atan().to_degrees()))
        }
        AnyCamera::Orthographic(_) => {
            let up = above.origin - middle.origin;
            (up, Some(2.0 * up.length()))
        }
        AnyCamera::Spherical(_) => (above.direction, None),
    };
    // From the very middle of a scene any target is as good.
    let distance = Some(near.distance(middle.origin)).filter(|&distance| distance > 0.0).unwrap_or(1.0);
    let target = middle.at(distance / middle.direction.length());
    let [from, to] = [middle.origin, target].map(|point| format_vector(point, distance));
    // The angle of a wide field of view counts by what it lacks of 180 degrees.
    let resolution = |size: f64| if size < 180.0 { size.min(180.0 - size) } else { size };
    let size = size.map(|size| format!("/{}", short(size, resolution(size)))).unwrap_or_default();
    format!("{from}/{to}/{}{size}", format_vector(up.normalize(), 1.0))
}

/// Coordinates with an error of at most five millionths of themselves, and of the size of what they describe; 0 for those
/// that are rounding errors in things of this size.
pub(crate) fn format_vector(v: DVec3, size: f64) -> String {
    v.to_array().map(|x| short(if x.abs() < 1e-9 * size { 0.0 } else { x }, size)).join(",")
}

/// A number to six digits, without zeros at its end; to more if it is large beside `size`, so that its error is not.
fn short(x: f64, size: f64) -> String {
    let more = (x.abs() / size).log10().ceil().clamp(0.0, 11.0) as usize;
    let digits = 5 + more;
    format!("{x:.digits$e}").parse().map_or_else(|_| x.to_string(), |x: f64| (x + 0.0).to_string())
}

/// Parses a radiance from `r,g,b`, or from one number for a grey, within the range that [`Emission`] allows.
///
/// # Errors
/// What is wrong with it, in a few words.
pub fn parse_colour(text: &str) -> Result<Rgb, String> {
    let numbers = match text.contains(',') {
        true => parse_numbers(text)?,
        false => [parse_numbers::<1>(text)?[0]; 3],
    };
    let (radiance, [least, most]) = (Rgb::from(numbers), [Emission::MIN_RADIANCE, Emission::MAX_RADIANCE]);
    let is_allowed = Emission::allows(radiance);
    if is_allowed {
        Ok(radiance)
    } else {
        Err(format!("each radiance must be 0 or from {least:e} to {most:e}"))
    }
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
            let camera = AnyCamera::Pinhole(parse_camera(text, Up::Y).expect("it is well-formed"));
            let to: Vec<f64> =
                text.split('/').nth(1).expect("a target").split(',').flat_map(str::parse).collect();
            assert_eq!(format_camera(&camera, DVec3::from_slice(&to)), text);
        }
    }

    #[test]
    fn cameras_of_other_types_are_formatted_as_they_are_parsed() {
        for (camera_type, text) in [
            (CameraType::Orthographic, "1,2.5,-3/1,2.5,4/0,1,0/12.5"),
            (CameraType::Spherical, "0.25,100,7/0.25,100,-50/0,1,0"),
        ] {
            let camera = parse_any_camera(text, Up::Y, camera_type).expect("it is well-formed");
            let to: Vec<f64> =
                text.split('/').nth(1).expect("a target").split(',').flat_map(str::parse).collect();
            assert_eq!(format_camera(&camera, DVec3::from_slice(&to)), text);
        }
        let parse =
            |text: &str, camera_type| parse_any_camera(text, Up::Y, camera_type).expect_err("it is bad");
        for text in ["0,0,1", "0,0,1/0,0,0/0,1,0/40", "0,0,1/0,0,0/0,1,0/40/9"] {
            let expected = "must have two or three parts: from/to/up";
            assert_eq!(parse(text, CameraType::Spherical), expected, "{text}");
        }
        assert!(parse("0,0,1/0,0,0/0,1,0/0", CameraType::Orthographic).contains("height"));
        let high =
            parse_any_camera("0,0,5/0,0,0", Up::Y, CameraType::Orthographic).expect("it is well-formed");
        assert_eq!(format_camera(&high, DVec3::ZERO), "0,0,5/0,0,0/0,1,0/3.6397");
    }

    /// Whatever the place of the scene, the printed camera shows the same picture.
    #[test]
    fn a_camera_far_from_the_origin_keeps_its_direction() {
        for (place, distance) in [(0.0, 3.0), (123_456.0, 0.5), (1e6, 2.0), (-1e9, 7.0), (1e12, 0.25)] {
            let eye = DVec3::new(place, place, place + distance);
            for degrees in [1e-3, 40.0, 179.9999] {
                let aside = DVec3::new(0.3 * distance, -0.2 * distance, -distance);
                let camera = PinholeCamera::look_at(eye, eye + aside, DVec3::Y, f64::to_radians(degrees));
                let camera = camera.expect("it is one");
                let text = format_camera(&AnyCamera::Pinhole(camera), DVec3::splat(place));
                let parsed = parse_camera(&text, Up::Y).expect("it is well-formed");
                let [given, again] = [camera, parsed].map(|camera| camera.ray(0.4, 0.7, 1.5));
                // The errors of three coordinates, and what a coordinate can resolve.
                let margin = (9e-6 * distance).max(4.0 * f64::EPSILON * place.abs());
                assert!((given.origin - again.origin).length() <= margin, "{text}");
                let apart = given.direction.normalize() - again.direction.normalize();
                assert!(apart.length() * distance <= margin, "{text}: {apart}");
            }
        }
    }

    #[test]
    fn rounding_errors_are_not_shown() {
        let camera =
            parse_any_camera("1e-12,3,5/0,1e-12,0", Up::Y, CameraType::Pinhole).expect("it is well-formed");
        assert_eq!(format_camera(&camera, DVec3::ZERO), "0,3,5/0,0,0/0,0.857493,-0.514496/40");
    }

    #[test]
    fn numbers_beyond_what_can_be_traced_are_refused() {
        let parse = |text: &str, camera_type| parse_any_camera(text, Up::Y, camera_type).map(|_| ());
        let coordinate = Err("each coordinate must be from -1e60 to 1e60".into());
        for text in ["1e300,0,1/0,0,0", "0,0,1/0,-1.1e60,0", "0,0,1/0,0,0/0,inf,0", "0,nan,1/0,0,0"] {
            assert_eq!(parse(text, CameraType::Pinhole), coordinate, "{text}");
        }
        assert_eq!(parse("1e60,0,1/0,0,0", CameraType::Pinhole), Ok(()));
        let height = |height: f64| parse(&format!("0,1,0/0,0,0/0,0,1/{height:e}"), CameraType::Orthographic);
        assert_eq!(height(1e60), Ok(()));
        assert_eq!(height(1e300), Err("the height must be a number above 0, at most 1e60".into()));
        assert_eq!(["1e50", "1e-50,0,0"].map(|text| parse_colour(text).is_ok()), [true; 2]);
        for text in ["1e60", "0,1e-60,0", "-1", "nan", "inf"] {
            assert_eq!(
                parse_colour(text),
                Err("each radiance must be 0 or from 1e-50 to 1e50".into()),
                "{text}"
            );
        }
    }

    #[test]
    fn up_is_the_default_of_the_up_vector() {
        let [y, z] = [Up::Y, Up::Z].map(|up| parse_camera("1,2,3/4,6,5", up));
        assert_eq!(y, parse_camera("1,2,3/4,6,5/0,1,0/40", Up::Z));
        assert_eq!(z, parse_camera("1,2,3/4,6,5/0,0,1/40", Up::Y));
        assert_ne!(y, z);
    }
}
