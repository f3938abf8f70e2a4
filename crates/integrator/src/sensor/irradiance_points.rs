use super::sample::{ElementSample, PathStart, Sensor};
use crate::error::PointError;
use crate::{Film, Settings};
use glam::{DVec3, U64Vec3};
use globillum_geom::Triangle;
use globillum_material::Rgb;
use std::hash::Hasher;

/// A list of points with unit normals, each of which measures irradiance: the integral of radiance times cosine over
/// the hemisphere around its normal.
///
/// The unit is pi steradians times that of radiance: W/m^2 in each component if lights have W/(m^2 sr), and lux if
/// they are given in photometric units (lumen, candela, cd/m^2). Points may lie on surfaces
/// ([`PathStart::Irradiance`]); those on none measure what comes through the air.
///
/// The points are a grid of one column. A row is a place along a Morton curve and not in the list, since the paths of
/// points that are near to each other are traced faster; [`IrradiancePoints::readings`] returns to the order of the
/// list. Paths are never reused, so errors of points are independent.
///
/// Irradiance at ten points of a floor under a square light, until the root of the mean squared error of all points is one
/// percent of their mean irradiance. Dark points are known less well than that:
///
/// ```
/// use glam::{DVec3, Vec3};
/// use globillum_geom::{Triangle, WideBvh};
/// use globillum_integrator::{IrradiancePoints, Model, Render, Scene, Stop};
/// use globillum_material::{Material, Rgb};
///
/// let mut model = Model::default();
/// let [a, b, c, d] = [(-1, -1), (1, -1), (1, 1), (-1, 1)].map(|(x, z)| Vec3::new(x as f32, 1.0, z as f32));
/// model.add(Material::light(Rgb::splat(10.0))?, Triangle::quad(a, b, c, d));
/// let scene = Scene::build(model, WideBvh::build)?;
///
/// let points = IrradiancePoints::new((0..10).map(|i| (DVec3::X * 0.1 * f64::from(i), DVec3::Y)))?;
/// let mut stop = Stop::default();
/// stop.relative_rmse = Some(0.01);
/// let picture = Render::new(&scene, &points, &points.settings(u32::MAX)).until(stop).run()?;
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
    /// Positions with unit normals, by row.
    points: Vec<(DVec3, DVec3)>,
    /// The row of each point of the list.
    rows: Vec<u32>,
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
    /// It does not depend on other points, unlike [`Film::margin_95`], whose neighbours are near. It is too small for a
    /// point that has missed rare bright samples.
    pub margin_95: Rgb,
}

impl IrradiancePoints {
    /// How much the length of a normal may differ from 1: that of components rounded to three decimals does less.
    pub const NORMAL_TOLERANCE: f64 = 1e-3;

    /// Points, each with its unit normal, which is normalised. Coordinates of a position are at most
    /// [`Triangle::MAX_COORDINATE`] in magnitude.
    ///
    /// # Errors
    /// [`PointError`] if there is no point, and for the first position that is out of range or not finite, or normal
    /// whose length differs from 1 by more than [`IrradiancePoints::NORMAL_TOLERANCE`].
    pub fn new(points: impl IntoIterator<Item = (DVec3, DVec3)>) -> Result<Self, PointError> {
        let valid = |(index, (position, normal)): (usize, (DVec3, DVec3))| {
            if !position.abs().cmple(DVec3::splat(Triangle::MAX_COORDINATE.into())).all() {
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
        let listed: Vec<_> = points.into_iter().enumerate().map(valid).collect::<Result<_, _>>()?;
        if listed.is_empty() {
            return Err(PointError::Empty);
        }
        let order = along_curve(&listed);
        let mut rows = vec![0; listed.len()];
        (0..).zip(&order).for_each(|(row, &index)| rows[index] = row);
        Ok(Self { points: order.iter().map(|&index| listed[index]).collect(), rows })
    }

    /// [`Settings::new`] for one element for each point.
    pub fn settings(&self, samples: u32) -> Settings {
        Settings::new(1, self.count(), samples)
    }

    /// The number of points; more than are allowed stay too many.
    fn count(&self) -> u32 {
        self.points.len().try_into().unwrap_or(u32::MAX)
    }

    /// The points with their unit normals, in the order of the list.
    pub fn points(&self) -> impl Iterator<Item = (DVec3, DVec3)> {
        self.rows.iter().map(|&row| self.points[row as usize])
    }

    /// What the points have measured, in the order of the list; of a film of a crop or a strip, the points that it holds.
    ///
    /// # Panics
    /// If `film` is not of one column with a row for each point.
    pub fn readings(&self, film: &Film) -> impl Iterator<Item = Reading> {
        assert_eq!(
            film.full_size(),
            [1, self.count()],
            "a film of points has one column, and a row for each"
        );
        let [_, start] = film.origin();
        let end = start + film.height();
        let quantile = film.student_quantile();
        self.rows.iter().filter(move |row| (start..end).contains(row)).map(move |&row| {
            let (position, normal) = self.points[row as usize];
            let (irradiance, variance) = (film.mean(0, row - start), film.variance_of_mean(0, row - start));
            let std_err = variance.map(f64::sqrt);
            Reading { position, normal, irradiance, std_err, margin_95: std_err * quantile }
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

/// The indices of points along a Morton curve (Morton 1966), those that face along the same axis together.
fn along_curve(points: &[(DVec3, DVec3)]) -> Vec<usize> {
    let positions = || points.iter().map(|point| point.0);
    let low = positions().fold(DVec3::INFINITY, DVec3::min);
    let extent = (positions().fold(DVec3::NEG_INFINITY, DVec3::max) - low).max_element();
    let scale = if extent > 0.0 { f64::from((1_u32 << MORTON_BITS) - 1) / extent } else { 0.0 };
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by_cached_key(|&index| {
        let (position, normal) = points[index];
        let axis = normal.abs().max_position();
        (axis, normal[axis] < 0.0, morton_code(((position - low) * scale).as_u64vec3()), index)
    });
    order
}

/// Bits of each coordinate in a Morton code.
const MORTON_BITS: u32 = 20;

/// The bits of three coordinates in turn.
fn morton_code(cell: U64Vec3) -> u64 {
    (0..MORTON_BITS)
        .rev()
        .flat_map(|bit| cell.to_array().map(|x| x >> bit & 1))
        .fold(0, |code, bit| code << 1 | bit)
}
