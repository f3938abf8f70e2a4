use super::key::picture_key;
use super::meter::Meter;
use super::monitor::Monitor;
use super::pass::PassRenderer;
use super::pass_loop::PassLoop;
use super::stop::Stop;
use crate::caught::caught;
use crate::path::RenderContext;
use crate::{Camera, CheckpointError, Film, Picture, RenderError, Scene, Settings};
use globillum_geom::Accel;
use std::ops::Range;

/// Renders all samples of `scene` as seen by `camera`: [`Render`] without further conditions.
///
/// # Errors
/// Those of [`Render::run`].
pub fn render<A: Accel>(
    scene: &Scene<A>,
    camera: &Camera,
    settings: &Settings,
    monitor: &impl Monitor,
) -> Result<Picture, RenderError> {
    Render::new(scene, camera, settings).run(monitor)
}

/// A render, with the conditions that stop it.
///
/// A render adds passes of a few samples per pixel. Each tile of a pass is one task, and each pixel belongs
/// to one tile. Samples and passes are summed in a fixed order, so that the bits of the picture depend
/// neither on the number of threads nor on when and where passes are rendered.
///
/// To a relative error of two percent:
///
/// ```
/// use globillum_integrator::{Ending, Render, Settings, Stop};
/// # use globillum_integrator::{Camera, Model, Scene};
/// # use glam::{DVec3, Vec3};
/// # use globillum_geom::{KdOptions, KdTree, Triangle};
/// # use globillum_material::{Material, Rgb};
/// # let mut model = Model::default();
/// # let [a, b, c] = [Vec3::new(-9.0, -9.0, -1.0), Vec3::new(9.0, -9.0, -1.0), Vec3::new(0.0, 9.0, -1.0)];
/// # model.add(Material::light(Rgb::WHITE)?, [Triangle::new(a, b, c)]);
/// # let scene = Scene::build(model, |triangles| KdTree::build(triangles, &KdOptions::default()))?;
/// # let camera = Camera::look_at(DVec3::ZERO, -DVec3::Z, DVec3::Y, 0.7)?;
/// let settings = Settings::new(32, 32, u32::MAX);
/// let mut stop = Stop::default();
/// stop.relative_rmse = Some(0.02);
/// let picture = Render::new(&scene, &camera, &settings).until(stop).run(&())?;
/// assert_eq!(picture.ending, Ending::Goals);
/// assert!(picture.film.error().relative_rmse <= 0.02);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Render<'a, A> {
    scene: &'a Scene<A>,
    camera: &'a Camera,
    settings: &'a Settings,
    stop: Stop,
    passes: Option<Range<u32>>,
    rows: Option<Range<u32>>,
    before: Option<Picture>,
}

impl<'a, A: Accel> Render<'a, A> {
    /// A render of all samples of `settings`.
    pub fn new(scene: &'a Scene<A>, camera: &'a Camera, settings: &'a Settings) -> Self {
        Self { scene, camera, settings, stop: Stop::default(), passes: None, rows: None, before: None }
    }

    /// Stops early by `stop`.
    #[must_use]
    pub fn until(self, stop: Stop) -> Self {
        Self { stop, ..self }
    }

    /// Renders only these of the [`Settings::passes`], to be [merged](Picture::merge) with the others.
    #[must_use]
    pub fn passes(self, passes: Range<u32>) -> Self {
        Self { passes: Some(passes), ..self }
    }

    /// Renders only these rows of the picture, of which row 0 is at the top; they begin at a multiple of
    /// [`Film::TILE_ROWS`], and end at one or with the picture. Their pixels have the bits of the whole picture,
    /// which [`Merge`](crate::Merge) puts together.
    #[must_use]
    pub fn rows(self, rows: Range<u32>) -> Self {
        Self { rows: Some(rows), ..self }
    }

    /// A hash of all that determines the picture's bits: scene, camera, settings without the numbers of samples
    /// and threads, and the sources of the library. Parts of a picture have the same one, whatever their passes
    /// and rows; different pictures have equal ones with a probability of `2^-64`.
    pub fn key(&self) -> u64 {
        picture_key(self.scene, self.camera, self.settings)
    }

