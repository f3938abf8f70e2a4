//! Wavefront OBJ with MTL materials.
//!
//! The crate tobj reads positions, faces and materials. It panics on some texts, loses the line of an error
//! and does not know all that is legal. So every statement is checked before tobj reads it, and is rewritten
//! or kept from tobj where docs/scenes.md says why.

mod corner;
mod fans;
mod lines;
mod mtl;
mod palette;
mod polygon;
mod scan;
mod source;
mod unknown;

use crate::error::Result;
use crate::scene::loading::Loading;
use scan::Scan;
use source::Source;
use tobj::LoadOptions;

/// Reads an OBJ file's content into `loading`.
pub(crate) fn read(bytes: Vec<u8>, loading: &mut Loading<'_>) -> Result<()> {
    let source = Source::of(loading.path, bytes, loading)?;
    let mut scan = Scan::new(loading.add_material(mtl::default_material()));
    let (mut done, total) = (0, source.len());
    let (models, _) = lines::read(
        &source,
        |statement, line| {
            done += statement.len();
            loading.progress(done.min(total), total)?;
            scan.pass(statement, line, loading)
        },
        |lines| tobj::load_obj_buf(lines, &LoadOptions::default(), |_| Ok(Default::default())),
    )?;
    loading.progress(total, total)?;
    loading.try_grow(scan.triangles)?;
    fans::add(models, &scan.runs, &scan.objects, &source, loading);
    scan.warn(loading);
    scan.palette.load(loading)
}
