//! What probes at fixed places find of a tile before its first sample. They never depend on samples.

mod light_edges;
mod open_sky;

pub(super) use light_edges::LightEdges;

use super::render_context::RenderContext;
use crate::pixel_rect::{PixelRect, SQUARE_SIDE};
use globillum_material::Rgb;
use open_sky::is_open;

/// A tile, and what probes find of it.
#[derive(Debug)]
pub(crate) struct TileProbes {
    pub(crate) tile: PixelRect,
    /// The pixels that may see the edge of a light.
    pub(super) edges: LightEdges,
    /// For each square of 16 x 16 pixels of the tile, the control variate of path reuse: the radiance that is taken to arrive
    /// from all directions at first diffuse vertices.
    pub(super) control_variates: Vec<Rgb>,
}

impl TileProbes {
    pub(crate) fn of(context: &RenderContext<'_>, tile: PixelRect) -> Self {
        let squares = PixelRect::grid([tile.width, tile.height], [SQUARE_SIDE; 2]);
        let control_variate = |square: PixelRect| {
            let square = PixelRect { x: tile.x + square.x, y: tile.y + square.y, ..square };
            if is_open(context, square) { context.scene.environment() } else { Rgb::BLACK }
        };
        Self {
            tile,
            edges: LightEdges::of(context, tile),
            control_variates: squares.map(control_variate).collect(),
        }
    }

    /// A tile of which nothing is probed: it has no edges of lights and no control variates.
    pub(super) fn none(tile: PixelRect) -> Self {
        Self { tile, edges: LightEdges::default(), control_variates: Vec::new() }
    }
}
