use super::key::picture_key;
use super::meter::Meter;
use super::monitor::Monitor;
use super::pass::PassRenderer;
use super::pass_loop::PassLoop;
use super::stop::Stop;
use crate::caught::caught;
use crate::film::Moments;
use crate::path::{prepare, train_guide};
use crate::pixel_rect::PixelRect;
use crate::worker_threads::run_in_threads;
use crate::{CheckpointError, Ending, Film, Picture, RenderError, Scene, Sensor, Settings};
use globillum_geom::Accel;
use std::cmp::Ordering;
use std::fmt;
use std::hint::black_box;
use std::ops::{ControlFlow, Range};
use std::sync::OnceLock;
use std::time::Instant;

/// Renders all samples of `scene` as measured by `sensor`, such as a [`PinholeCamera`](crate::PinholeCamera):
/// [`Render`] without further conditions and without a monitor.
///
/// # Errors
/// Those of [`Render::run`].
pub fn render(
    scene: &Scene<dyn Accel + '_>,
    sensor: &dyn Sensor,
    settings: &Settings,
) -> Result<Picture, RenderError> {
    Render::new(scene, sensor, settings).run()
}

/// A render, with the conditions that stop it and the monitor that observes it.
///
/// A render adds passes of a few samples per pixel. Each tile of a pass is one task, and each pixel belongs
/// to one tile. Samples and passes are summed in a fixed order, so that the bits of the picture depend
/// neither on the number of threads nor on when and where passes are rendered.
///
/// To a relative error of two percent:
///
/// ```
/// use globillum_integrator::{Ending, Render, Settings, Stop};
/// # use globillum_integrator::{Model, PinholeCamera, Scene};
/// # use glam::{DVec3, Vec3};
/// # use globillum_geom::{KdTree, Triangle};
/// # use globillum_material::{Material, Rgb};
/// # let mut model = Model::default();
/// # let [a, b, c] = [Vec3::new(-9.0, -9.0, -1.0), Vec3::new(9.0, -9.0, -1.0), Vec3::new(0.0, 9.0, -1.0)];
/// # model.add(Material::light(Rgb::WHITE)?, [Triangle::new(a, b, c)]);
/// # let scene = Scene::build(model, KdTree::build)?;
/// # let camera = PinholeCamera::look_at(DVec3::ZERO, -DVec3::Z, DVec3::Y, 0.7)?;
/// let settings = Settings::new(32, 32, u32::MAX);
/// let mut stop = Stop::default();
/// stop.relative_rmse = Some(0.02);
/// let picture = Render::new(&scene, &camera, &settings).until(stop).run()?;
/// assert_eq!(picture.ending, Ending::Goals);
/// assert!(picture.film.error().relative_rmse <= 0.02);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Render<'a> {
    scene: &'a Scene<dyn Accel + 'a>,
    sensor: &'a dyn Sensor,
    settings: Settings,
    monitor: &'a dyn Monitor,
    stop: Stop,
    passes: Option<Range<u32>>,
    crop: Option<[Range<u32>; 2]>,
    rows: Option<Range<u32>>,
    before: Option<Picture>,
}

impl<'a> Render<'a> {
    /// A render of all samples of `settings`, of a scene with any accelerator.
    pub fn new(scene: &'a Scene<dyn Accel + 'a>, sensor: &'a dyn Sensor, settings: &Settings) -> Self {
        let (settings, stop) = (*settings, Stop::default());
        Self {
            scene,
            sensor,
            settings,
            monitor: &(),
            stop,
            passes: None,
            crop: None,
            rows: None,
            before: None,
        }
    }

    /// The same render, observed by `monitor`, which may cancel it.
    #[must_use]
    pub fn monitor(self, monitor: &'a dyn Monitor) -> Self {
        Self { monitor, ..self }
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

    /// Renders only these columns and rows of the picture, as a smaller picture of its own, whose pixels have the
    /// bits of the whole one's. Column and row 0 are at the upper left.
    ///
    /// Where [pixels depend on each other](crate::PathReuse), columns and rows begin at a multiple of
    /// [`PathReuse::tile_side`](crate::PathReuse::tile_side), and end at one or with the picture. Passes and strips
    /// of equal crops can be merged.
    ///
    /// ```
    /// # use globillum_integrator::{Model, PinholeCamera, Render, Scene, Settings};
    /// # use glam::{DVec3, Vec3};
    /// # use globillum_geom::{KdTree, Triangle};
    /// # use globillum_material::{Material, Rgb};
    /// # let mut model = Model::default();
    /// # let [a, b, c] = [Vec3::new(-9.0, -9.0, -1.0), Vec3::new(9.0, -9.0, -1.0), Vec3::new(0.0, 9.0, -1.0)];
    /// # model.add(Material::light(Rgb::WHITE)?, [Triangle::new(a, b, c)]);
    /// # let scene = Scene::build(model, KdTree::build)?;
    /// # let camera = PinholeCamera::look_at(DVec3::ZERO, -DVec3::Z, DVec3::Y, 0.7)?;
    /// let settings = Settings::new(640, 480, 16);
    /// let crop = Render::new(&scene, &camera, &settings).crop(320..352, 240..304).run()?;
    /// assert_eq!((crop.film.width(), crop.film.height()), (32, 64));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn crop(self, columns: Range<u32>, rows: Range<u32>) -> Self {
        Self { crop: Some([columns, rows]), ..self }
    }

