use super::sample::{ElementSample, PathStart, Sensor};
use crate::error::PointError;
use crate::{Film, Settings};
use glam::DVec3;
use globillum_geom::Triangles;
use globillum_material::Rgb;
use std::hash::Hasher;

/// A list of points with unit normals, each of which measures irradiance: the integral of radiance times cosine over
/// the hemisphere around its normal.
///
/// The unit is pi steradians times that of radiance: W/m^2 in each component if lights have W/(m^2 sr), and lux if
/// they are given in photometric units (lumen, candela, cd/m^2). Points may lie on surfaces
/// ([`PathStart::Irradiance`]); those on none measure what comes through the air.
///
/// The points are a grid of one column, in their order. Their paths are never reused: neighbours in a list need not
/// be near to each other, so few suffixes would be of use to another point, and errors of points would be correlated.
/// Points that follow each other in space are traced faster than points at random.
///
/// Irradiance at ten points of a floor under a square light, to one percent:
///
/// ```
/// use glam::{DVec3, Vec3};
/// use globillum_geom::{Triangle, WideKdTree};
/// use globillum_integrator::{IrradiancePoints, Model, Render, Scene, Stop};
/// use globillum_material::{Material, Rgb};
///
/// let mut model = Model::default();
/// let [a, b, c, d] = [(-1, -1), (1, -1), (1, 1), (-1, 1)].map(|(x, z)| Vec3::new(x as f32, 1.0, z as f32));
/// model.add(Material::light(Rgb::splat(10.0))?, [Triangle::new(a, b, c), Triangle::new(a, c, d)]);
/// let scene = Scene::build(model, WideKdTree::build)?;
///
/// let points = IrradiancePoints::new((0..10).map(|i| (DVec3::X * 0.1 * f64::from(i), DVec3::Y)))?;
/// let mut stop = Stop::default();
/// stop.relative_rmse = Some(0.01);
/// let picture = Render::new(&scene, &points, &points.settings(u32::MAX)).until(stop).run(&())?;
/// for reading in points.readings(&picture.film) {
///     println!("{}: {} +- {} W/m^2", reading.position, reading.irradiance.g, reading.margin_95.g);
/// }
/// # let first = points.readings(&picture.film).next().expect("the first point");
/// // Pi times radiance times the form factor of a square of 2 x 2 seen from one unit below its middle.
/// assert!((first.irradiance.g / (10.0 * std::f64::consts::PI * 0.554_126) - 1.0).abs() < 0.05);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct IrradiancePoints {
    /// Positions with unit normals.
    points: Vec<(DVec3, DVec3)>,
}

/// What a point of [`IrradiancePoints`] has measured.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Reading {
    /// The point.
    pub position: DVec3,
    /// Its unit normal.
    pub normal: DVec3,
    /// The irradiance, for each component; black before the first sample.
    pub irradiance: Rgb,
    /// Its standard error, the square root of [`Film::variance_of_mean`]; infinite for fewer than two observations.
    pub std_err: Rgb,
    /// Half the width of the interval around `irradiance` that holds the truth with a probability of 95 %:
    /// Student's quantile times `std_err`.
    ///
    /// Other points have no say in it, unlike in [`Film::margin_95`], whose neighbours are near. It is too small for a
    /// point that has missed rare bright samples.
    pub margin_95: Rgb,
}

impl IrradiancePoints {
    /// How much the length of a normal may differ from 1: that of components rounded to three decimals does less.
    pub const NORMAL_TOLERANCE: f64 = 1e-3;

    /// Points, each with its unit normal, which is normalised. Coordinates of a position are at most
    /// [`Triangles::MAX_COORDINATE`] in magnitude.
    ///
    /// # Errors
    /// [`PointError`] if there is no point, and for the first position that is out of range or not finite, or normal
    /// whose length differs from 1 by more than [`IrradiancePoints::NORMAL_TOLERANCE`].
    pub fn new(points: impl IntoIterator<Item = (DVec3, DVec3)>) -> Result<Self, PointError> {
        let valid = |(index, (position, normal)): (usize, (DVec3, DVec3))| {
            if !position.abs().cmple(DVec3::splat(Triangles::MAX_COORDINATE.into())).all() {
                return Err(PointError::Position { index, position });
            }
            let length = normal.length();
            // Also false for NaN.
            if (length - 1.0).abs() <= Self::NORMAL_TOLERANCE {
                Ok((position, normal / length))
            } else {
                Err(PointError::Normal { index, normal })
            }
        };
        let points: Vec<_> = points.into_iter().enumerate().map(valid).collect::<Result<_, _>>()?;
        if points.is_empty() { Err(PointError::Empty) } else { Ok(Self { points }) }
    }

    /// [`Settings::new`] for one element for each point.
    pub fn settings(&self, samples: u32) -> Settings {
        Settings::new(1, self.count(), samples)
    }

    /// The number of points; more than are allowed stay too many.
    fn count(&self) -> u32 {
        self.points.len().try_into().unwrap_or(u32::MAX)
    }

    /// The points with their unit normals, in order.
    pub fn points(&self) -> &[(DVec3, DVec3)] {
        &self.points
    }

    /// What the points have measured, in order; of a film of a strip, those of its [rows](Film::rows). The film of a
    /// crop has lost its place in the list.
    ///
    /// # Panics
    /// If `film` has rows beyond the points.
    pub fn readings(&self, film: &Film) -> impl Iterator<Item = Reading> {
        let rows = film.rows();
        let points = &self.points[rows.start as usize..rows.end as usize];
        let (means, variances) = (film.means(), film.variances_of_mean());
        let quantile = film.student_quantile();
        points.iter().zip(means.zip(variances)).map(move |(&(position, normal), (irradiance, variance))| {
            let [r, g, b] = variance.to_array().map(f64::sqrt);
            let std_err = Rgb::new(r, g, b);
            let margin_95 = if quantile.is_finite() { std_err * quantile } else { std_err };
            Reading { position, normal, irradiance, std_err, margin_95 }
        })
    }
}

impl Sensor for IrradiancePoints {
    fn size(&self) -> Option<[u32; 2]> {
        Some([1, self.count()])
    }

    fn has_neighbours(&self) -> bool {
        false
    }

    fn start(&self, sample: &ElementSample) -> PathStart {
        let (position, normal) = self.points[sample.row as usize];
        PathStart::Irradiance { position, normal }
    }

    fn hash(&self, key: &mut dyn Hasher) {
        key.write(b"irradiance points");
        let vectors = self.points.iter().flat_map(|&(position, normal)| [position, normal]);
        vectors.flat_map(|v| v.to_array()).for_each(|x| key.write_u64(x.to_bits()));
    }
}
