use crate::path::render_context::RenderContext;
use crate::pixel_rect::PixelRect;
use crate::{PathReuse, PathStart, Settings, Supersampling};
use std::ops::Range;

/// Pixels along the side of a patch, in which preliminary paths begin.
pub(super) const PATCH_SIDE: u32 = 8;

/// The most bounces of preliminary paths, whatever the settings say of roulette.
const MAX_BOUNCES: u32 = 16;

/// The limit on the bounces of such paths.
pub(super) fn capped_bounces(settings: &Settings) -> Option<u32> {
    Some(settings.max_bounces.unwrap_or(MAX_BOUNCES).min(MAX_BOUNCES))
}

/// The settings of preliminary paths: this many of each pixel, by this seed. Pixels share
/// nothing, each vertex takes one light sample, and lights are not supersampled.
pub(super) fn path_settings(settings: &Settings, samples: u32, seed: u64) -> Settings {
    Settings {
        samples,
        pass_samples: samples,
        seed,
        light_samples: 1,
        path_reuse: PathReuse::Off,
        supersampling: Supersampling::Off,
        ..*settings
    }
}

/// The context of such paths, with these settings. It has no guide, which would depend on the seed.
pub(super) fn path_context<'a>(context: &RenderContext<'a>, settings: &'a Settings) -> RenderContext<'a> {
    RenderContext {
        lights_by_visibility: context.lights_by_visibility.clone(),
        ..RenderContext::new(context.scene, context.sensor, settings)
    }
}

/// Patches of pixels at these distances in both directions, each with every range of `at_once` samples of its pixels. Where
/// distances are larger than [`PATCH_SIDE`], there are gaps between patches.
pub(super) fn patches(
    settings: &Settings,
    distances: [u32; 2],
    at_once: u32,
) -> Vec<(PixelRect, Range<u32>)> {
    let ranges = (0..settings.samples).step_by(at_once as usize).map(|first| first..first + at_once);
    let cells = PixelRect::grid([settings.width, settings.height], distances);
    cells.flat_map(|cell| ranges.clone().map(move |range| (cell.corner(PATCH_SIDE), range))).collect()
}

/// The distances of patches, so that a sample of each of their pixels takes about `paths` paths or fewer.
pub(super) fn distances(&Settings { width, height, .. }: &Settings, paths: u32) -> [u32; 2] {
    let most = paths / (PATCH_SIDE * PATCH_SIDE);
    let by_shape = f64::from(most) * f64::from(width) / f64::from(height);
    let columns = (by_shape.sqrt() as u32).clamp(1, width.div_ceil(PATCH_SIDE));
    let rows = (most / columns).clamp(1, height.div_ceil(PATCH_SIDE));
    let columns = (most / rows).clamp(1, width.div_ceil(PATCH_SIDE));
    [(width, columns), (height, rows)].map(|(size, count)| size.div_ceil(count).max(PATCH_SIDE))
}

/// Where the probes of one of `per_side` rows begin, of which each has as many, evenly spaced over the picture.
pub(super) fn probe_starts(
    context: &RenderContext<'_>,
    per_side: u32,
    row: u32,
) -> impl Iterator<Item = PathStart> {
    let place = move |probe: u32, pixels: u32| {
        let at = (f64::from(probe) + 0.5) / f64::from(per_side) * f64::from(pixels);
        (at as u32, at.fract())
    };
    (0..per_side).map(move |column| {
        let ((x, u), (y, v)) = (place(column, context.settings.width), place(row, context.settings.height));
        context.path_start((x, y), [u, v])
    })
}