    /// Renders only these rows of the picture or of the [crop](Render::crop), of which row 0 is at the top. They begin
    /// at a multiple of [`Film::TILE_ROWS`], and end at one or with the picture. Their pixels have the bits of the
    /// whole picture, which [`Merge`](crate::Merge) puts together.
    #[must_use]
    pub fn rows(self, rows: Range<u32>) -> Self {
        Self { rows: Some(rows), ..self }
    }

    /// A hash of what determines the picture's bits: scene, sensor, crop, settings without the numbers of samples and
    /// threads, and the sources of `geom`, `material` and `integrator`, comments and tests included, but not the versions of
    /// other crates. Parts of a picture have the same one, whatever their passes and rows; different pictures have equal
    /// ones with a probability of `2^-64`.
    pub fn key(&self) -> u64 {
        picture_key(self.scene, self.sensor, &self.settings.in_effect(self.sensor), self.crop.as_ref())
    }

    /// Continues `picture`: the passes that it holds are not rendered again.
    #[must_use]
    pub fn resume(self, picture: Picture) -> Self {
        Self { before: Some(picture), ..self }
    }

    /// Renders. If the monitor cancels, the current pass is dropped and the passes before it are returned. There may be
    /// none: the film then has no samples and is black.
    ///
    /// # Errors
    /// [`RenderError::Param`] for settings and stop conditions out of range, [`RenderError::Range`] for passes, crop or rows,
    /// [`RenderError::SensorSize`] for settings of another size than the sensor's,
    /// [`RenderError::Checkpoint`] for a picture to resume that does not belong to this render,
    /// [`RenderError::Memory`] if the system refuses the memory of the picture,
    /// [`RenderError::Threads`] if no threads can be started, [`RenderError::NonFinite`] for a sample
    /// that is NaN or infinite. Panics are caught: [`RenderError::Preparation`] and
    /// [`RenderError::Worker`] for one in an accelerator, the sensor,
    /// [`Monitor::progress`] or [`Monitor::cancelled`], [`RenderError::Monitor`] for one in
    /// [`Monitor::pass_done`] or, after a pass, in [`Monitor::progress`]. The passes before an error were handed to
    /// [`Monitor::pass_done`].
    pub fn run(mut self) -> Result<Picture, RenderError> {
        let (start, monitor) = (Instant::now(), self.monitor);
        let settings = self.settings.for_sensor(self.sensor)?;
        self.stop.validate()?;
        let passes = self.checked_passes()?;
        if let Some(pilot) = self.stop.pilot.filter(|&pilot| pilot as usize >= passes.len()) {
            let range = "[2, the number of passes to render)";
            return Err(RenderError::Param { name: "pilot passes", value: pilot.into(), range });
        }
        let crop = self.checked_crop(&settings)?;
        let picture = self.start(crop, self.checked_rows(crop.height)?, &settings)?;
        let rows = picture.film.rows();
        let window = PixelRect { y: crop.y + rows.start, height: rows.end - rows.start, ..crop };
        check_memory([window.width, window.height])?;
        let work = || {
            let cancelled = || monitor.cancelled();
            let guide = train_guide(self.scene, self.sensor, &settings, cancelled)?;
            let ControlFlow::Continue(guide) = guide else {
                return Ok(Picture { ending: Ending::Cancelled, ..picture });
            };
            let context = caught(|| prepare(self.scene, self.sensor, &settings, guide.as_ref(), cancelled));
            let context = context.map_err(|message| RenderError::Preparation { message })?;
            let ControlFlow::Continue(context) = context else {
                return Ok(Picture { ending: Ending::Cancelled, ..picture });
            };
            let probes = PixelRect::tiles(window).map(|_| OnceLock::new()).collect();
            let meter = Meter::new(start, self.stop.seconds);
            let renderer = PassRenderer { context, monitor, meter: &meter, window, probes };
            PassLoop { renderer, stop: self.stop }.add_passes(picture, passes)
        };
        run_in_threads(self.settings.threads, work).map_err(RenderError::Threads)?
    }