    /// Continues `picture`: the passes that it holds are not rendered again.
    #[must_use]
    pub fn resume(self, picture: Picture) -> Self {
        Self { before: Some(picture), ..self }
    }

    /// Renders. If `monitor` cancels, the current pass is dropped and the passes before it are returned.
    ///
    /// # Errors
    /// [`RenderError::Param`] for settings, stop conditions, passes or rows out of range,
    /// [`RenderError::Checkpoint`] for a picture to resume that does not belong to this render,
    /// [`RenderError::Threads`] if no threads can be started, [`RenderError::NonFinite`] for a sample
    /// that is NaN or infinite. Panics are caught: [`RenderError::Worker`] for one in an accelerator,
    /// [`Monitor::progress`] or [`Monitor::cancelled`], [`RenderError::Monitor`] for one in
    /// [`Monitor::pass_done`]. The passes before an error were handed to [`Monitor::pass_done`].
    pub fn run(mut self, monitor: &impl Monitor) -> Result<Picture, RenderError> {
        self.settings.validate()?;
        self.stop.validate()?;
        let passes = self.checked_passes()?;
        let picture = self.start(self.checked_rows()?)?;
        let threads = rayon::ThreadPoolBuilder::new()
            .num_threads(self.settings.threads)
            .build()
            .map_err(|error| RenderError::Threads(error.to_string()))?;
        let meter = Meter::new(self.stop.seconds);
        // The accelerator is asked for the mirrors' visibility.
        let context = caught(|| RenderContext::new(self.scene, self.camera, self.settings))
            .map_err(|message| RenderError::Worker { x: 0, y: 0, message })?;
        let pass_loop = PassLoop {
            renderer: PassRenderer { context, monitor, meter: &meter, rows: picture.film.rows() },
            stop: self.stop,
        };
        threads.install(|| pass_loop.add_passes(picture, passes))
    }

    fn checked_passes(&self) -> Result<Range<u32>, RenderError> {
        let all = 0..self.settings.passes();
        let Some(passes) = self.passes.clone() else { return Ok(all) };
        if passes.is_empty() || passes.end > all.end {
            let value = if passes.is_empty() { passes.start } else { passes.end };
            let range = "the passes of all samples, of which at least one must be asked for";
            return Err(RenderError::Param { name: "passes", value: value.into(), range });
        }
        Ok(passes)
    }

    fn checked_rows(&self) -> Result<Range<u32>, RenderError> {
        let height = self.settings.height;
        let Some(rows) = self.rows.clone() else { return Ok(0..height) };
        let is_end = |row: u32| row.is_multiple_of(Film::TILE_ROWS) || row == height;
        if rows.is_empty() || rows.end > height || !is_end(rows.start) || !is_end(rows.end) {
            let valid = |end: u32| is_end(end) && end <= height;
            let value = if valid(rows.start) { rows.end } else { rows.start };
            let range = "the multiples of 16 and the height, of which start and end are two";
            return Err(RenderError::Param { name: "rows", value: value.into(), range });
        }
        Ok(rows)
    }

    /// The picture of these rows to continue.
    fn start(&mut self, rows: Range<u32>) -> Result<Picture, RenderError> {
        let key = self.key();
        let Some(picture) = self.before.take() else {
            let Settings { width, height, pass_samples, .. } = *self.settings;
            let film = Film::new(width, rows, self.settings.path_reuse_in_effect());
            return Ok(Picture::new(film, height, pass_samples, key));
        };
        if picture.key != key {
            return Err(CheckpointError::OTHER_PICTURE.into());
        }
        if picture.film.rows() != rows && !picture.film.passes().is_empty() {
            return Err(CheckpointError::Mismatch("range of rows").into());
        }
        // A short last pass cannot be continued when more samples are asked for.
        let samples_of = |passes| self.settings.samples_of(passes).len() as u64;
        let expected: u64 = picture.film.passes().into_iter().map(samples_of).sum();
        if picture.film.samples() != expected {
            return Err(CheckpointError::Mismatch("number of samples").into());
        }
        Ok(picture)
    }
}
