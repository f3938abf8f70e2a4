use super::tree::{FarLight, LightMoments, TreeLight};
use crate::DeltaLightError;
use glam::{DAffine3, DVec3, Vec3};
use globillum_geom::Triangle;
use globillum_material::{Emission, Rgb};
use std::f64::consts::FRAC_PI_2;

/// A light without extent: a point, spot or directional light. [`Model::add_delta_light`] adds one to a model.
///
/// No ray hits it, so the camera does not see it, and only next event estimation finds it. Mirrors do not
/// show it, and there are no caustics of it: diffuse surfaces get its light directly and by way of other
/// diffuse surfaces, but not by way of mirrors.
///
/// Each component of an intensity or irradiance is 0 or within [`Emission::MIN_RADIANCE`] and
/// [`Emission::MAX_RADIANCE`]. Coordinates of a position are at most [`Triangle::MAX_COORDINATE`] in
/// magnitude.
///
/// ```
/// use glam::Vec3;
/// use globillum_integrator::{DeltaLight, Model};
/// use globillum_material::Rgb;
///
/// let mut model = Model::default();
/// model.add_delta_light(DeltaLight::point(Vec3::Y, Rgb::splat(20.0))?);
/// model.add_delta_light(DeltaLight::spot(Vec3::Y, -Vec3::Y, Rgb::splat(5.0), 0.2, 0.4)?);
/// model.add_delta_light(DeltaLight::directional(-Vec3::Y, Rgb::splat(3.0))?);
/// assert_eq!(model.delta_lights().len(), 3);
/// # Ok::<(), globillum_integrator::DeltaLightError>(())
/// ```
///
/// [`Model::add_delta_light`]: crate::Model::add_delta_light
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeltaLight(Kind);

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Point { position: Vec3, intensity: Rgb },
    Spot { position: Vec3, axis: DVec3, intensity: Rgb, cone: Cone },
    Directional { direction: DVec3, irradiance: Rgb },
}

/// A delta light chosen by [`LightSampler::sample`](crate::LightSampler::sample). Its direction is certain, so no
/// density per steradian exists.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct DeltaLightSample {
    /// Where the light is; `None` if it is infinitely far away.
    pub position: Option<DVec3>,
    /// Unit direction from the receiver, world frame.
    pub direction: DVec3,
    /// Irradiance on a plane perpendicular to the direction if the light is visible; not black.
    pub irradiance: Rgb,
    /// The probability of choosing the light, above zero.
    pub choice_prob: f64,
}

impl DeltaLight {
    /// A light at `position` that emits `intensity`, in power per steradian, in all directions.
    ///
    /// At distance `r` its irradiance on a plane perpendicular to the direction is `intensity / r^2`, and 0 at
    /// `position` itself.
    ///
    /// # Errors
    /// [`DeltaLightError`] for a position or an intensity out of range.
    pub fn point(position: Vec3, intensity: Rgb) -> Result<Self, DeltaLightError> {
        let position = valid_position(position.as_dvec3())?;
        Ok(Self(Kind::Point { position, intensity: valid_value(intensity)? }))
    }

    /// A light at `position` that emits within a cone around `direction`, of any length.
    ///
    /// `inner` and `outer` are angles in radians between the axis and the side of the cone, with
    /// `0 <= inner < outer <= pi / 2` (`outer` also as `pi / 2` rounded to `f32`). At the angle `a` from the
    /// axis, the light emits `intensity` times
    ///
    /// ```text
    /// clamp((cos a - cos outer) / max(0.001, cos inner - cos outer), 0, 1)^2
    /// ```
    ///
    /// in power per steradian (glTF 2.0, KHR_lights_punctual): all of it up to `inner`, none from `outer` on.
    /// By that formula a cone for which `1 - cos outer` is below 0.001 (2.6 degrees) is dimmer than `intensity`
    /// on its axis too.
    ///
    /// # Errors
    /// [`DeltaLightError`] for a position, a direction, angles or an intensity out of range, and for an
    /// `outer` whose cosine rounds to 1.
    pub fn spot(
        position: Vec3,
        direction: Vec3,
        intensity: Rgb,
        inner: f64,
        outer: f64,
    ) -> Result<Self, DeltaLightError> {
        Ok(Self(Kind::Spot {
            position: valid_position(position.as_dvec3())?,
            axis: valid_direction(direction.as_dvec3())?,
            intensity: valid_value(intensity)?,
            cone: Cone::new(inner, outer)?,
        }))
    }

