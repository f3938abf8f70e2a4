//! What a camera sees first, without its light.

use crate::caught::caught;
use crate::pixel_rect::PixelRect;
use crate::worker_threads::run_in_threads;
use crate::{ElementSample, PathStart, RenderError, Scene, Sensor, Settings};
use glam::DVec3;
use globillum_geom::{Accel, Hit, Ray};
use globillum_material::{Bsdf, Rgb};
use rayon::prelude::*;
use std::ops::Range;

/// Rays through a pixel in each direction, on a regular grid.
const RAYS: u32 = 4;

/// The first hits of every pixel, for denoisers and for picking.
///
/// ```
/// use globillum_integrator::{FirstHits, Scene};
/// # use globillum_integrator::{Model, PinholeCamera, Settings};
/// # use glam::{DVec3, Vec3};
/// # use globillum_geom::{KdTree, Triangle};
/// # use globillum_material::{Material, Rgb};
/// # let mut model = Model::default();
/// # let [a, b, c] = [Vec3::new(-9.0, -9.0, -2.0), Vec3::new(9.0, -9.0, -2.0), Vec3::new(0.0, 9.0, -2.0)];
/// # model.add(Material::light(Rgb::WHITE)?, [Triangle::new(a, b, c)]);
/// # let scene = Scene::build(model, KdTree::build)?;
/// # let camera = PinholeCamera::look_at(DVec3::ZERO, -DVec3::Z, DVec3::Y, 0.7)?;
/// let hits = FirstHits::of(&scene, &camera, &Settings::new(8, 8, 1))?;
/// assert_eq!((hits.pixels[9].triangle, hits.pixels[9].depth), (Some(0), 2.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FirstHits {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// The pixels, row by row from the top.
    pub pixels: Vec<FirstHit>,
}

/// What a pixel shows. Depth, normal and albedo are means over its square (the box filter), by 16 rays on a regular
/// grid; a mirror is a surface like others. The indices are those of the ray through its center.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FirstHit {
    /// Mean distance in units of the scene of the rays that hit anything, along the view direction of a pinhole or an
    /// orthographic camera, and from the eye of a spherical one; infinite if none does. Of another sensor, in units of the
    /// lengths of the directions that it gives.
    pub depth: f64,
    /// Mean of the unit geometric normals in the world frame, on the side of the camera, where rays that hit nothing
    /// count as 0: shorter than 1 where normals differ.
    pub normal: DVec3,
    /// Mean of the albedo of diffuse surfaces and of the reflectance of mirrors, where rays that hit nothing count
    /// as 0.
    pub albedo: Rgb,
    /// Index of the triangle in the scene; `None` if the ray hits nothing.
    pub triangle: Option<u32>,
    /// Index of the triangle's material in [`Scene::materials`]; `None` if the ray hits nothing.
    pub material: Option<u32>,
}

impl FirstHit {
    /// That of a pixel of which no ray hits anything.
    pub const NOTHING: Self = Self {
        depth: f64::INFINITY,
        normal: DVec3::ZERO,
        albedo: Rgb::BLACK,
        triangle: None,
        material: None,
    };
}

impl FirstHits {
    /// A picture that shows nothing.
    pub fn nothing(width: u32, height: u32) -> Self {
        Self { width, height, pixels: vec![FirstHit::NOTHING; width as usize * height as usize] }
    }

    /// The first hits of `scene` as seen by `camera`, in a picture of the size that `settings` say and on as many
    /// threads; the other settings do not matter. The bits are the same for any number of threads and accelerator.
    /// Elements of a sensor whose paths begin at points show nothing, nor do rays that cannot be traced
    /// ([`Ray::is_traceable`]), of which a render makes an error.
    ///
    /// # Errors
    /// [`RenderError::Param`] for settings out of range, [`RenderError::SensorSize`] for settings of another size than
    /// the sensor's, [`RenderError::Threads`] if no threads can be started,
    /// [`RenderError::Worker`] for a panic in the accelerator or the sensor.
    pub fn of(
        scene: &Scene<dyn Accel + '_>,
        camera: &dyn Sensor,
        settings: &Settings,
    ) -> Result<Self, RenderError> {
        let settings = &settings.for_sensor(camera)?;
        let &Settings { width, height, .. } = settings;
        let view = View { scene, camera, size: [width, height] };
        let row = |y: u32| {
            let pixels = || (0..width).map(|x| view.pixel(x, y)).collect::<Vec<FirstHit>>();
            caught(pixels).map_err(|message| RenderError::Worker { x: 0, y, message })
        };
        let rows = || (0..height).into_par_iter().map(row).collect::<Result<Vec<_>, RenderError>>();
        let rows = run_in_threads(settings.threads, rows).map_err(RenderError::Threads)??;
        Ok(Self { width, height, pixels: rows.concat() })
    }

    /// The pixels of these columns and rows alone.
    ///
    /// # Panics
    /// If a range begins after its end, or they are not all within the picture.
    #[must_use]
    pub fn crop(&self, columns: Range<u32>, rows: Range<u32>) -> Self {
        let rect = PixelRect::of_ranges(columns, rows, [self.width, self.height]);
        Self { width: rect.width, height: rect.height, pixels: rect.cut(&self.pixels, self.width) }
    }
}

/// A scene as a camera sees it.
struct View<'a> {
    scene: &'a Scene<dyn Accel + 'a>,
    camera: &'a dyn Sensor,
    /// Size of the picture in pixels.
    size: [u32; 2],
}

impl View<'_> {
    fn pixel(&self, x: u32, y: u32) -> FirstHit {
        let (mut depth, mut normal, mut albedo) = (0.0, DVec3::ZERO, Rgb::BLACK);
        let mut hits = 0;
        for at in 0..RAYS * RAYS {
            let [dx, dy] = [at % RAYS, at / RAYS].map(|i| (f64::from(i) + 0.5) / f64::from(RAYS));
            let Some((ray, hit)) = self.trace((x, y), [dx, dy]) else { continue };
            let interaction = self.scene.interaction(&ray, &hit);
            // Directions of cameras end at depth 1.
            depth += hit.t;
            normal += interaction.facing_normal();
            albedo += albedo_of(&interaction.material.bsdf);
            hits += 1;
        }
        let all = f64::from(RAYS * RAYS);
        let middle = self.trace((x, y), [0.5; 2]).map(|(_, hit)| hit.triangle);
        FirstHit {
            depth: if hits == 0 { f64::INFINITY } else { depth / f64::from(hits) },
            normal: normal / all,
            albedo: albedo / all,
            triangle: middle,
            material: middle.map(|triangle| self.scene.material_index(triangle)),
        }
    }

    /// The ray through a point of a pixel, at this offset from its upper left corner in pixels, and its first hit.
    fn trace(&self, pixel: (u32, u32), offset: [f64; 2]) -> Option<(Ray, Hit)> {
        let sample = ElementSample::new(pixel, offset, self.size);
        let PathStart::Ray(ray) = self.camera.start(&sample) else { return None };
        let hit = self.scene.accel().intersect(&ray)?;
        Some((ray, hit))
    }
}

fn albedo_of(bsdf: &Bsdf) -> Rgb {
    match bsdf {
        Bsdf::Lambert(albedo) => albedo.rgb(),
        Bsdf::Mirror(reflectance) => reflectance.rgb(),
        // Bsdf is non-exhaustive; a kind that is added needs a line here.
        _ => Rgb::BLACK,
    }
}
