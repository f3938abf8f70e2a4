//! Wavefront OBJ with MTL materials.

mod face;
mod mtl;
mod number;
mod palette;
mod polygon;
mod scan;
mod source;
mod totals;

use crate::error::Result;
use crate::loading::Loading;
use palette::Palette;
use scan::Scan;
use source::Source;
use totals::Totals;

/// Reads an OBJ file's content into `loading`.
pub(crate) fn read(bytes: Vec<u8>, loading: &mut Loading<'_>) -> Result<()> {
    let source = Source::of(loading.path, bytes, loading.limits)?;
    let default = loading.add_material(mtl::default_material());
    let totals = Totals::of(&source, loading.limits);
    let named = Scan::new(loading, default, &totals)?.run(source.statements(), source.len())?;
    Palette::new(&named, loading).load()
}