    /// A light infinitely far away whose radiation travels along `direction`, of any length, with this
    /// `irradiance`, in power per area, on a plane perpendicular to it.
    ///
    /// # Errors
    /// [`DeltaLightError`] for a direction or an irradiance out of range.
    pub fn directional(direction: Vec3, irradiance: Rgb) -> Result<Self, DeltaLightError> {
        let direction = valid_direction(direction.as_dvec3())?;
        Ok(Self(Kind::Directional { direction, irradiance: valid_value(irradiance)? }))
    }

    /// Where the light is; `None` for a directional one.
    pub fn position(&self) -> Option<Vec3> {
        match self.0 {
            Kind::Point { position, .. } | Kind::Spot { position, .. } => Some(position),
            Kind::Directional { .. } => None,
        }
    }

    /// The unit vector along the axis of a spot light, or along which the radiation of a directional light travels; `None`
    /// for a point light.
    pub fn direction(&self) -> Option<DVec3> {
        match self.0 {
            Kind::Point { .. } => None,
            Kind::Spot { axis: direction, .. } | Kind::Directional { direction, .. } => Some(direction),
        }
    }

    /// The intensity of a point or spot light, in power per steradian, or the irradiance of a directional light, in power
    /// per area.
    pub fn value(&self) -> Rgb {
        let (Kind::Point { intensity: value, .. }
        | Kind::Spot { intensity: value, .. }
        | Kind::Directional { irradiance: value, .. }) = self.0;
        value
    }

    /// The light with another [value](DeltaLight::value).
    ///
    /// # Errors
    /// [`DeltaLightError`] for a value out of range.
    pub fn with_value(mut self, new: Rgb) -> Result<Self, DeltaLightError> {
        let (Kind::Point { intensity: value, .. }
        | Kind::Spot { intensity: value, .. }
        | Kind::Directional { irradiance: value, .. }) = &mut self.0;
        *value = valid_value(new)?;
        Ok(self)
    }

    /// The light after `transform`. Position and axis are transformed as points and vectors are, so a
    /// mirroring transform mirrors them. Intensity, irradiance and the angles of a cone stay.
    pub(crate) fn transformed(&self, transform: &DAffine3) -> Result<Self, DeltaLightError> {
        let moved = |position: Vec3| valid_position(transform.transform_point3(position.as_dvec3()));
        let turned = |direction: DVec3| valid_direction(transform.transform_vector3(direction));
        Ok(Self(match self.0 {
            Kind::Point { position, intensity } => Kind::Point { position: moved(position)?, intensity },
            Kind::Spot { position, axis, intensity, cone } => {
                Kind::Spot { position: moved(position)?, axis: turned(axis)?, intensity, cone }
            }
            Kind::Directional { direction, irradiance } => {
                Kind::Directional { direction: turned(direction)?, irradiance }
            }
        }))
    }

    /// What arrives at `from`. `None` if it is black: beyond a spot light's cone, or at the light itself.
    pub(crate) fn sample(&self, from: DVec3, choice_prob: f64) -> Option<DeltaLightSample> {
        let toward = |position: Vec3| {
            let between = position.as_dvec3() - from;
            let distance_sq = between.length_squared();
            (distance_sq > 0.0).then(|| (between / distance_sq.sqrt(), distance_sq))
        };
        let (position, direction, irradiance) = match self.0 {
            Kind::Point { position, intensity } => {
                let (direction, distance_sq) = toward(position)?;
                (Some(position.as_dvec3()), direction, intensity / distance_sq)
            }
            Kind::Spot { position, axis, intensity, cone } => {
                let (direction, distance_sq) = toward(position)?;
                let falloff = cone.falloff(-axis.dot(direction));
                (Some(position.as_dvec3()), direction, intensity * falloff / distance_sq)
            }
            Kind::Directional { direction, irradiance } => (None, -direction, irradiance),
        };
        let is_black = irradiance.is_black();
        (!is_black).then_some(DeltaLightSample { position, direction, irradiance, choice_prob })
    }