    fn checked_passes(&self) -> Result<Range<u32>, RenderError> {
        let all = self.settings.passes();
        let passes = self.passes.clone().unwrap_or(0..all);
        check_range("passes", &passes, all, 1)?;
        Ok(passes)
    }

    /// The pixels of the crop; the whole picture if there is none.
    fn checked_crop(&self, settings: &Settings) -> Result<PixelRect, RenderError> {
        let Settings { width, height, .. } = *settings;
        let Some([columns, rows]) = &self.crop else { return Ok(PixelRect::whole([width, height])) };
        let step = settings.path_reuse.tile_side();
        check_range("columns of the crop", columns, width, step)?;
        check_range("rows of the crop", rows, height, step)?;
        Ok(PixelRect::of_ranges(columns.clone(), rows.clone(), [width, height]))
    }

    /// The rows to render, of a picture or crop of this height.
    fn checked_rows(&self, height: u32) -> Result<Range<u32>, RenderError> {
        let rows = self.rows.clone().unwrap_or(0..height);
        check_range("rows", &rows, height, Film::TILE_ROWS)?;
        Ok(rows)
    }

    /// The picture of these rows of `crop` to continue.
    fn start(
        &mut self,
        crop: PixelRect,
        rows: Range<u32>,
        settings: &Settings,
    ) -> Result<Picture, RenderError> {
        let (key, before) = (self.key(), self.before.take());
        if before.as_ref().is_some_and(|picture| picture.key != key) {
            return Err(RenderError::Checkpoint(CheckpointError::OTHER_PICTURE));
        }
        let film = Film::new(crop.width, rows, settings.path_reuse)
            .within([settings.width, settings.height], [crop.x, crop.y]);
        // A checkpoint without passes does not tell its rows.
        let Some(picture) = before.filter(|picture| !picture.film.passes().is_empty()) else {
            return Ok(Picture::new(film, crop.height, settings.pass_samples, key));
        };
        if picture.film.rows() != film.rows() {
            return Err(RenderError::Checkpoint(CheckpointError::Mismatch("range of rows")));
        }
        if !picture.film.has_pixels_of(&film) {
            return Err(RenderError::Checkpoint(CheckpointError::Mismatch("size")));
        }
        // A short last pass cannot be continued when more samples are asked for.
        let samples_of = |passes| self.settings.samples_of(passes).len() as u64;
        let expected: u64 = picture.film.passes().into_iter().map(samples_of).sum();
        match picture.film.samples().cmp(&expected) {
            Ordering::Less => Err(RenderError::Checkpoint(CheckpointError::CutShort)),
            Ordering::Equal => Ok(picture),
            Ordering::Greater => Err(RenderError::Checkpoint(CheckpointError::TooManySamples)),
        }
    }
}

impl fmt::Debug for Render<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { scene, sensor, settings, stop, passes, crop, rows, before, monitor: _ } = self;
        f.debug_struct("Render")
            .field("scene", scene)
            .field("sensor", sensor)
            .field("settings", settings)
            .field("stop", stop)
            .field("passes", passes)
            .field("crop", crop)
            .field("rows", rows)
            .field("before", before)
            .finish_non_exhaustive()
    }
}

/// Refuses `asked` unless it has an element, and each end is a multiple of `step` below `end`, or `end`.
fn check_range(name: &'static str, asked: &Range<u32>, end: u32, step: u32) -> Result<(), RenderError> {
    let is_allowed = |at: u32| at == end || at < end && at.is_multiple_of(step);
    if !asked.is_empty() && is_allowed(asked.start) && is_allowed(asked.end) {
        return Ok(());
    }
    Err(RenderError::Range { name, asked: asked.clone(), end, step })
}

/// Refuses a picture of this size if the system refuses what its first pass holds: the moments of each pixel, in tiles and in
/// the film.
fn check_memory(size: [u32; 2]) -> Result<(), RenderError> {
    let pixels = size.map(u64::from).into_iter().product::<u64>();
    let mut held: Vec<[Moments; 2]> = Vec::new();
    let reserved = held.try_reserve_exact(usize::try_from(pixels).unwrap_or(usize::MAX));
    // Compilers may leave out an allocation that nothing looks at.
    black_box(&mut held);
    let bytes = pixels.saturating_mul(size_of::<[Moments; 2]>() as u64);
    reserved.map_err(|_| RenderError::Memory { size, bytes })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// They have more bytes than a machine has addresses.
    #[test]
    fn a_picture_that_no_memory_holds_is_refused() {
        let size = [u32::MAX; 2];
        assert_eq!(check_memory(size), Err(RenderError::Memory { size, bytes: u64::MAX }));
        let size = [1 << 30, 1 << 27];
        assert_eq!(check_memory(size), Err(RenderError::Memory { size, bytes: 96 << 57 }));
        assert_eq!(check_memory([1 << 10; 2]), Ok(()));
    }
}
