use super::light_edges::LightEdges;
use super::open_sky::is_open;
use super::pixel_rect::{PixelRect, SIDE};
use super::render_context::RenderContext;
use globillum_material::Rgb;

/// What probes at fixed places find of a tile before its first sample. They never depend on samples.
#[derive(Debug, Default)]
pub(crate) struct TileProbes {
    /// The pixels that may see the edge of a light.
    pub(super) edges: LightEdges,
    /// For each square of 16 x 16 pixels of the tile, the control variate of path reuse: the radiance that is taken to arrive
    /// from all directions at first diffuse vertices.
    pub(super) controls: Vec<Rgb>,
}

impl TileProbes {
    pub(crate) fn of(context: &RenderContext<'_>, tile: PixelRect) -> Self {
        let squares = PixelRect::grid([tile.width, tile.height], [SIDE; 2]);
        let control = |square: PixelRect| {
            let square = PixelRect { x: tile.x + square.x, y: tile.y + square.y, ..square };
            if is_open(context, square) { context.scene.environment() } else { Rgb::BLACK }
        };
        Self { edges: LightEdges::of(context, tile), controls: squares.map(control).collect() }
    }
}