    /// Whether it emits nothing.
    pub(super) fn is_black(&self) -> bool {
        self.value().is_black()
    }

    /// The description of the light in a light tree.
    pub(super) fn tree_light(&self) -> TreeLight {
        match self.0 {
            Kind::Point { position, intensity } => {
                TreeLight::Near(LightMoments::of_point(position.as_dvec3(), intensity.luminance()))
            }
            Kind::Spot { position, axis, intensity, cone } => {
                // The falloff of a narrow cone is below 1 on the axis, too.
                let intensity = intensity.luminance() * cone.falloff(1.0);
                TreeLight::Near(LightMoments::of_spot(position.as_dvec3(), axis, cone.cos_outer, intensity))
            }
            Kind::Directional { direction, irradiance } => {
                TreeLight::Far(FarLight { irradiance: irradiance.luminance(), direction: -direction })
            }
        }
    }

    /// The numbers that determine the light.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = f64> {
        let (kind, position, direction, value, shape) = match self.0 {
            Kind::Point { position, intensity } => (0.0, position, DVec3::ZERO, intensity, [0.0; 2]),
            Kind::Spot { position, axis, intensity, cone } => {
                (1.0, position, axis, intensity, [cone.cos_outer, cone.width])
            }
            Kind::Directional { direction, irradiance } => (2.0, Vec3::ZERO, direction, irradiance, [0.0; 2]),
        };
        let vectors = [position.as_dvec3().to_array(), direction.to_array(), value.to_array()];
        std::iter::once(kind).chain(vectors.into_iter().flatten()).chain(shape)
    }
}

/// The directions in which a spot light emits.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cone {
    cos_outer: f64,
    /// The difference of cosines over which the intensity falls.
    width: f64,
}

impl Cone {
    fn new(inner: f64, outer: f64) -> Result<Self, DeltaLightError> {
        // libm gives the same bits on every platform.
        let [cos_inner, cos_outer] = [inner, outer.min(FRAC_PI_2)].map(libm::cos);
        let is_valid = inner >= 0.0
            && inner < outer
            && outer <= f64::from(std::f32::consts::FRAC_PI_2)
            && cos_outer < 1.0;
        let width = (cos_inner - cos_outer).max(0.001);
        if is_valid { Ok(Self { cos_outer, width }) } else { Err(DeltaLightError::Cone { inner, outer }) }
    }

    /// The share of the intensity at an angle of this cosine from the axis.
    fn falloff(&self, cos: f64) -> f64 {
        ((cos - self.cos_outer) / self.width).clamp(0.0, 1.0).powi(2)
    }
}

fn valid_position(position: DVec3) -> Result<Vec3, DeltaLightError> {
    let rounded = position.as_vec3();
    // Comparisons with NaN are false.
    let is_valid = rounded.abs().cmple(Vec3::splat(Triangle::MAX_COORDINATE)).all();
    // A negative zero equals a positive one and must have the same bits.
    if is_valid { Ok(rounded + Vec3::ZERO) } else { Err(DeltaLightError::Position(position)) }
}

/// The unit vector along `direction`.
fn valid_direction(direction: DVec3) -> Result<DVec3, DeltaLightError> {
    // Dividing by the largest component first keeps the square in range.
    let unit = (direction / direction.abs().max_element()).normalize() + DVec3::ZERO;
    if unit.is_finite() { Ok(unit) } else { Err(DeltaLightError::Direction(direction)) }
}

fn valid_value(value: Rgb) -> Result<Rgb, DeltaLightError> {
    if Emission::allows(value) { Ok(value) } else { Err(DeltaLightError::Value(value)) }
}
