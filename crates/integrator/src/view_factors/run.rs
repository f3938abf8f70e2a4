use super::row::Row;
use super::tracer::{Buffers, Tracer};
use super::{FactorAccuracy, FactorError, FactorSettings, Patches, ViewFactors};
use crate::caught::caught;
use crate::checked_accel;
use crate::hash::{fold, sources};
use crate::run::Meter;
use crate::worker_threads::run_in_threads;
use crate::{Counters, Ending, Monitor};
use globillum_geom::{Accel, Triangles};
use globillum_material::Sides;
use rayon::prelude::*;
use std::fmt;
use std::time::Instant;

/// The computation of view factors.
///
/// A pass traces the same number of rays from each patch, which is one task. Counts are integers, so their sums
/// depend neither on the number of threads nor on when passes were traced; hits are the same in each accelerator.
pub struct FactorRun<'a, A: ?Sized> {
    triangles: &'a Triangles,
    accel: &'a A,
    patches: &'a Patches,
    settings: &'a FactorSettings,
    monitor: &'a dyn Monitor<ViewFactors>,
    before: Option<ViewFactors>,
}

impl<'a, A: Accel + ?Sized> FactorRun<'a, A> {
    /// The view factors between `patches` of `triangles`, over which `accel` is built.
    pub fn new(
        triangles: &'a Triangles,
        accel: &'a A,
        patches: &'a Patches,
        settings: &'a FactorSettings,
    ) -> Self {
        Self { triangles, accel, patches, settings, monitor: &(), before: None }
    }

    /// The same computation, observed by `monitor`, which may cancel it.
    #[must_use]
    pub fn monitor(self, monitor: &'a dyn Monitor<ViewFactors>) -> Self {
        Self { monitor, ..self }
    }

    /// Continues from `before`: the passes that it holds are not traced again. The result has the bits of a run
    /// without a break, unless `before` already holds more passes than the goal needs: none is taken away.
    #[must_use]
    pub fn resume(self, before: ViewFactors) -> Self {
        Self { before: Some(before), ..self }
    }

    /// Traces rays until all passes are done or the goal is met. If the monitor cancels, the current pass is dropped
    /// and the passes before it are returned; [`Monitor::cancelled`] is called before the rays of each patch.
    /// [`Progress`](crate::Progress) counts rays as samples.
    ///
    /// # Errors
    /// [`FactorError::Param`] for settings out of range, [`FactorError::OtherTriangles`] for an accelerator of other
    /// bounds, [`FactorError::Patches`] and [`FactorError::EmptyPatch`] for
    /// patches that do not fit, [`FactorError::OtherRun`] for view factors to resume of other triangles, patches or
    /// settings, [`FactorError::NoneAsLarge`] for a goal that no factor is large enough for,
    /// [`FactorError::Threads`] if no threads can be started. Panics are caught: [`FactorError::Worker`]
    /// for one in an accelerator, [`Monitor::progress`] or [`Monitor::cancelled`], [`FactorError::Monitor`] for one in
    /// [`Monitor::pass_done`].
    pub fn run(mut self) -> Result<ViewFactors, FactorError> {
        self.settings.validate()?;
        if !checked_accel::is_over(self.accel, self.triangles) {
            return Err(FactorError::OtherTriangles);
        }
        let start = self.start()?;
        run_in_threads(self.settings.threads, || self.add_passes(start)).map_err(FactorError::Threads)?
    }

    /// The view factors to continue.
    fn start(&mut self) -> Result<ViewFactors, FactorError> {
        let mut areas = self.patches.areas(self.triangles)?;
        if self.settings.sides == Sides::Both {
            areas.iter_mut().for_each(|area| *area *= 2.0);
        }
        let new = ViewFactors::new(areas, self.settings.pass_rays, self.key());
        match self.before.take() {
            Some(before) if before.key != new.key => Err(FactorError::OtherRun),
            before => Ok(before.unwrap_or(new)),
        }
    }

