#![doc = include_str!("../README.md")]

pub use glam;
#[doc(inline)]
pub use globillum_geom as geom;
#[doc(inline)]
pub use globillum_integrator as integrator;
#[doc(inline)]
pub use globillum_io as io;
#[doc(inline)]
pub use globillum_material as material;
#[cfg(feature = "scenes")]
#[doc(inline)]
pub use globillum_scenes as scenes;
