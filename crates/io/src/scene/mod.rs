//! Scene files: a [`Loader`] opens them, each format has a folder, and a [report](LoadReport) lists what was skipped.

mod files;
#[cfg(feature = "gltf")]
mod gltf;
mod lint;
mod loaded;
mod loader;
mod loading;
mod losses;
mod monitor;
#[cfg(feature = "obj")]
mod obj;
mod occurrences;
mod range;
mod report;

pub use loaded::{Loaded, NamedMaterial, Object};
#[cfg(feature = "gltf")]
pub use loader::load_gltf;
#[cfg(feature = "obj")]
pub use loader::load_obj;
pub use loader::{Loader, load};
pub use monitor::{LoadMonitor, LoadProgress};
pub use report::{LoadReport, Warning, WarningKind};
