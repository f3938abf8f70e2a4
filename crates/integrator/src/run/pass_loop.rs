use super::pass::PassRenderer;
use super::stop::Stop;
use crate::caught::caught;
use crate::{Ending, Picture, RenderError};
use std::ops::{ControlFlow, Range};

/// A pilot plans at most this many times its own passes; one that asks for more is doubled.
const MAX_PLAN: f64 = 16.0;

/// Renders pass after pass until a stop condition holds.
pub(crate) struct PassLoop<'a> {
    pub(crate) renderer: PassRenderer<'a>,
    pub(crate) stop: Stop,
}

impl PassLoop<'_> {
    /// Adds `passes` to `picture` until a stop condition holds.
    pub(crate) fn add_passes(
        &self,
        mut picture: Picture,
        passes: Range<u32>,
    ) -> Result<Picture, RenderError> {
        picture.ending = Ending::Open;
        self.renderer.meter.set_error(picture.film.error().relative_rmse);
        picture.ending = match self.stop.pilot {
            Some(pilot) => self.in_two_stages(&mut picture, passes, pilot)?,
            None => self.until_goals_met(&mut picture, passes)?,
        };
        Ok(picture)
    }

    /// Stops after the first pass that meets the goals.
    fn until_goals_met(&self, picture: &mut Picture, passes: Range<u32>) -> Result<Ending, RenderError> {
        let before = picture.samples;
        for pass in passes.clone() {
            if picture.film.holds(pass) {
                continue;
            }
            let excess = self.stop.excess(&picture.film);
            if excess.is_some_and(|excess| excess <= 1.0) {
                return Ok(Ending::Goals);
            }
            self.expect(picture, pass..passes.end, excess);
            if let Some(ending) = self.add_pass(picture, pass, before)? {
                return Ok(ending);
            }
            self.tell(picture)?;
        }
        let met = self.stop.excess(&picture.film).is_some_and(|excess| excess <= 1.0);
        Ok(if met { Ending::Goals } else { Ending::Samples })
    }

    /// Renders a pilot, then as many passes as its error requires.
    fn in_two_stages(
        &self,
        picture: &mut Picture,
        passes: Range<u32>,
        pilot: u32,
    ) -> Result<Ending, RenderError> {
        let before = picture.samples;
        let (second, planned) = match self.plan(picture, passes.clone(), pilot)? {
            ControlFlow::Continue(plan) => plan,
            ControlFlow::Break(ending) => return Ok(ending),
        };
        let enough = planned.is_some_and(|planned| planned <= f64::from(passes.end - second));
        let end = planned.map_or(passes.end, |planned| {
            f64::min(f64::from(second) + planned, f64::from(passes.end)) as u32
        });
        for pass in second..end {
            if picture.film.holds(pass) {
                continue;
            }
            self.expect(picture, pass..end, None);
            if let Some(ending) = self.add_pass(picture, pass, before)? {
                return Ok(ending);
            }
            self.tell(picture)?;
        }
        Ok(if enough { Ending::Goals } else { Ending::Samples })
    }

    /// The end of the pilot, which has the first `pilot` of `passes` or more and is dropped, and the number of passes that
    /// the goals need by it; `None` without a goal. Breaks if the render is cancelled.
    fn plan(
        &self,
        picture: &Picture,
        passes: Range<u32>,
        pilot: u32,
    ) -> Result<ControlFlow<Ending, (u32, Option<f64>)>, RenderError> {
        let mut trial =
            Picture::new(picture.film.emptied(), picture.height, picture.pass_samples, picture.key);
        let (mut start, mut end) = (passes.start, passes.start.saturating_add(pilot).min(passes.end));
        loop {
            for pass in start..end {
                self.expect(&trial, pass..end, None);
                match self.add_pass(&mut trial, pass, 0)? {
                    None => {}
                    Some(Ending::Seconds) => {
                        return Ok(ControlFlow::Continue((end, self.stop.passes_after(&trial.film))));
                    }
                    Some(ending) => return Ok(ControlFlow::Break(ending)),
                }
            }
            let planned = self.stop.passes_after(&trial.film);
            let (rendered, left) = (end - passes.start, passes.end - end);
            let longest = MAX_PLAN * f64::from(rendered);
            let has_few_left = self.is_over_after((1.0 + MAX_PLAN) * f64::from(rendered), passes.start..end);
            if has_few_left || planned.is_none_or(|planned| planned.min(f64::from(left)) <= longest) {
                return Ok(ControlFlow::Continue((end, planned)));
            }
            (start, end) = (end, end.saturating_add(rendered).min(passes.end));
        }
    }

    /// Whether the time limit is over after `count` more passes that take as long as `rendered` on average.
    fn is_over_after(&self, count: f64, rendered: Range<u32>) -> bool {
        let PassRenderer { meter, .. } = &self.renderer;
        let passes = f64::from(rendered.end - rendered.start);
        meter.is_over_in(count / passes * meter.seconds_for(self.renderer.samples_of(rendered)))
    }

    /// Tells the monitor of a pass, and hands it the picture.
    fn tell(&self, picture: &Picture) -> Result<(), RenderError> {
        let PassRenderer { monitor, meter, .. } = self.renderer;
        let told = caught(|| {
            monitor.progress(meter.progress());
            monitor.pass_done(picture);
        });
        told.map_err(|message| RenderError::Monitor { samples: picture.samples, message })
    }

    /// Renders one pass that the picture lacks, and adds it. If the pass is not added, returns why: it would end after the
    /// time limit, or the monitor cancelled it. The picture had `before` samples per pixel before this run.
    fn add_pass(&self, picture: &mut Picture, pass: u32, before: u32) -> Result<Option<Ending>, RenderError> {
        let PassRenderer { monitor, meter, .. } = self.renderer;
        // The first pass is always finished, since its time is not known before.
        let limited = picture.samples > before;
        let pass_seconds = meter.seconds_for(self.renderer.samples_of(pass..pass + 1));
        if limited && meter.is_over_in(pass_seconds) {
            return Ok(Some(Ending::Seconds));
        }
        let over = || limited && meter.is_over_in(0.0);
        let Some((node, counters)) = self.renderer.render_pass(pass, || monitor.cancelled() || over())?
        else {
            return Ok(Some(if over() { Ending::Seconds } else { Ending::Cancelled }));
        };
        picture.samples += node.header.tally.samples as u32;
        picture.film.insert(node);
        picture.counters += counters;
        meter.set_error(picture.film.error().relative_rmse);
        Ok(None)
    }

    /// Tells the meter the number of samples left: those of `passes` that the picture lacks, or fewer if the
    /// goals need fewer.
    fn expect(&self, picture: &Picture, passes: Range<u32>, excess: Option<f64>) {
        let held = f64::from(picture.samples) * picture.film.pixel_count() as f64;
        let there: u64 = picture.film.held_of(&passes).map(|part| self.renderer.samples_of(part)).sum();
        let lacking = self.renderer.samples_of(passes) - there;
        let needed = excess.map_or(f64::INFINITY, |excess| held * (excess - 1.0).max(0.0));
        // NaN while nothing is held; `min` then ignores it.
        self.renderer.meter.expect(needed.min(lacking as f64) as u64);
    }
}
