//! The training of a guide: paths by which it learns, before the picture is rendered.

use super::path_starts::{distances, patches, path_settings};
use crate::caught::caught;
use crate::guide::{Guide, GuideRecord, bin_of, guide_vertex};
use crate::path::counters::Counters;
use crate::path::render_context::RenderContext;
use crate::path::tile_probes::TileProbes;
use crate::path::wavefront::Wavefront;
use crate::pixel_rect::PixelRect;
use crate::{Guiding, RenderError, Scene, Sensor, Settings};
use globillum_geom::{Accel, Frame};
use rayon::prelude::*;
use std::ops::{ControlFlow, Range};

/// The least samples of a pixel.
const MIN_SAMPLES: u32 = 4;
/// The least number of paths, about, if there are pixels enough.
const MIN_PATHS: u64 = 1 << 16;
/// The most, about. A larger picture has gaps between its patches.
const MAX_PATHS: u32 = 1 << 18;

/// The guide for a picture of the whole sensor, whatever the crop; `None` if settings ask for none. Breaks if
/// `cancelled` before the end.
///
/// # Errors
/// [`RenderError::Worker`] for a panic.
pub(crate) fn train_guide(
    scene: &Scene<dyn Accel + '_>,
    sensor: &dyn Sensor,
    settings: &Settings,
    cancelled: impl Fn() -> bool + Sync,
) -> Result<ControlFlow<(), Option<Guide>>, RenderError> {
    if settings.guiding == Guiding::Off {
        return Ok(ControlFlow::Continue(None));
    }
    let settings = training_settings(settings);
    let context = RenderContext::new(scene, sensor, &settings);
    let traced: Result<Vec<Option<Vec<GuideRecord>>>, RenderError> =
        patches(&settings, distances(&settings, MAX_PATHS / settings.samples), MIN_SAMPLES)
            .into_par_iter()
            .map_init(Wavefront::default, |wavefront, (patch, samples)| {
                let records = caught(|| wavefront.records(&context, patch, samples, &cancelled));
                records.map_err(|message| RenderError::Worker { x: patch.x, y: patch.y, message })
            })
            .collect();
    Ok(match traced?.into_iter().collect() {
        Some(parts) => ControlFlow::Continue(Some(Guide::learn(&joined(parts)))),
        None => ControlFlow::Break(()),
    })
}

/// The settings of training paths, which have random numbers of their own.
fn training_settings(settings: &Settings) -> Settings {
    let samples =
        u32::try_from(MIN_PATHS / settings.pixel_count()).unwrap_or(0).next_power_of_two().max(MIN_SAMPLES);
    path_settings(settings, samples, !settings.seed)
}

/// All records; the indices in them count from the first part.
fn joined(parts: Vec<Vec<GuideRecord>>) -> Vec<GuideRecord> {
    let mut all: Vec<GuideRecord> = Vec::new();
    for part in parts {
        let before = all.len() as u32;
        all.extend(part.into_iter().map(|record| GuideRecord {
            next: record.next.map(|(next, factor)| (before + next, factor)),
            ..record
        }));
    }
    all
}

/// The last record of a path that goes on.
#[derive(Clone, Copy, Debug)]
struct LastRecord {
    index: u32,
    /// The mean of the components of the path's throughput after it.
    throughput: f64,
}

impl Wavefront {
    /// The diffuse vertices of the paths of these samples; `None` if `cancelled` before their end.
    fn records(
        &mut self,
        context: &RenderContext<'_>,
        patch: PixelRect,
        samples: Range<u32>,
        cancelled: impl Fn() -> bool,
    ) -> Option<Vec<GuideRecord>> {
        self.start(context, &TileProbes::none(patch), samples);
        let mut records: Vec<GuideRecord> = Vec::new();
        let mut last: Vec<Option<LastRecord>> = vec![None; self.radiance.samples.len()];
        for bounce in 0.. {
            if cancelled() {
                return None;
            }
            // Sums that begin at zero hold the radiance of this bounce alone.
            self.radiance.reset(last.len(), 0);
            self.advance(context, bounce, &mut Counters::default());
            for (last, &found) in last.iter().zip(&self.radiance.samples) {
                let Some(last) = last else { continue };
                let found = found.mean() / last.throughput;
                // The path of a picture tells of a radiance that is not finite.
                if found.is_finite() {
                    records[last.index as usize].radiance += found;
                }
            }
            if self.paths.is_empty() {
                return Some(records);
            }
            last = self.record_scattering(&mut records, &last);
        }
        unreachable!("paths end")
    }

    /// Adds a record for each path that a diffuse vertex has scattered. Returns the last records of the paths that go on.
    fn record_scattering(
        &self,
        records: &mut Vec<GuideRecord>,
        before: &[Option<LastRecord>],
    ) -> Vec<Option<LastRecord>> {
        let mut last = vec![None; before.len()];
        for (path, ray) in self.paths.iter().zip(&self.rays) {
            let sample = path.target.sample() as usize;
            last[sample] = before[sample];
            if path.mis.is_specular() {
                continue;
            }
            let this = LastRecord { index: records.len() as u32, throughput: path.throughput.mean() };
            if let Some(LastRecord { index, throughput }) = before[sample] {
                records[index as usize].next = Some((this.index, this.throughput / throughput));
            }
            records.push(GuideRecord {
                vertex: guide_vertex(path.mis.receiver),
                bin: bin_of(Frame::around(path.mis.receiver.normal.as_dvec3()).to_local(ray.direction)) as u8,
                radiance: 0.0,
                next: None,
            });
            last[sample] = Some(this);
        }
        last
    }
}
