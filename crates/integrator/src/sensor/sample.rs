use glam::{DVec2, DVec3};
use globillum_geom::Ray;
use std::fmt;
use std::hash::Hasher;

/// What a render measures with: a grid of elements, each the mean of a quantity over the samples that it takes.
///
/// The elements of a [`PinholeCamera`](crate::PinholeCamera) are pixels, those of
/// [`IrradiancePoints`](crate::IrradiancePoints) points of a list. All else of a render, such as estimators, errors, stop
/// conditions and checkpoints, is the same for any sensor. Elements are taken in tiles of 16 x 16, row by row, or of up to
/// 256 elements in a grid of at most eight columns; the bits of a picture do not depend on the tiles.
///
/// A fisheye camera, which maps angles to distances from the middle of the picture:
///
/// ```
/// use glam::{DMat3, DVec3};
/// use globillum_geom::Ray;
/// use globillum_integrator::{ElementSample, PathStart, Sensor};
/// use std::hash::Hasher;
///
/// #[derive(Debug)]
/// struct Fisheye {
///     eye: DVec3,
///     /// Right, up and back, as columns.
///     axes: DMat3,
/// }
///
/// impl Sensor for Fisheye {
///     fn start(&self, sample: &ElementSample) -> PathStart {
///         let (x, y) = (sample.x * sample.aspect, sample.y);
///         let radius = x.hypot(y);
///         if radius > 1.0 {
///             return PathStart::Nowhere; // black around the circle
///         }
///         let angle = radius * std::f64::consts::FRAC_PI_2;
///         let scale = if radius > 0.0 { angle.sin() / radius } else { 0.0 };
///         let direction = self.axes * DVec3::new(x * scale, y * scale, -angle.cos());
///         PathStart::Ray(Ray::new(self.eye, direction))
///     }
///
///     fn hash(&self, key: &mut dyn Hasher) {
///         key.write(b"fisheye");
///         let numbers = self.eye.to_array().into_iter().chain(self.axes.to_cols_array());
///         numbers.for_each(|x| key.write_u64(x.to_bits()));
///     }
/// }
/// # use globillum_geom::{KdTree, Triangle};
/// # use globillum_integrator::{Model, Scene, Settings, render};
/// # use globillum_material::Rgb;
/// # let triangle = Triangle::new([9.0, 9.0, 9.0].into(), [8.0, 9.0, 9.0].into(), [9.0, 8.0, 9.0].into());
/// # let mut model = Model::default();
/// # model.add(globillum_material::Material::lambert(Rgb::BLACK)?, [triangle]);
/// # model.set_environment(Rgb::WHITE)?;
/// # let scene = Scene::build(model, KdTree::build)?;
///
/// let fisheye = Fisheye { eye: DVec3::ZERO, axes: DMat3::IDENTITY };
/// let picture = render(&scene, &fisheye, &Settings::new(16, 16, 4))?;
/// assert_eq!((picture.film.mean(8, 8), picture.film.mean(0, 0)), (Rgb::WHITE, Rgb::BLACK));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Sensor: fmt::Debug + Sync {
    /// Width and height of the grid. `None`, the default, if the sensor takes any, as cameras do. A render whose
    /// [`Settings`](crate::Settings) differ from it is refused.
    fn size(&self) -> Option<[u32; 2]> {
        None
    }

    /// Whether elements side by side measure at places so near to each other that they may reuse each other's
    /// paths ([`PathReuse`](crate::PathReuse)). `true` by default. This changes the error, not the mean.
    fn has_neighbours(&self) -> bool {
        true
    }

    /// Where the path of a sample begins. Called from several threads, once or more for each sample, and for other
    /// positions in the grid too, such as those of probes, of [supersampling](crate::Supersampling) and of
    /// [`FirstHits`](crate::FirstHits); equal samples must get equal answers.
    fn start(&self, sample: &ElementSample) -> PathStart;

    /// Where in the grid the sensor sees `point` if nothing occludes it: `x` and `y` of an [`ElementSample`] of this `aspect`
    /// whose ray passes through `point`. They may lie outside the grid. `None`, the default, if no ray does or the sensor
    /// cannot tell; numbers that are not finite count as `None`. Called from several threads; equal points must get equal
    /// answers.
    ///
    /// A render looks there for lights that are smaller than a pixel ([`Supersampling`](crate::Supersampling)). This changes
    /// the error, not the mean.
    fn project(&self, point: DVec3, aspect: f64) -> Option<DVec2> {
        let _ = (point, aspect);
        None
    }

    /// Hands to `key` all that [`Sensor::start`] and [`Sensor::project`] depend on, and the name of the kind of sensor:
    /// renders with different sensors must not be mixed ([`Render::key`](crate::Render::key)).
    fn hash(&self, key: &mut dyn Hasher);
}

/// A sample of an element, as [`Sensor::start`] gets it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ElementSample {
    /// Column of the element, 0 at the left.
    pub column: u32,
    /// Row of the element, 0 at the top.
    pub row: u32,
    /// Where the [`PixelFilter`](crate::PixelFilter) places the sample in the grid: from -1 to 1 rightward. The tent
    /// filter reaches half an element beyond.
    pub x: f64,
    /// The same from -1 to 1 upward.
    pub y: f64,
    /// Width of the grid over its height.
    pub aspect: f64,
}

impl ElementSample {
    /// The sample at this offset from the upper left corner of an element (column and row), in elements, of a grid of this
    /// size: `[0.5, 0.5]` is the middle of the element.
    pub fn new((column, row): (u32, u32), [dx, dy]: [f64; 2], [width, height]: [u32; 2]) -> Self {
        let (width, height) = (f64::from(width), f64::from(height));
        let x = 2.0 * (f64::from(column) + dx) / width - 1.0;
        let y = 1.0 - 2.0 * (f64::from(row) + dy) / height;
        Self { column, row, x, y, aspect: width / height }
    }
}

/// Where the path of a sample begins, and what it measures there.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PathStart {
    /// The radiance that arrives along the ray, from its direction at its origin. A ray that accelerators do not
    /// [trace](Ray::is_traceable) is an error of the render.
    Ray(Ray),
    /// The irradiance of all that arrives at `position` from the side of the unit vector `normal`: the integral of
    /// radiance times cosine over the hemisphere.
    ///
    /// `position` may lie on a surface ([`Triangles::given_point`](globillum_geom::Triangles::given_point) says how
    /// exactly). The path begins with a vertex there, as if a camera saw a matte surface: lights are sampled at it,
    /// and it counts as the first [bounce](crate::Settings::max_bounces). A coordinate beyond
    /// [`Ray::MAX_ORIGIN`], or a normal whose length differs from 1 by more than about 1e-4, is an error of the render.
    Irradiance {
        /// Where, in world space.
        position: DVec3,
        /// Toward the side that is measured, a unit vector.
        normal: DVec3,
    },
    /// Nothing: the sample is black.
    Nowhere,
}

impl PathStart {
    /// Whether it is no error of the render.
    #[inline(always)]
    pub(crate) fn is_valid(&self) -> bool {
        match self {
            Self::Ray(ray) => ray.is_traceable(),
            Self::Irradiance { position, normal } => {
                position.abs().cmple(DVec3::splat(Ray::MAX_ORIGIN)).all() && normal.is_normalized()
            }
            Self::Nowhere => true,
        }
    }
}