    /// A hash of all that determines the counts of a pass.
    fn key(&self) -> u64 {
        let FactorSettings { pass_rays, sides, seed, .. } = *self.settings;
        let settings = [pass_rays.into(), u64::from(sides == Sides::Both), seed, self.triangles.len() as u64];
        let vertices = self.triangles.as_slice().iter().flat_map(|triangle| triangle.vertices);
        let vertices = vertices.flat_map(|v| v.to_array()).map(|x| x.to_bits().into());
        let patches = self.patches.ids().iter().map(|&patch| patch.into());
        sources().chain(settings).chain(vertices).chain(patches).fold(0, fold)
    }

    fn add_passes(&self, mut factors: ViewFactors) -> Result<ViewFactors, FactorError> {
        let passes = self.settings.passes;
        let tracer = Tracer::new(self.triangles, self.accel, self.patches, self.settings);
        let meter = Meter::new(Instant::now(), None);
        let mut planned = passes;
        factors.ending = Ending::Open;
        loop {
            if let Some(goal) = self.settings.error.filter(|_| self.settings.judges(factors.passes)) {
                let excess = self.judge(&factors, goal, &meter)?;
                if excess <= 1.0 {
                    factors.ending = Ending::Goals;
                    return Ok(factors);
                }
                planned = passes.min((f64::from(factors.passes) * excess).ceil() as u32);
            }
            if factors.passes >= passes {
                factors.ending = Ending::Samples;
                return Ok(factors);
            }
            let left = u64::from(planned.saturating_sub(factors.passes));
            meter.expect(left * self.rays_of_pass());
            let Some(rows) = self.pass(&tracer, factors.passes, &meter)? else {
                factors.ending = Ending::Cancelled;
                return Ok(factors);
            };
            factors.add_pass(&rows);
            caught(|| self.monitor.pass_done(&factors))
                .map_err(|message| FactorError::Monitor { passes: factors.passes, message })?;
        }
    }

    /// The estimated number of rays that `goal` needs, as a multiple of those of `factors`; at most 1 if it is met.
    fn judge(&self, factors: &ViewFactors, goal: f64, meter: &Meter) -> Result<f64, FactorError> {
        let least = self.settings.least_factor;
        let FactorAccuracy { count, relative_rmse: reached, .. } = factors.accuracy(least);
        if count == 0 {
            let most = factors.largest_upper_end();
            if most < least {
                return Err(FactorError::NoneAsLarge { least, most });
            }
        }
        meter.set_error(reached);
        Ok((reached / goal).powi(2))
    }

    fn rays_of_pass(&self) -> u64 {
        self.patches.len() as u64 * u64::from(self.settings.pass_rays)
    }

    /// The hits of one pass of all patches; `None` if cancelled before its end.
    fn pass(
        &self,
        tracer: &Tracer<'a, A>,
        pass: u32,
        meter: &Meter,
    ) -> Result<Option<Vec<Row>>, FactorError> {
        let of_patch = |buffers: &mut Buffers, patch: u32| {
            let traced = caught(|| {
                (!self.monitor.cancelled()).then(|| {
                    let row = tracer.trace(patch, pass, buffers);
                    let camera_rays = self.settings.pass_rays.into();
                    meter.add(camera_rays, &Counters { camera_rays, ..Counters::default() });
                    self.monitor.progress(meter.progress());
                    row
                })
            });
            // Whatever a panic leaves in the buffers is not used: the whole pass is dropped.
            traced.map_err(|message| FactorError::Worker { patch, message })
        };
        (0..self.patches.len() as u32).into_par_iter().map_init(Buffers::default, of_patch).collect()
    }
}

impl<A: fmt::Debug + ?Sized> fmt::Debug for FactorRun<'_, A> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { triangles, accel, patches, settings, before, monitor: _ } = self;
        f.debug_struct("FactorRun")
            .field("triangles", triangles)
            .field("accel", accel)
            .field("patches", patches)
            .field("settings", settings)
            .field("before", before)
            .finish_non_exhaustive()
    }
}
